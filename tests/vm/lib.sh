# What the cases of the virtual machine share. Sourced, not run.
#
# PLACIDO_BUILD   the build under test; `placido` and the programs of this folder are found in it
set -u
here=$PWD/tests/vm
export PATH="$PLACIDO_BUILD:$PLACIDO_BUILD/tests/vm:$PATH"
work=$(mktemp -d)
failures=0
running=""
trap 'end_all; rm -rf "$work"' EXIT
cd "$work" || exit 1

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

finish() {
  [ "$failures" -eq 0 ] || echo "$failures failed"
  exit $((failures != 0))
}

# check WHAT COMMAND...: the command must succeed; where it does not, all that it said is shown.
check() {
  what=$1
  shift
  if "$@" > "$work/said" 2>&1; then
    echo "ok: $what"
  else
    fail "$what (status $?)"
    sed 's/^/  /' "$work/said"
  fi
}

# check_each COMMAND...: a command that prints lines "ok: ..." and "FAILED: ..." itself.
check_each() {
  "$@" 2>&1 || fail "$*: status $?"
}

# says PATTERN FILE
says() {
  grep -Eq -e "$1" "$2" || { cat "$2"; return 1; }
}

# wait_for SECONDS COMMAND...: until the command succeeds.
wait_for() {
  tries=$(($1 * 5))
  shift
  until "$@" > /dev/null 2>&1; do
    tries=$((tries - 1))
    [ "$tries" -gt 0 ] || return 1
    sleep 0.2
  done
}

# start NAME COMMAND...: in the background, its standard input from the fifo NAME.in, its words in NAME.out. Its process
# id is in $started.
start() {
  name=$1
  shift
  rm -f "$name.in"
  mkfifo "$name.in"
  "$@" < "$name.in" > "$name.out" 2>&1 &
  started=$!
  running="$running $started"
  # Somebody must hold the fifo open, or the first line sent would also end the input.
  sleep 100000 > "$name.in" &
  running="$running $!"
}

# end_all: whatever was started.
end_all() {
  for process in $running; do
    kill "$process" 2> /dev/null
  done
  running=""
}

# start_udevd: from now on the machine has what notices that devices come and go.
start_udevd() {
  [ ! -e /run/udev/control ] || return 0
  mkdir -p /run/udev
  /lib/systemd/systemd-udevd --daemon > /dev/null 2>&1
}

# make_session NAME SIZE: a session of 8 pictures as any FFmpeg writes one, and NAME.sums, what stream says of each.
make_session() {
  mkdir -p "$1"
  ffmpeg -nostdin -v error -f lavfi -i "testsrc2=size=$2:rate=20" -frames:v 8 -pix_fmt gray -c:v ffv1 -level 3 \
    "$1/frames.mkv"
  cp "$here/../data/samples/normal.instrument.json" "$1/instrument.json"
  echo '{"format": "placido-session/1", "created": "2026-01-01T00:00:00Z", "eye": "OD"}' > "$1/session.json"
  stream "replay:$1" --seconds 1000 --sums > replay.out
  sums_of replay.out > "$1.sums"
}

# sums_of FILE: the sums of all frames without a flag, each once.
sums_of() {
  sed -n 's/^frame [0-9]* 0 //p' "$1" | sort -u
}

# shows FILE SESSION: every frame that stream told of in FILE is one of the session's, bit by bit, and they change.
shows() {
  sums_of "$1" > seen.sums
  comm -23 seen.sums "$2.sums" > foreign.sums
  if [ "$(wc -l < seen.sums)" -lt 4 ] || [ -s foreign.sums ]; then
    cat "$1"
    return 1
  fi
}

# start_camera NAME ARGUMENT...: a simulated camera, plugged in.
start_camera() {
  name=$1
  shift
  start "$name" placido device-sim "$@"
  wait_for 60 says '^READY' "$name.out" || fail "the simulated camera $name does not start: $(cat "$name.out")"
}

# order NAME WORDS: to a simulated camera, until it has answered.
order() {
  answered=$(wc -l < "$1.out")
  echo "$2" > "$1.in"
  wait_for 20 more_lines "$1.out" "$answered" || fail "no answer to \"$2\""
}

more_lines() {
  [ "$(wc -l < "$1")" -gt "$2" ]
}

# stream_on ARGUMENT...: stream in the background, until it is ended by end_stream; its words are in stream.out.
stream_on() {
  stream "$@" --frames 1000000 --sums > stream.out 2>&1 &
  streaming=$!
  wait_for 60 says '^frame' stream.out || fail "no frame: $(cat stream.out)"
}

end_stream() {
  kill "$streaming" 2> /dev/null
  wait "$streaming" 2> /dev/null
}

# counted KEY: what the running stream has counted.
counted() {
  sed -n "s/^counts .*$1 \([0-9]*\).*/\1/p" stream.out | tail -n 1
}

exceeds() {
  [ "$(counted "$1")" -gt "$2" ]
}

frames_on() {
  [ "$(grep -c '^frame' stream.out)" -gt "$1" ]
}

# goes_on WHAT: 20 frames more of the running stream.
goes_on() {
  check "$1: frames go on" wait_for 60 frames_on $(($(grep -c '^frame' stream.out) + 20))
}

# value KEY FILE: of a line "KEY VALUE" as stream prints them.
value() {
  sed -n "s/^$1 //p" "$2" | head -n 1
}

# is KEY OPERATOR NUMBER FILE: "is dropped -eq 0 stream.out".
is() {
  test "$(value "$1" "$4")" "$2" "$3" || { cat "$4"; return 1; }
}
