#!/bin/sh
# `placido record`: bit for bit what the device gave, drops and gaps told, and an orderly session in every way out.
. "$(dirname "$0")/harness.sh"
. "$(dirname "$0")/recording.sh"
if [ "$SESSIONS" != ON ]; then
  echo "skipped: this build has no sessions"
  exit 0
fi
small small.session 40

# What frames.jsonl says of the frames, less what a replay does not tell; with the checksum of the samples.
of_frames() {
  sed 's/"exposure_us":[^,]*,"gain_db":[^,]*,//' "$1/frames.jsonl"
}
same_frames() {
  of_frames "$1" > one.txt
  of_frames "$2" > other.txt
  cmp -s one.txt other.txt || fail "$2 has not the frames of $1"
  succeed session check "$2"
}

# A copy, in every codec: frames, times and counter as they were, decoded and held against their checksums.
for codec in auto ffv1 ffvhuff raw; do
  succeed record small.session --codec "$codec" --eye OS --subject P-0042_b -o "$codec.session"
  same_frames small.session "$codec.session"
done
says '"eye": "OS"' raw.session/session.json
says '"subject": "P-0042_b"' raw.session/session.json
says '"frame_rate_hz": 30' raw.session/session.json
says '"driver": "replay"' raw.session/session.json
[ "$(lines raw.session/events.jsonl)" -eq 0 ] || fail "a recording without an event has one"
cmp -s small.session/instrument.json raw.session/instrument.json || fail "another instrument"

# Sixteen bits.
"$PLACIDO" phantom --eye sphere --instrument ./small.instrument.json --frames 4 --bits 12 -o deep.session -q
succeed record deep.session -o deep-copy.session
same_frames deep.session deep-copy.session
says '"bit_depth": 12' deep-copy.session/session.json

# How long.
succeed record small.session --frames 7 -o seven.session
[ "$(lines seven.session/frames.jsonl)" -eq 7 ] || fail "--frames 7 gives another number"
succeed record small.session --for 0.5 -o half.session
[ "$(lines half.session/frames.jsonl)" -eq 15 ] || fail "half a second of 30 frames/s is not 15"

# A gap in the device's counter is told, and copied as it is.
cp -r small.session gap.session
awk -F'"sequence":' '{ split($2, rest, ","); n = rest[1] + 0; if (n >= 20) n += 5; sub(/^[0-9]+/, n, $2); print $1 FS $2 }' \
  OFS='' small.session/frames.jsonl > gap.session/frames.jsonl
status=0
"$PLACIDO" record gap.session -o gap-copy.session --json > out.txt 2> err.txt || status=$?
[ "$status" -eq 5 ] || fail "a gap: exit $status"
json out.txt - frames dropped missing damaged codec output command exit_code error
says '"missing": 5' out.txt
says '"frames": 40' out.txt
says 'not every frame was recorded: 0 dropped .*, 5 missing' err.txt
says '"frames missing","text":"5 before sequence 25' gap-copy.session/events.jsonl
of_frames gap.session > one.txt
of_frames gap-copy.session > other.txt
cmp -s one.txt other.txt || fail "the copy of a gap is another"

# Bursts: space at the first frame, three frames behind it.
status=0
printf ' ' | "$PLACIDO" record small.session --trigger key --burst 3 --bursts 1 -o burst.session > out.txt 2> err.txt ||
  status=$?
[ "$status" -eq 0 ] || fail "a burst: exit $status"
[ "$(lines burst.session/frames.jsonl)" -eq 3 ] || fail "a burst of 3 has another number"
sed -n 2,4p small.session/frames.jsonl | sed 's/.*"crc32"//' > one.txt
sed 's/.*"crc32"//' burst.session/frames.jsonl > other.txt
cmp -s one.txt other.txt || fail "a burst has other frames"
says '"trigger","text":"key"' burst.session/events.jsonl
says '"burst begins","text":"index 0"' burst.session/events.jsonl
says '"burst ends","text":"index 3"' burst.session/events.jsonl
says '"best frame","text":"index [012], sequence [123], score' burst.session/events.jsonl
status=0
printf 'q' | "$PLACIDO" record 'replay:small.session?speed=1&loop=1' --trigger key -o none.session > out.txt 2> err.txt ||
  status=$?
[ "$status" -eq 4 ] || fail "no burst: exit $status"
says 'nothing was recorded: no burst' err.txt
have_not none.session

