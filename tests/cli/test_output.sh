#!/bin/sh
# Where results go: nothing of a person's is lost, nothing half-written stays, whatever ends the program.
. "$(dirname "$0")/harness.sh"

succeed phantom --eye normal --instrument cone24 -o eye.png
exam="exam eye.png --instrument eye.instrument.json --axis-z 0 --pupils 3"

# no_leftovers WHAT: no temporary name may be there.
no_leftovers() {
  found=$(find . -name '*.tmp' -o -name '*.old')
  [ -z "$found" ] || fail "$1 leaves $found"
}

echo "== an earlier result goes, a person's file does not"
# shellcheck disable=SC2086
{
  succeed $exam -q -o exam
  echo precious > exam/letter.txt
  refuse 1 'exam holds letter.txt beside an earlier result: not overwritten' $exam -o exam
  [ "$(cat exam/letter.txt)" = precious ] || fail "a person's file was touched"
  rm exam/letter.txt
  succeed $exam -q -o exam/
  refuse 1 'exists, and there is no reconstruction.json' reconstruct eye.png --instrument eye.instrument.json -o exam
  refuse 2 'value is empty' $exam -o ''
  refuse 1 'eye.png' $exam -o eye.png
  refuse 1 'eye.png/x' $exam -o eye.png/x
  succeed $exam -q -o 'a "b" ü
c'
  have 'a "b" ü
c/exam.json'
}

echo "== twice at once: one of them, whole"
# shellcheck disable=SC2086
{
  "$PLACIDO" $exam -q -o twin &
  first=$!
  "$PLACIDO" $exam -q -o twin || true
  wait "$first" || true
}
have twin/exam.json twin/maps.csv
no_leftovers "the same output twice"

echo "== signals"
# A run long enough to be stopped; it is, as soon as its temporary directory is there.
for signal in INT TERM HUP; do
  [ "$SESSIONS" = ON ] || break # nothing else takes long enough to be stopped
  # Jobs in the background ignore SIGINT, and what ignores it must not be stopped by it: env resets that.
  env --default-signal=INT "$PLACIDO" phantom --eye normal --instrument cone24 --frames 3000 --noise 1 -o long.session \
    2> err.txt &
  runner=$!
  waited=0
  while [ -z "$(find . -name 'long.session.*.tmp')" ] && [ "$waited" -lt 100 ]; do
    sleep 0.05
    waited=$((waited + 1))
  done
  kill -s "$signal" "$runner"
  status=0
  wait "$runner" || status=$?
  [ "$status" -gt 128 ] || fail "SIG$signal: exit $status"
  says '^placido: phantom: stopped by a signal \(.*\): nothing was written$' err.txt
  no_leftovers "SIG$signal"
  have_not long.session
done

echo "== no room"
# A limit on files stands for a full disk: the write fails, and no signal ends the program.
for output in full.png full.session; do
  [ "$SESSIONS" = ON ] || [ "$output" = full.png ] || continue
  status=0
  (ulimit -f 40 && exec "$PLACIDO" phantom --eye normal --instrument cone24 --noise 2 --frames 2 -o "$output") \
    > out.txt 2> err.txt || status=$?
  [ "$status" -eq 1 ] || fail "a full disk: exit $status"
  [ "$(wc -l < err.txt)" -eq 1 ] || fail "a full disk: not one line"
  says "^placido: phantom: .*$output.*: File too large" err.txt
  ! grep -q '[.]tmp' err.txt || fail "a message names a temporary file"
  no_leftovers "a full disk"
  have_not full.png full.instrument.json full.session
done

echo "== closed streams harm no file"
# shellcheck disable=SC2086
"$PLACIDO" $exam -q -o closed <&- >&- 2>&- || fail "quiet, with its streams closed: exit $?"
json closed/exam.json placido-exam/1 warnings
cmp closed/maps.csv exam/maps.csv || fail "something was printed into a file"

echo "== surroundings that do not matter"
# shellcheck disable=SC2086
env -i PATH="$PATH" LSAN_OPTIONS="${LSAN_OPTIONS:-}" LC_ALL=de_DE.UTF-8 TZ=Nowhere/None HOME=/nonexistent \
  "$PLACIDO" $exam -q -o elsewhere || fail "a German locale: exit $?"
cmp elsewhere/maps.csv exam/maps.csv || fail "the locale changes the tables"
finish
