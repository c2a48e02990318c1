#!/bin/sh
# The whole program: an examination again, and by 1, 2 and 8 threads, writes the same files but for when and how long.
. "$(dirname "$0")/harness.sh"

# What tells of the time and of how the program was called is taken out of JSON files; the page, which quotes them, is
# left out.
timeless() {
  sed -E -e '/"seconds": *\{/,/\}/d' \
    -e '/"(seconds[a-z_]*|created|directory|command|threads)": /d' "$1"
}

# same DIR DIR: fails where a file is missing in one of them or differs.
same() {
  (cd "$1" && find . -type f | sort) > "$work/first.txt"
  (cd "$2" && find . -type f | sort) > "$work/second.txt"
  cmp -s first.txt second.txt || { fail "$1 and $2 do not have the same files"; diff first.txt second.txt || true; }
  compared=0
  while read -r file; do
    case $file in
      *.html) continue ;;
      *.json) timeless "$1/$file" > a.txt; timeless "$2/$file" > b.txt ;;
      *) cp "$1/$file" a.txt; cp "$2/$file" b.txt ;;
    esac
    compared=$((compared + 1))
    cmp -s a.txt b.txt || { fail "$file is not the same in $1 and $2"; diff a.txt b.txt | head -n 5 || true; }
  done < first.txt
  [ "$compared" -ge 10 ] || fail "only $compared files were compared"
  echo "$1 and $2: $compared files are the same"
}

succeed phantom --eye keratoconus --instrument cone24 -o eye.png --noise 1 --lashes 5
exam() { # exam DIR THREADS
  succeed exam eye.png --instrument eye.instrument.json --axis-z 0 --pupils 4 --acuity sloan --threads "$2" -o "$1"
}
exam one 1
exam again 1
exam two 2
exam eight 8
same one again
same one two
same one eight
finish
