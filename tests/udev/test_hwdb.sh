#!/bin/sh
# systemd's own compiler takes the hardware database, and finds in it what the rules are about.
# test_hwdb.sh BUILT: the folder with 60-placido.hwdb. Skipped (77) where the compiler is not there.
set -eu
built=$1
if ! command -v systemd-hwdb > /dev/null; then
  echo "skipped: systemd-hwdb is not there"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/etc/udev/hwdb.d"
cp "$built/60-placido.hwdb" "$work/etc/udev/hwdb.d/"
systemd-hwdb --strict --root "$work" update

ask() {
  systemd-hwdb --root "$work" query "$1"
}
if grep -q 'icEFisc05' "$built/60-placido.hwdb"; then
  ask 'usb:v2E03p2504d0100dcEFdsc02dp01icEFisc05ip00in00' | grep -qx 'ID_PLACIDO_DRIVER=u3v'
  [ -z "$(ask 'usb:v2E03p2504d0100dcEFdsc02dp01ic0Eisc01ip00in00')" ]
fi
echo "all passed"
