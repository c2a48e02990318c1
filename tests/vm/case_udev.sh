# udev's rules as installed: who may use a device, what it is called, and that a program hears of it.
. tests/vm/lib.sh

modprobe vhci-hcd
modprobe uvcvideo
modprobe gpio-sim
start_udevd
check "cmake --install" cmake --install "$PLACIDO_BUILD" --prefix /usr
if command -v systemd-sysusers > /dev/null; then
  check "systemd-sysusers makes the groups" systemd-sysusers
else
  check "addgroup makes the group" addgroup --system gpio
fi
check "udevadm control --reload" udevadm control --reload
make_session eye 320x240
start watch placido devices --watch --json
start_camera sim eye --face u3v --serial CASE04
start_camera cam eye --face uvc --serial CASE05
chip=/sys/kernel/config/gpio-sim/rules
mkdir -p "$chip/bank"
echo 1 > "$chip/live"
gpio=$(cat "$chip/bank/chip_name")

check "--watch tells of the USB3 Vision camera" wait_for 30 says 'added.*u3v:CASE04' watch.out
check "--watch tells of the kernel's camera" wait_for 30 says 'added.*CASE05' watch.out
check "--watch tells of the chip" wait_for 30 says "added.*gpio:/dev/$gpio" watch.out

# kind, name, group
while read -r driver name group; do
  link=/dev/placido/$name
  check "$link" wait_for 30 test -c "$link"
  node=$(readlink -f "$link")
  check "$node: group $group, nobody else writes" [ "$(stat -c '%G %a' "$node" | sed 's/ .*[014 5]$/ safe/')" = "$group safe" ]
  udevadm info -n "$link" > info.txt
  check "$node: uaccess" says '^E: (CURRENT_)?TAGS=.*:uaccess:' info.txt
  check "$node: known as $driver" says "^E: ID_PLACIDO_DRIVER=$driver\$" info.txt
  udevadm test "$(udevadm info -q path -n "$link")" > info.txt 2>&1
  check "$node: udevadm test finds the name" says "LINK.*placido/$name|placido/$name" info.txt
  grep -E '60-placido.rules:[0-9]+ .*(Invalid|Unknown|ignoring|[Ff]ailed)' info.txt > complaints.txt
  check "$node: udevadm test has no complaint of the rules" [ ! -s complaints.txt ]
done << END
u3v camera-CASE04 plugdev
v4l2 video-CASE05-0 video
gpio gpio-$gpio gpio
END

check "systemd-hwdb takes the database" systemd-hwdb update
systemd-hwdb query 'usb:v1209p0001d0100dcEFdsc02dp01icEFisc05ip00in00' > hwdb.txt
check "it marks such interfaces" says 'ID_PLACIDO_DRIVER=u3v' hwdb.txt

as_member() {
  member=$1
  shift
  setpriv --reuid=65534 --regid=65534 --groups="$(getent group "$member" | cut -d : -f 3)" "$@"
}
chmod 755 "$work"
check "a member of plugdev streams" as_member plugdev "$(command -v stream)" u3v:CASE04 --frames 5
check "a member of video streams by the name" as_member video "$(command -v stream)" \
  v4l2:/dev/placido/video-CASE05-0 --frames 5
as_member games "$(command -v stream)" u3v:CASE04 --frames 5 > stranger.txt
check "a stranger is told that he may not" says '^error .*' stranger.txt
cat stranger.txt

order sim quit
order cam quit
echo 0 > "$chip/live"
check "--watch tells that the one camera goes" wait_for 30 says 'removed.*u3v:CASE04' watch.out
check "--watch tells that the other goes" wait_for 30 says 'removed.*v4l2:' watch.out
check "--watch tells that the chip goes" wait_for 30 says "removed.*gpio:/dev/$gpio" watch.out
check "the names go with them" wait_for 30 [ ! -e /dev/placido/camera-CASE04 ]
finish
