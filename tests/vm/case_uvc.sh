# The simulated UVC camera with the kernel's own driver (uvcvideo): v4l2-ctl, v4l2-compliance and FFmpeg, which we did
# not write, must be content with it, and Placido's driver must take its pictures bit by bit.
. tests/vm/lib.sh

modprobe vhci-hcd
modprobe uvcvideo
start_udevd
make_session eye 320x240
start_camera cam eye --face uvc --serial CASE03 --rate 10
uri='v4l2:serial=CASE03'
seen() {
  placido devices > devices.txt && says "$1" devices.txt
}
check "placido devices lists it" wait_for 30 seen "$uri"
node=$(sed -n 's/^v4l2:\(\S*\) .*serial=CASE03.*/\1/p' devices.txt | head -n 1)

check "v4l2-ctl streams" timeout 60 v4l2-ctl -d "$node" --set-parm 20 --stream-mmap --stream-count=20
check "v4l2-ctl sets the exposure" v4l2-ctl -d "$node" -c exposure_time_absolute=50
v4l2-ctl -d "$node" -C exposure_time_absolute > control.txt
check "and reads it" says ': 50$' control.txt
check "back to where pictures are as shown" v4l2-ctl -d "$node" -c exposure_time_absolute=100
check "ffmpeg takes pictures" timeout 60 ffmpeg -nostdin -v error -f v4l2 -input_format gray -video_size 320x240 \
  -i "$node" -frames:v 10 -f framemd5 "$work/frames.md5"
check "ten of them" [ "$(grep -c '^0,' frames.md5)" -eq 10 ]

# uvcvideo gives up a program's claim to the camera with its last buffer, so that STREAMON without buffers says EBUSY
# where v4l2-compliance wants EINVAL: with every UVC camera, in each of its three tests of mapped buffers.
timeout 60 v4l2-compliance -d "$node" -s5 > compliance.txt 2>&1
check "v4l2-compliance came to its end" says '^Total for uvcvideo' compliance.txt
grep 'fail:' compliance.txt | grep -v 'node->streamon(q.g_type()) != EINVAL' > failures.txt
grep 'FAIL' compliance.txt | grep -v 'test MMAP' >> failures.txt
check "no failure but the kernel's own" [ ! -s failures.txt ]
[ ! -s failures.txt ] || cat failures.txt

check "YUYV" sh -c "stream '$uri?format=YUYV&size=320x240&fps=20' --frames 20 --sums > stream.out"
check "its luma is bit by bit what is shown" shows stream.out eye

# What uvcvideo makes of a fault is its own affair; frames must go on, and those without a flag be whole.
stream_on "$uri?format=GREY&size=320x240&fps=20&replug_s=60"
goes_on "nothing wrong"
for fault in drop corrupt truncate misnumber lost-start lost-end stall; do
  order cam "$fault"
  goes_on "$fault"
done
check "the stall was mended" [ "$(counted restarts)" -ge 1 ]
order cam "disconnect 3"
check "unplugged: comes back in time" wait_for 60 exceeds replugs 0
goes_on "replugged"
end_stream
check "gaps were counted as dropped" [ "$(counted gaps)" -eq "$(counted dropped)" ]
check "every frame without a flag is bit by bit what is shown" shows stream.out eye

stream_on "$uri?fps=20"
order cam "disconnect 3"
wait "$streaming"
check "unplugged without patience: gone" is status -eq -8 stream.out
check "it comes back" wait_for 60 seen "$uri"
finish