# Ctrl-C and its kin end it in order.
for signal in INT TERM HUP; do
  status=0
  timeout --preserve-status -s "$signal" 2 "$PLACIDO" record 'replay:small.session?speed=1&loop=1' \
    -o "$signal.session" > out.txt 2> err.txt || status=$?
  [ "$status" -eq 0 ] || fail "SIG$signal: exit $status"
  says 'frames in [0-9.]+ s' out.txt
  succeed session check "$signal.session"
done

# A full disk: told, and what came before it is there.
status=0
(ulimit -f 200; exec "$PLACIDO" record 'replay:small.session?loop=1' --codec raw --frames 2000 -o full.session) \
  > out.txt 2> err.txt || status=$?
[ "$status" -eq 1 ] || fail "a full disk: exit $status"
says 'full.session.*: File too large \(what came before is in full.session\)' err.txt
succeed record full.session -o full-copy.session
[ "$(lines full-copy.session/frames.jsonl)" -ge 3 ] || fail "a full disk has cost what came before"
sed 's/.*"crc32"//' small.session/frames.jsonl > one.txt
sed 's/.*"crc32"//' full-copy.session/frames.jsonl | head -n 3 > other.txt
head -n 3 one.txt | cmp -s - other.txt || fail "a full disk has changed what came before"

# A pedal that is no pedal, a light that is none.
refuse 3 'no control "light"' record small.session --light small.session -o out.session
refuse 1 'replay device tells of no events' record small.session --trigger pedal --pedal small.session \
  -o out.session

# Never a name, never a birth date.
refuse 2 'a name is never stored' record small.session --subject 'Jane Doe' -o out.session
refuse 2 'a name is never stored' record small.session --subject 'Müller' -o out.session
refuse 2 '1 to 32' record small.session --subject "$(printf '%033d' 0)" -o out.session
refuse 2 'a date of birth is never stored' record small.session --subject 1970-01-31 -o out.session
refuse 2 'a date of birth is never stored' record small.session --subject P_31_1_1970 -o out.session
refuse 2 'a date of birth is never stored' record small.session --subject jd19700131 -o out.session
refuse 2 'a date of birth is never stored' record small.session --subject 31121970 -o out.session
succeed record small.session --subject 40711234-19 --frames 1 -o number.session

# What is wrong is said before anything is made.
"$PLACIDO" phantom --eye sphere --instrument ./small.instrument.json -o eye.png -q
refuse 2 'say where the result goes' record small.session
refuse 2 'NAME.session was expected' record small.session -o out
refuse 1 'small.session exists' record small.session -o small.session
refuse 2 'give it with --instrument' record eye.png -o out.session
refuse 2 '--codec h264: ffv1\|ffvhuff\|raw\|auto' record small.session --codec h264 -o out.session
refuse 2 '--trigger key,foot: key.pedal.auto was expected' record small.session --trigger key,foot -o out.session
refuse 2 '--burst: say what starts a burst' record small.session --burst 5 -o out.session
refuse 2 'say which one with --pedal' record small.session --trigger pedal -o out.session
refuse 2 '--pedal: it starts bursts' record small.session --pedal gpio:x -o out.session
refuse 2 'OD .* OS' record small.session --eye left -o out.session
refuse 1 'none.json' record small.session --instrument none.json -o out.session
refuse 1 'no driver "sonar"' record sonar:7 -o out.session
refuse 1 'cannot create the session' record small.session -o nowhere/out.session
succeed record eye.png --instrument small.instrument.json -o image.session
[ "$(lines image.session/frames.jsonl)" -eq 1 ] || fail "an image is one frame"

# On a terminal: keys come at once, and the terminal is as it was afterwards.
if command -v script > /dev/null; then
  cat > on_terminal.sh <<'END'
stty -a > before.txt
(
  until [ -s keys.session/session.json ]; do sleep 0.05; done
  sleep 0.3
  stty -a < /dev/tty > during.txt
  kill -TERM "$(cat pid.txt)"
) &
sh -c 'echo $$ > pid.txt; exec "$PLACIDO" record "replay:small.session?speed=1&loop=1" --trigger key -o keys.session'
stty -a > after.txt
END
  script -qec "sh on_terminal.sh" /dev/null < /dev/null > /dev/null 2>&1 || true
  cmp -s before.txt after.txt || fail "the terminal is not what it was"
  says ' -icanon' during.txt
fi
finish
