#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs the Blender of a folder with another Debian in it, where this tree and /tmp are at their own places and this system
# is /host. Called through `unshare --mount`, so that nothing stays mounted.
#   in_root.sh ROOT SOURCE ARGUMENT…
set -euo pipefail
root="$1" source="$2"
shift 2
for folder in /dev /proc /tmp "$source"; do
  mkdir -p "$root$folder"
  mount --rbind "$folder" "$root$folder"
done
mkdir -p "$root/host"
mount --rbind / "$root/host"
exec chroot "$root" /usr/bin/env -C "$PWD" blender "$@"
