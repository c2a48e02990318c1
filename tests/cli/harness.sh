# What the tests of the program share: a place to work in, and ways to expect things. Sourced, not run.
#
# PLACIDO, JSON_CHECK   the programs
# SESSIONS, FIGURES     ON or OFF, as the build has them
set -eu
work=$(mktemp -d)
# Folders that a test made read-only must be removable.
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cd "$work"
export TMPDIR="$work"
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

finish() {
  if [ "$failures" -ne 0 ]; then
    echo "$failures failed"
    exit 1
  fi
  echo "all passed"
}

# succeed ARGUMENT...: the program must end with 0; out.txt and err.txt keep what it said.
succeed() {
  status=0
  "$PLACIDO" "$@" > "$work/out.txt" 2> "$work/err.txt" || status=$?
  if [ "$status" -ne 0 ]; then
    fail "placido $*: exit $status"
    cat "$work/err.txt"
  fi
}

# refuse EXIT PATTERN ARGUMENT...: the program must end with EXIT, say one line to stderr that matches PATTERN (the
# warnings before it apart), nothing to stdout, and leave the folder as it was.
refuse() {
  expected=$1
  pattern=$2
  shift 2
  touch out.txt err.txt before.txt after.txt
  find . | sort > before.txt
  status=0
  "$PLACIDO" "$@" > out.txt 2> err.txt || status=$?
  find . | sort > after.txt
  lines=$(grep -vc '^placido: warning: ' err.txt || true)
  if ! echo "$status" | grep -Eqx "$expected"; then
    fail "placido $*: exit $status, not $expected"
    cat err.txt
  elif [ "$lines" -ne 1 ]; then
    fail "placido $*: $lines lines instead of one"
    cat err.txt
  elif ! grep -Eq "^placido: .*($pattern)" err.txt; then
    fail "placido $*: does not say \"$pattern\""
    cat err.txt
  elif [ -s out.txt ]; then
    fail "placido $*: writes to standard output"
  elif ! cmp -s before.txt after.txt; then
    fail "placido $*: leaves something behind"
    diff before.txt after.txt || true
  else
    echo "refused ($status): $(tail -n 1 err.txt)"
  fi
}

# have FILE...: files that must be there and not be empty.
have() {
  for file in "$@"; do
    [ -s "$file" ] || fail "$file is missing or empty"
  done
}

# have_not FILE...
have_not() {
  for file in "$@"; do
    [ ! -e "$file" ] || fail "$file should not be there"
  done
}

# json FILE FORMAT KEY...: the file must parse, be of the format ("-": any), and have the keys ("a.b").
json() {
  "$JSON_CHECK" "$@" || fail "$1 is not as it should be"
}

# says PATTERN FILE
says() {
  grep -Eq -e "$1" "$2" || fail "\"$1\" is not in $2"
}
