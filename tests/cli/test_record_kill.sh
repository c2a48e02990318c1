#!/bin/sh
# SIGKILL in the middle of a recording, at random moments: every session opens, and at most its last second is lost.
# KILLS=50 tests/cli/test_record_kill.sh for more than the few of every day.
. "$(dirname "$0")/harness.sh"
. "$(dirname "$0")/recording.sh"
if [ "$SESSIONS" != ON ]; then
  echo "skipped: this build has no sessions"
  exit 0
fi
RATE=30
small small.session 60
seed=4711
random() { # random LIMIT: 0 to LIMIT-1 in $value, the same in every run
  seed=$(((seed * 1103515245 + 12345) % 2147483648))
  value=$((seed / 65536 % $1))
}

# record_and_kill NUMBER DELAY_MS CODEC: begins to count when the first frame was taken over.
record_and_kill() {
  "$PLACIDO" record 'replay:small.session?speed=1&loop=1' --codec "$3" -o "$1.session" -q < /dev/null &
  victim=$!
  wait_for "$1.session/frames.jsonl"
  began=$(date +%s%N)
  sleep "$(printf '%d.%03d' $(($2 / 1000)) $(($2 % 1000)))"
  ended=$(date +%s%N)
  kill -KILL "$victim"
  wait "$victim" 2> /dev/null || true
  echo $(((ended - began) / 1000000)) > "$1.ms"
}

# judge NUMBER: frames that can be read against those of all but the last second.
judge() {
  status=0
  "$PLACIDO" record "$1.session" -o "$1-read.session" -q 2> err.txt || status=$?
  if [ "$status" -ne 0 ]; then
    fail "kill $1, after $(cat "$1.ms") ms: exit $status"
    cat err.txt
    return
  fi
  read_frames=$(lines "$1-read.session/frames.jsonl")
  taken=$((1 + RATE * $(cat "$1.ms") / 1000))
  handed_over=$(lines "$1.session/frames.jsonl")
  echo "kill $1: after $(cat "$1.ms") ms, $taken taken, $handed_over written, $read_frames readable"
  [ "$read_frames" -ge $((taken - RATE)) ] || fail "kill $1: more than a second is lost"
}

number=0
while [ "$number" -lt "${KILLS:-8}" ]; do
  batch=$number
  while [ "$number" -lt "${KILLS:-8}" ] && [ "$number" -lt $((batch + 4)) ]; do
    random 2500
    delay_ms=$value
    random 3
    case $value in 0) codec=ffv1 ;; 1) codec=ffvhuff ;; *) codec=raw ;; esac
    record_and_kill "$number" "$delay_ms" "$codec" &
    number=$((number + 1))
  done
  wait
done
number=0
while [ "$number" -lt "${KILLS:-8}" ]; do
  judge "$number"
  number=$((number + 1))
done
finish
