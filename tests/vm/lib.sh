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

# value KEY FILE: of a line "KEY VALUE" as stream prints them.
value() {
  sed -n "s/^$1 //p" "$2" | head -n 1
}

# is KEY OPERATOR NUMBER FILE: "is dropped -eq 0 stream.out".
is() {
  test "$(value "$1" "$4")" "$2" "$3" || { cat "$4"; return 1; }
}
