# The simulated USB3 Vision camera: Aravis, which we did not write, must understand it, and Placido's driver must take
# its pictures bit by bit and come through all its faults.
. tests/vm/lib.sh

modprobe vhci-hcd
start_udevd
make_session eye 320x240
start_camera sim eye --face u3v --serial CASE01 --rate 20
seen() {
  placido devices > devices.txt && says "$1" devices.txt
}
check "placido devices lists it" wait_for 30 seen 'u3v:CASE01 '

aravis_sees() {
  arv-tool-0.8 > aravis.txt 2>&1 && says "$1" aravis.txt
}
check "arv-tool lists it" wait_for 30 aravis_sees CASE01
name=$(sed -n 's/ (.*//p' aravis.txt)
check "arv-tool reads and writes" timeout 60 arv-tool-0.8 -n "$name" control Width=160 PixelFormat=Mono12 PayloadSize \
  ExposureTime=2000 Gain=1 DeviceTemperature
cp said aravis.txt
check "the width is 160" says 'Width = 160 ' aravis.txt
check "the payload follows: 160 x 240 x 2" says 'PayloadSize = 76800 ' aravis.txt
check "the exposure is 2 ms" says 'ExposureTime = 2000 ' aravis.txt
check "arv-tool sets it back" timeout 60 arv-tool-0.8 -n "$name" control Width=320 PixelFormat=Mono8 ExposureTime=5000 \
  Gain=0
for mode in "" "-s async"; do
  # shellcheck disable=SC2086
  check "arv-camera-test $mode streams" timeout 60 arv-camera-test-0.8 $mode -n "$name" --duration 3
  cp said aravis.txt
  check "pictures came" says 'n_completed_buffers += [1-9]' aravis.txt
  check "no buffer failed" says 'n_failures += 0$' aravis.txt
done

for format in Mono10p Mono12Packed; do
  check "$format" stream "u3v:CASE01?format=$format&size=160x120" --frames 5
done

# fault, what it is counted as, what it must not be
stream_on 'u3v:CASE01?format=Mono8&size=320x240&replug_s=60'
goes_on "nothing wrong"
while read -r fault key other; do
  before=$(counted "$key")
  spared=$(counted "$other")
  order sim "$fault"
  check "$fault: counted as $key" wait_for 60 exceeds "$key" "$before"
  goes_on "$fault"
  check "$fault: not $other" [ "$(counted "$other")" -eq "$spared" ]
done << 'END'
stall restarts flagged
drop dropped restarts
corrupt corrupt restarts
truncate truncated restarts
misnumber flagged restarts
lost-start restarts flagged
lost-end restarts flagged
END
order sim "disconnect 3"
check "unplugged: comes back in time" wait_for 60 exceeds replugs 0
goes_on "replugged"
end_stream
check "gaps were counted as dropped" [ "$(counted gaps)" -eq "$(counted dropped)" ]
check "every frame without a flag is bit by bit what is shown" shows stream.out eye

stream_on u3v:CASE01
order sim "disconnect 3"
wait "$streaming"
check "unplugged without patience: gone" is status -eq -8 stream.out
check "it comes back" wait_for 60 seen 'u3v:CASE01 '
for fault in "pending 3" "silent 2" "garble 1" "slow 30"; do
  order sim "$fault"
done
check "slow, and with answers that are late, lost or garbled: opens and streams" stream u3v:CASE01 --frames 5
order sim "slow 0"
order sim "refuse 1"
stream u3v:CASE01 --frames 1 > stream.out
check "refuse: said in a sentence" says '^error .*refuses to read' stream.out

start_camera old eye --face u3v --serial CASE02 --rate 10 --high-speed --zip
check "a camera of USB 2, its description zipped, is Aravis's" wait_for 60 aravis_sees CASE02
check "and Placido's" stream u3v:CASE02 --frames 5
finish
