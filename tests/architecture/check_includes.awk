# Holds every #include against the list of what each library may see.
#
#   awk -f check_includes.awk libraries.txt includes.txt
#
# libraries.txt  name|folder|seen,...|public headers,...   (written by cmake/PlacidoLibrary.cmake)
# includes.txt   path:line:#include ...                     (grep -n, paths relative to the root)
# Prints a line for every violation and ends with status 1 where there was one.
BEGIN { FS = "|" }

FILENAME == ARGV[1] {
  if ($1 == "") next
  folder_of[$1] = $2
  count = split($3, list, ",")
  sees[$1, $1] = 1
  for (i = 1; i <= count; i++) sees[$1, list[i]] = 1
  count = split($4, list, ",")
  for (i = 1; i <= count; i++) header_owner[list[i]] = $1
  next
}

# The library with the longest folder that the path lies in; "" where there is none.
function owner_of(path,   name, best, length_of_best) {
  best = ""; length_of_best = 0
  for (name in folder_of) {
    if (index(path, folder_of[name] "/") == 1 && length(folder_of[name]) > length_of_best) {
      best = name; length_of_best = length(folder_of[name])
    }
  }
  return best
}

function complain(text) {
  print file ":" line ": " text
  failed = 1
}

{
  split($0, part, ":")
  file = part[1]; line = part[2]
  if (file ~ /^include\/placido\//) {
    name = file; sub(/^include\/placido\//, "", name)
    user = header_owner[name]
    if (user == "") { complain("the public header " name " belongs to no library"); next }
  } else if (file ~ /^acquire\/cli\//) {
    next # the program sees everything
  } else {
    user = owner_of(file)
    if (user == "") next
  }

  target = $0
  if (target ~ /#[ \t]*include[ \t]*</) {
    sub(/.*#[ \t]*include[ \t]*</, "", target); sub(/>.*/, "", target)
    if (target ~ /^opencv2\// && file !~ /^base\/cv\//) complain("OpenCV is seen only by base/cv")
    if (target !~ /^placido\//) next
    sub(/^placido\//, "", target)
    owner = header_owner[target]
    shown = "<placido/" target ">"
  } else {
    sub(/.*#[ \t]*include[ \t]*"/, "", target); sub(/".*/, "", target)
    owner = owner_of(target)
    shown = "\"" target "\""
  }
  checked++
  if (target ~ /^acquire\/cli\//) complain(shown " is the program's own")
  else if (owner == "") complain(shown " belongs to no library")
  else if (!((user, owner) in sees)) complain(user " includes " shown " of " owner ", which it does not see")
}

END {
  if (checked == 0) { print "no include was checked"; exit 1 }
  exit failed
}
