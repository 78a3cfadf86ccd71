#!/bin/sh
# Whether each fallible public function has an allocation-failure test or a stated reason to have none.
#
# A test is a function `static scree_status NAME(void *context, scree_error *error)` that calls the
# public function and is given to check_allocation_failures (tests/support/alloc_fail.h). Reasons stand
# in tests/allocations.txt, a line each: the function, then why. Also fails on a reason that is not
# needed, and with -l lists where each function is tested.
# usage: allocations.sh SOURCE_DIR [-l]
set -eu
root=$1
list=${2:-}
reasons=$root/tests/allocations.txt

# fallible public functions
functions=$(cat "$root"/include/scree/*.h | tr '\n' ' ' | grep -o 'SCREE_API scree_status scree_[a-z0-9_]*(' |
  sed 's/.* //; s/(//' | sort -u)

# "file function" for each public function called in a tested fallible_call
tested=$(for file in "$root"/tests/*/*.c; do
  grep -q check_allocation_failures "$file" || continue
  tr '\n' ' ' <"$file" | grep -o 'check_allocation_failures[a-z_]*([a-z0-9_]*' | sed 's/.*(//' | sort -u |
    while read -r name; do
      awk -v name="$name" '
        $0 ~ "^static scree_status " name "\\(" { inside = 1 }
        inside { print }
        /^}/ { inside = 0 }' "$file" | grep -o 'scree_[a-z0-9_]*(' | sed "s|(||; s|^|${file##*/tests/} |"
    done
done | sort -u)

failed=0
for function in $functions; do
  where=$(echo "$tested" | awk -v f="$function" '$2 == f { print $1 }' | paste -sd' ')
  reason=$(sed -n "s/^$function  *//p" "$reasons")
  if [ -z "$where$reason" ]; then
    echo "$function: no allocation-failure test, and no reason in tests/allocations.txt"
    failed=1
  elif [ -n "$where" ] && [ -n "$reason" ]; then
    echo "$function: tested in $where; its line in tests/allocations.txt can go"
    failed=1
  elif [ -n "$list" ]; then
    echo "$function: ${where:-not tested: $reason}"
  fi
done
for function in $(sed -n 's/^\(scree_[a-z0-9_]*\) .*/\1/p' "$reasons"); do
  echo "$functions" | grep -qx "$function" || {
    echo "$function in tests/allocations.txt is no fallible public function"
    failed=1
  }
done
exit $failed
