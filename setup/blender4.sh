#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Installs Blender 4.3 and what it needs, from Debian 13, into DIR/root, beside the system and without changing it, and prints
# the CHANDELIER_BLENDER=… line that chooses it for the add-on's tests. Needs debootstrap, 1.4 GB, and root or sudo once; goes on
# where it was cut off. Exits 3 with one line where Blender cannot be had.
set -euo pipefail

if [ $# -ne 1 ]; then
  echo "usage: setup/blender4.sh DIR" >&2
  exit 2
fi
here="$(cd "$(dirname "$0")" && pwd)"
mkdir -p "$1"
dir="$(cd "$1" && pwd)"
root="$dir/root"
suite=trixie
packages=(blender python3-numpy libgl1-mesa-dri)

# The program, which knows where this script is now; the add-on is an extension there, of another name.
say() {
  printf '#!/bin/sh\nexec "%s" "%s" blender "$@"\n' "$here/blender4_run.sh" "$root" >"$dir/blender.part"
  chmod +x "$dir/blender.part"
  mv -f "$dir/blender.part" "$dir/blender"
  echo "CHANDELIER_BLENDER=$dir/blender CHANDELIER_ADDON=bl_ext.user_default.chandelier"
}

cannot() {
  echo "setup/blender4.sh: error: Blender 4.3 cannot be had: $1" >&2
  exit 3
}

if [ -e "$dir/complete" ]; then
  say
  exit 0
fi
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || cannot "not root and no sudo"
  exec sudo "$here/blender4.sh" "$dir"
fi
for program in debootstrap unshare chroot; do
  command -v "$program" >/dev/null || cannot "no $program; setup/install.sh setup/packages-blender4.txt installs it"
done

# From here on with mounts of its own, which end with it.
if [ "${CHANDELIER_OWN_MOUNTS:-}" != "$$" ]; then
  CHANDELIER_OWN_MOUNTS="$$" exec unshare --mount --propagation private "$here/blender4.sh" "$dir"
fi
export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C DEBIAN_FRONTEND=noninteractive

# The mirror that the system itself uses for Debian's main archive.
mirror="$(apt-get indextargets --format '$(LABEL) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null |
  awk '$1 == "Debian" && $2 == "main" { print $3; exit }' || true)"
[ -n "$mirror" ] || cannot "the system's apt sources name no main archive"

if [ ! -d "$root" ]; then
  rm -rf "$root.part"
  mkdir -p "$dir/debs"
  debootstrap --variant=minbase --cache-dir="$dir/debs" "$suite" "$root.part" "$mirror" >"$dir/debootstrap.log" 2>&1 ||
    cannot "debootstrap failed, see $dir/debootstrap.log"
  mv "$root.part" "$root"
  rm -rf "$dir/debs"
fi

mount --rbind /proc "$root/proc"
mount --rbind /dev "$root/dev"
cp /etc/resolv.conf "$root/etc/resolv.conf"
ln -sf /proc/self/mounts "$root/etc/mtab"  # which Blender reads
printf '#!/bin/sh\nexit 101\n' >"$root/usr/sbin/policy-rc.d"  # no services
chmod +x "$root/usr/sbin/policy-rc.d"
{
  chroot "$root" dpkg --configure -a &&
    chroot "$root" apt-get -q update &&
    chroot "$root" apt-get -q -o Dpkg::Use-Pty=0 install -y --no-install-recommends "${packages[@]}" &&
    chroot "$root" apt-get clean
} >"$dir/apt.log" 2>&1 </dev/null || cannot "apt-get failed in $root, see $dir/apt.log"
version="$(chroot "$root" blender --version 2>"$dir/blender.log" | head -n 1 || true)"
[[ "$version" == "Blender 4.3"* ]] || cannot "$suite has ${version:-no Blender that runs, see $dir/blender.log}"
mkdir -p "$root/outside"
for folder in /*/; do mkdir -p "$root$folder"; done
touch "$dir/complete"
say
