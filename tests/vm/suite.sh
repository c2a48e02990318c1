#!/bin/sh
# Runs every case in the virtual machine one after the other, each with a limit of time, and sums up. Runs as root
# there: never on a machine that matters.
cases="v4l2 gpio u3v uvc udev"
limit_s=300
if [ ! -d /run/vm ]; then
  echo "suite.sh: only in the virtual machine: tests/vm/run" >&2
  exit 1
fi

run=0
failed=0
echo "1..$(echo "$cases" | wc -w)"
for name in $cases; do
  run=$((run + 1))
  begin=$(cut -d . -f 1 /proc/uptime)
  timeout -k 5 "$limit_s" sh "tests/vm/case_$name.sh" > /run/suite.log 2>&1
  status=$?
  seconds=$(($(cut -d . -f 1 /proc/uptime) - begin))
  sed 's/^/    /' /run/suite.log
  checks=$(grep -c '^ok: ' /run/suite.log)
  if [ "$status" -eq 0 ] && [ "$checks" -gt 0 ]; then
    echo "ok $run - $name ($checks checks, $seconds s)"
  else
    failed=$((failed + 1))
    echo "not ok $run - $name (status $status, $checks checks passed, $seconds s)"
    dmesg | tail -n 15 | sed 's/^/    kernel: /'
  fi
done
echo "# $run cases, $failed failed, $(cut -d . -f 1 /proc/uptime) s since the boot"
[ "$run" -gt 0 ] && [ "$failed" -eq 0 ]
