#!/bin/sh
# What is done with sessions: checked, described, packed, repaired, exported; and nothing of them is ever lost.
. "$(dirname "$0")/harness.sh"

echo "== the command line"
refuse 2 'what to do .* is missing' session
refuse 2 'NAME.session is missing' session check
refuse 2 '"burn" cannot be done to a session' session burn a.session
refuse 2 'check does not take --output' session check a.session -o b
refuse 2 'info does not take --instrument' session info a.session --instrument b
refuse 2 'pack does not take --frames' session pack a.session --frames 1
refuse 2 'repair: say where the result goes with -o' session repair a.session
refuse 2 'type gif: png or tiff' session export a.session -o b --type gif
refuse 2 'frames 5-3: numbers of frames like' session export a.session -o b --frames 5-3
succeed help session
says '^  repair +Make a sound session' out.txt
for option in $(grep -oE '^  .{4}--[a-z-]+' out.txt | sed 's/.*--//'); do
  says "-$option" "$MANUAL/placido-session.1"
done

if [ "$SESSIONS" != ON ]; then
  for verb in check info pack 'repair -o b.session' 'export -o b'; do
    # shellcheck disable=SC2086
    refuse 1 'this build is without FFmpeg' session $verb a.session
  done
  finish
  exit 0
fi

refuse 1 'cannot open the session nowhere' session check nowhere
refuse 1 'cannot open the session nowhere' session info nowhere
refuse 1 'cannot open the session nowhere' session pack nowhere
refuse 1 'cannot open the session nowhere' session repair nowhere -o b.session
refuse 1 'cannot open the session nowhere' session export nowhere -o b
mkdir empty.session
refuse 3 'has no session.json' session info empty.session
refuse 3 'has no frames.mkv' session repair empty.session -o b.session

echo "== sound"
succeed phantom --eye normal --instrument cone24 --frames 6 --noise 2 -o eye.session
succeed session check eye.session
says '^frames.mkv +sound +6 frames, 1280 x 1024, 8 bit, ffv1' out.txt
says '^clock +sound .*30.00 frames/s' out.txt
says 'eye.session is sound' out.txt
succeed session check eye.session --json
json out.txt - sound findings frames.codec clock.jitter_ms instrument
succeed session info eye.session
says '^device +Placido phantom' out.txt
succeed session info eye.session --json
json out.txt - device.model frames.count eye
succeed session check eye.session -q
[ ! -s out.txt ] || fail "quiet is not quiet"

echo "== packed"
succeed session pack eye.session
says 'is FFV1 with checksums already' out.txt
cp -r eye.session fast.session
if command -v ffmpeg > /dev/null; then
  ffmpeg -v error -nostdin -y -i eye.session/frames.mkv -c:v rawvideo fast.session/frames.mkv
  cp -r fast.session kept.session
  refuse 1 'eye.session exists and is not empty' session pack fast.session -o eye.session
  succeed session pack fast.session -o packed.session
  says '6 frames, each compared' out.txt
  have packed.session/session.json packed.session/instrument.json packed.session/frames.jsonl
  cmp fast.session/frames.mkv kept.session/frames.mkv || fail "pack -o changed its input"
  cp -r fast.session rest.session
  mkdir rest.session/frames-new
  echo stale > rest.session/frames-new/frames.mkv
  succeed session check rest.session
  says 'frames-new is of a packing that goes on or was stopped' out.txt
  succeed session pack rest.session --json
  json out.txt - packed frames bytes_before bytes_after
  have_not rest.session/frames-new
  succeed session check rest.session
  says 'sound +6 frames, .* ffv1' out.txt

  echo "== no room"
  status=0
  (ulimit -f 1000 && exec "$PLACIDO" session pack fast.session) > out.txt 2> err.txt || status=$?
  [ "$status" -eq 1 ] || fail "a full disk: exit $status"
  says 'frames.mkv: File too large' err.txt
  cmp fast.session/frames.mkv kept.session/frames.mkv || fail "a full disk touches the fast copy"
  have_not fast.session/frames-new

  echo "== stopped"
  cp -r eye.session long.session
  ffmpeg -v error -nostdin -y -stream_loop 9 -i eye.session/frames.mkv -c:v rawvideo long.session/frames.mkv
  before=$(cksum < long.session/frames.mkv)
  for signal in INT TERM; do
    env --default-signal=INT "$PLACIDO" session pack long.session 2> err.txt &
    runner=$!
    waited=0
    while [ ! -s long.session/frames-new/frames.mkv ] && [ "$waited" -lt 200 ]; do
      sleep 0.02
      waited=$((waited + 1))
    done
    kill -s "$signal" "$runner"
    status=0
    wait "$runner" || status=$?
    [ "$status" -gt 128 ] || fail "SIG$signal: exit $status"
    says 'stopped by a signal .*: nothing was written' err.txt
    have_not long.session/frames-new
    [ "$(cksum < long.session/frames.mkv)" = "$before" ] || fail "SIG$signal touches the fast copy"
  done
fi

echo "== torn"
cp -r eye.session torn.session
size=$(wc -c < eye.session/frames.mkv)
head -c $((size * 2 / 3)) eye.session/frames.mkv > torn.session/frames.mkv
printf '{"index":' >> torn.session/frames.jsonl
status=0
"$PLACIDO" session check torn.session > out.txt 2> err.txt || status=$?
[ "$status" -eq 4 ] || fail "a torn session: exit $status"
says '^frames.mkv +damaged +has no proper end' out.txt
says '^frames.jsonl +damaged +1 bad lines' out.txt
says '^placido: session: torn.session is damaged' err.txt
refuse 3 'its video has no proper end: not packed' session pack torn.session
succeed session repair torn.session -o good.session
says 'good.session: [34] frames kept' out.txt
says 'lost: 1 lines of frames.jsonl' out.txt
succeed session check good.session
grep -q '"eye": *"OD"' good.session/session.json || fail "the description was not kept"
refuse 1 'good.session exists and is not empty' session repair torn.session -o good.session
rm torn.session/instrument.json
refuse 3 'has no instrument.json: give the instrument' session repair torn.session -o other.session
succeed session repair torn.session -o other.session --instrument eye.session/instrument.json --json
json out.txt - kept damaged cut_off
refuse 1 'nowhere.json' session repair torn.session -o third.session --instrument nowhere.json

echo "== exported"
succeed session export eye.session -o pictures --frames 0,4-5
[ "$(ls pictures)" = "frame-000000.png
frame-000004.png
frame-000005.png" ] || fail "the wrong frames were exported"
refuse 1 'pictures exists and is not empty' session export eye.session -o pictures
refuse 3 'has no frame 6 \(it has 6, counted from 0\)' session export eye.session -o more --frames 3-6
succeed session export eye.session -o tiffs --type tiff --json
json out.txt - frames output
have tiffs/frame-000005.tiff
succeed reconstruct pictures/frame-000004.png --instrument eye.session/instrument.json --axis-z 0 -o measured
finish
