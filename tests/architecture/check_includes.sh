#!/bin/sh
# check_includes.sh LIBRARIES_TXT ROOT: fails where a library includes what it may not see.
set -eu
libraries=$1
root=$2
here=$(cd "$(dirname "$0")" && pwd)
list=$(mktemp)
trap 'rm -f "$list"' EXIT

cd "$root"
folders=$(cut -d'|' -f2 "$libraries" | sort -u)
# -r through a folder meets the folders of other libraries inside it as well; the owner of a file is found by the
# longest folder, and sort -u removes what is met twice.
# shellcheck disable=SC2086
grep -rnE --include='*.[ch]' --include='*.cpp' '^[ 	]*#[ 	]*include' $folders include/placido |
  sort -u > "$list"
awk -f "$here/check_includes.awk" "$libraries" "$list"
