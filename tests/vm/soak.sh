# What is lost slowly: memory, descriptors, the way back after a fault. For the long run, no part of the suite.
#
#   soak.sh MINUTES [FACE]        full rate, a fault every few seconds
#   soak.sh plug CYCLES [FACE]    plugged and unplugged so often
. tests/vm/lib.sh
if [ "$1" = plug ]; then
  mode=plug
  shift
else
  mode=faults
fi
amount=$1
face=${2:-u3v}
every_s=4

# holding PROCESS: its memory and its open files: "63012 kB 8 files".
holding() {
  echo "$(sed -n 's/^VmRSS:[[:space:]]*//p' "/proc/$1/status") $(find "/proc/$1/fd" -mindepth 1 | wc -l) files"
}

# tell WHEN: and leaves what the stream holds in $held_kb and $held_files. The least of some looks counts: a picture on
# its way is a megabyte.
tell() {
  now=$(for look in 1 2 3 4 5 6 7 8 9 10; do
    holding "$streaming"
    sleep 0.1
  done | sort -n | head -n 1)
  held_kb=${now%% kB*}
  held_files=$(echo "$now" | sed 's/.*kB \([0-9]*\) files/\1/')
  echo "$1: client $now, camera $(holding "$simulating"); $(grep -c '^frame' stream.out) frames," \
    "$(grep '^counts' stream.out | tail -n 1)"
}

# fault NUMBER: one of them in turn.
fault() {
  case $(($1 % 8)) in
    0) order sim stall ;;
    1) order sim drop ;;
    2) order sim corrupt ;;
    3) order sim truncate ;;
    4) order sim misnumber ;;
    5) order sim lost-start ;;
    6) order sim lost-end ;;
    7) order sim "disconnect 1" ;;
  esac
}

# await_frames: 5 more, or the stream is lost.
await_frames() {
  if ! wait_for 60 frames_on $(($(grep -c '^frame' stream.out) + 5)); then
    fail "no frames after $1"
    tail -n 3 stream.out
    finish
  fi
}

modprobe vhci-hcd
modprobe uvcvideo
start_udevd
size=1280x1024
[ "$mode" = faults ] || size=320x240
make_session eye "$size"
start_camera sim eye --face "$face" --serial SOAK1 --rate 200
simulating=$(echo "$running" | awk '{ print $1 }')
if [ "$face" = uvc ]; then
  uri=v4l2:serial=SOAK1
else
  uri=u3v:SOAK1
fi
sleep 5
stream_on "$uri?replug_s=120"

if [ "$mode" = faults ]; then
  for i in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15; do # everything once or twice, so that memory has found its size
    fault "$i"
    sleep "$every_s"
    await_frames "fault $i"
  done
  tell "settled"
  first_kb=$held_kb
  first_files=$held_files
  end=$(($(cut -d . -f 1 /proc/uptime) + amount * 60))
  i=0
  while [ "$(cut -d . -f 1 /proc/uptime)" -lt "$end" ]; do
    fault "$i"
    i=$((i + 1))
    sleep "$every_s"
    await_frames "fault $i"
    [ $((i % 30)) -ne 0 ] || tell "$i faults"
  done
  tell "$i faults, the end"
else
  i=0
  while [ "$i" -lt "$amount" ]; do
    order sim "disconnect 0.1"
    i=$((i + 1))
    if ! wait_for 120 exceeds replugs $((i - 1)); then
      fail "not back after $i cycles"
      finish
    fi
    await_frames "cycle $i"
    if [ "$i" -eq 10 ]; then
      tell "settled, 10 cycles"
      first_kb=$held_kb
      first_files=$held_files
    fi
    [ $((i % 50)) -ne 0 ] || tell "$i cycles"
  done
  tell "$i cycles, the end"
fi
check "memory is flat: grown by $((held_kb - first_kb)) kB" [ $((held_kb - first_kb)) -lt 1024 ]
check "no file is left open: $held_files after $first_files" [ "$held_files" -eq "$first_files" ]
cp stream.out "$VM_OUT/"
end_stream
finish
