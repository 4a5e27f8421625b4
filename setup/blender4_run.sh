#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs a program of a folder that setup/blender4.sh has made: ROOT PROGRAM [ARGUMENT …]. It finds this system's files where they
# are, but for /usr, /etc and /var, which are the folder's. What is in CHANDELIER_BIN, and what the tests need besides, is linked
# against this system's libraries: where it is started inside, it runs outside. No mount outlives the program.
set -euo pipefail

if [ "${CHANDELIER_OWN_MOUNTS:-}" != "$$" ]; then
  user=()
  [ "$(id -u)" -eq 0 ] || user=(--map-root-user)
  CHANDELIER_OWN_MOUNTS="$$" exec unshare --mount --propagation private "${user[@]}" "$0" "$@"
fi
root="$1"
shift

mount --rbind / "$root/outside"
for folder in /*; do
  case "$folder" in
    /bin | /boot | /etc | /lib* | /outside | /sbin | /usr | /var) ;;
    *) if [ -d "$folder" ]; then mkdir -p "$root$folder" && mount --rbind "$folder" "$root$folder"; fi ;;
  esac
done

# Each program takes its caller's process, so that whoever ends the one ends the other.
mount -t tmpfs none "$root/usr/local/bin"
cat >"$root/usr/local/bin/run_outside" <<'END'
#!/bin/sh
case "$0" in
  /usr/local/bin/*) program="${0##*/}" ;;
  *) program="$0" ;;
esac
exec /usr/sbin/chroot /outside /usr/bin/env -C "$PWD" PATH="$CHANDELIER_OUTSIDE_PATH" "$program" "$@"
END
chmod +x "$root/usr/local/bin/run_outside"
for program in import node npm xwininfo; do
  if command -v "$program" >/dev/null; then ln -s run_outside "$root/usr/local/bin/$program"; fi
done
if [ -d "${CHANDELIER_BIN:-}" ]; then
  bin="$(realpath "$CHANDELIER_BIN")"
  mount -t tmpfs none "$root$bin"
  for program in "$bin"/*; do
    if [ -f "$program" ] && [ -x "$program" ]; then ln -s /usr/local/bin/run_outside "$root$program"; fi
  done
fi

export CHANDELIER_OUTSIDE_PATH="$PATH"
unset CHANDELIER_OWN_MOUNTS LD_LIBRARY_PATH
exec chroot "$root" /usr/bin/env -C "$PWD" PATH=/usr/local/bin:/usr/bin:/bin "$@"
