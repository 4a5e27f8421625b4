#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Makes a Debian 13 with its Blender 4.3 in the folder DIR/root, beside the system and without changing it, and prints that
# folder. Needs root. Exits 3 with one line where the packages cannot be had. About 1.6 GB.
set -euo pipefail

if [ $# -ne 1 ]; then
  echo "usage: setup/blender4.sh DIR" >&2
  exit 2
fi
mkdir -p "$1"
dir="$(cd "$1" && pwd)"

cannot() {
  echo "setup/blender4.sh: error: Blender 4.3 cannot be had: $1" >&2
  exit 3
}

if [ ! -e "$dir/complete" ]; then
  command -v debootstrap >/dev/null || cannot "this system has no debootstrap"
  [ "$(id -u)" -eq 0 ] || cannot "debootstrap needs root"
  # The mirror that the system itself uses for its main archive.
  mirror="$(apt-get indextargets --format '$(COMPONENT) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null |
    awk '$1 == "main" && $2 !~ /security/ { print $2; exit }')"
  [ -n "$mirror" ] || cannot "the system's apt sources name no main archive"
  rm -rf "$dir/root"
  debootstrap --variant=minbase trixie "$dir/root" "$mirror" >"$dir/log" 2>&1 || cannot "see $dir/log"
  cp /etc/apt/apt.conf.d/*proxy* "$dir/root/etc/apt/apt.conf.d/" 2>/dev/null || true
  {
    chroot "$dir/root" apt-get -q update
    DEBIAN_FRONTEND=noninteractive chroot "$dir/root" apt-get -q install -y --no-install-recommends blender python3-numpy
  } >>"$dir/log" 2>&1 || cannot "see $dir/log"
  touch "$dir/complete"
fi
echo "$dir/root"
