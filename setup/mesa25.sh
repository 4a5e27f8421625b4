#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Unpacks Mesa 25 from Debian's bookworm-backports into DIR, beside the system and without changing it, and prints the
# VK_DRIVER_FILES=… line that chooses it. Exits 3 with one line where the packages cannot be had.
set -euo pipefail

if [ $# -ne 1 ]; then
  echo "usage: setup/mesa25.sh DIR" >&2
  exit 2
fi
mkdir -p "$1"
dir="$(cd "$1" && pwd)"
icd="$dir/lvp_icd.json"

# The libraries beside the driver are found through LD_LIBRARY_PATH; where it brought none, the driver's file is enough.
say() {
  local beside
  beside="$(find "$dir/root" -name '*.so.*' -printf '%h\n' | sort -u | paste -sd:)"
  echo "VK_DRIVER_FILES=$icd${beside:+ LD_LIBRARY_PATH=$beside}"
}

cannot() {
  echo "setup/mesa25.sh: error: Mesa 25 cannot be had: $1" >&2
  exit 3
}

if [ -s "$icd" ]; then
  say
  exit 0
fi
command -v apt-get >/dev/null || cannot "this system has no apt"

# The mirror that the system itself uses for bookworm's main archive.
mirror="$(apt-get indextargets --format '$(CODENAME) $(COMPONENT) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null |
  awk '$1 == "bookworm" && $2 == "main" { print $3; exit }')"
[ -n "$mirror" ] || cannot "the system's apt sources name no bookworm main"

# Lists and state of our own; signatures are checked with the system's Debian keys.
mkdir -p "$dir"/apt/{lists/partial,cache/archives/partial,parts} "$dir/root"
options=(-q -o "Dir::Etc::SourceList=$dir/apt/sources.list" -o "Dir::Etc::SourceParts=$dir/apt/parts"
  -o "Dir::Etc::PreferencesParts=$dir/apt/parts" -o "Dir::State::Lists=$dir/apt/lists" -o "Dir::Cache=$dir/apt/cache"
  -o "APT::Sandbox::User=$(id -un)")
{
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main"
  echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm-backports main"
} >"$dir/apt/sources.list"
apt-get "${options[@]}" update >"$dir/apt/update.log" 2>&1 || cannot "apt-get update failed, see $dir/apt/update.log"

unpack() {  # PACKAGE[/RELEASE]; the file is then $deb
  rm -rf "$dir/apt/debs" && mkdir "$dir/apt/debs"
  (cd "$dir/apt/debs" && apt-get "${options[@]}" download "$1") >"$dir/apt/download.log" 2>&1 || return 1
  deb="$(find "$dir/apt/debs" -name '*.deb')"
  dpkg -x "$deb" "$dir/root"
}

unpack mesa-vulkan-drivers/bookworm-backports || cannot "no mesa-vulkan-drivers in bookworm-backports, see $dir/apt/download.log"
driver="$(find "$dir/root" -name libvulkan_lvp.so)"
[ -n "$driver" ] || cannot "the package holds no libvulkan_lvp.so"

# The packages that it depends on and the system lacks come from the same archive, and lie beside the driver.
for package in $(dpkg-deb -f "$deb" Depends | tr ',' '\n' | sed -e 's/[(|:].*//' -e 's/ //g'); do
  if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)" != installed ]; then
    unpack "$package" || cannot "no $package, see $dir/apt/download.log"
  fi
done
lacking="$(LD_LIBRARY_PATH="$(find "$dir/root" -type d -printf "%p:")" ldd "$driver" | awk '/not found/ { printf "%s ", $1 }')"
[ -z "$lacking" ] || cannot "the driver lacks $lacking"

printf '{\n  "file_format_version": "1.0.0",\n  "ICD": {"api_version": "1.4.305", "library_arch": "64", "library_path": "%s"}\n}\n' \
  "$driver" >"$icd.part"
mv "$icd.part" "$icd"
rm -rf "$dir/apt"
say
