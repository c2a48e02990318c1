#!/bin/sh
# `placido devices`: all of them, one in detail, and those that come and go.
. "$(dirname "$0")/harness.sh"

succeed devices
says '^v4l2 ' out.txt
succeed devices --json
json out.txt - drivers devices command exit_code

"$PLACIDO" phantom --eye sphere --instrument cone24 -o eye.png -q
succeed devices eye.png
says '^uri +replay:eye.png' out.txt
says '^loop +0 +0 to 1 ' out.txt
succeed devices 'eye.png?loop=1' --json
json out.txt - device.uri device.serial modes controls command exit_code
tr -d ' \n' < out.txt > flat.txt
says '"name":"loop".*"value":1\.0' flat.txt

refuse 1 'no driver "sonar"' devices sonar:7
refuse 1 'none.png' devices none.png
refuse 3 'replug_s=5000: it ranges from 0 to 3600 seconds' devices 'eye.png?replug_s=5000'
refuse 2 '--watch is of all devices' devices --watch v4l2:/dev/video0
refuse 2 'is one too many' devices eye.png eye.png

# It goes on until it is told to stop, and each line is out at once.
"$PLACIDO" devices --watch --json > watch.txt 2> err.txt &
pid=$!
sleep 1.5
kill -0 "$pid" || fail "--watch ended by itself"
kill -TERM "$pid"
status=0
wait "$pid" || status=$?
[ "$status" -eq 143 ] || fail "--watch: exit $status"
says 'stopped by a signal' err.txt
while read -r line; do
  echo "$line" > line.txt
  json line.txt - change uri description
done < watch.txt
finish
