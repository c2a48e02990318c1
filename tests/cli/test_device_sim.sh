#!/bin/sh
# `placido device-sim` as far as it goes without a kernel that takes its camera: what it refuses, and that it obeys.
. "$(dirname "$0")/harness.sh"

refuse 2 'there is none of that name' device-sim --face webcam
refuse 2 'does not say when' device-sim --faults stall
refuse 2 '"explode" is not understood' device-sim --faults explode@3s
refuse 2 'from 0 to 3600' device-sim --faults disconnect=1e9@3s
refuse 2 'are too much' device-sim none.session --eye sphere --listen 0
if [ "$SESSIONS" = ON ]; then
  refuse 1 'none.session' device-sim none.session --listen 0
fi
refuse 2 'a TCP port or ADDRESS:PORT was expected' device-sim --listen 70000
if [ ! -e /sys/devices/platform/vhci_hcd.0 ]; then
  refuse 1 'modprobe vhci_hcd' device-sim
fi

# A sensor of a hundredth of the usual one, so that nothing takes long to render.
"$PLACIDO" phantom --eye sphere --instrument cone24 -o full.png -q
sed -e 's/1280,$/128,/; s/1024$/102/; s/10800/1080/; s/639\.5/63.5/; s/511\.5/50.5/' full.instrument.json > small.json
camera="device-sim --pictures 1 --eye sphere --instrument ./small.json --listen"
# shellcheck disable=SC2086
refuse 3 'no IPv4 address' $camera localhost:0

printf 'drop 3\nstall\nslow 20\nfaults\nstall 0\nfaults\nexplode\ndrop 1 2\nquit\n' > orders.txt
# shellcheck disable=SC2086
"$PLACIDO" $camera 0 > out.txt 2> err.txt < orders.txt || fail "it does not quit"
says '^READY u3v on TCP port [1-9]' out.txt
says '^OK stall 1 drop 3 slow 20$' out.txt
says '^OK drop 3 slow 20$' out.txt
says '^ERROR "explode" is not understood' out.txt
says '^ERROR drop 1: one number at most' out.txt
says '^0 pictures sent' out.txt

# Orders end with their file, and the camera goes on: --for ends it.
# shellcheck disable=SC2086
"$PLACIDO" $camera 0 --for 0.3 --json --faults stall@0.1s,disconnect@0.2s \
  > out.txt 2> err.txt < /dev/null || fail "--for does not end it"
json out.txt - pictures dropped command exit_code
finish
