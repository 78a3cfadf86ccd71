#!/bin/sh
# Runs the tests of a build and names at the end what was skipped: whole tests, and single ones in a program.
# The tests slow.* take longer than a change can wait for: with SCREE_SLOW=1 they run too (tools/nightly.sh).
# usage: test.sh PRESET [CTEST_OPTIONS...]
preset=$1
shift
cd "$(dirname "$0")/.." || exit 1
code=0
[ -n "${SCREE_SLOW:-}" ] || set -- -E '^slow\.' "$@"
ctest --preset "$preset" "$@" || code=$?
log=build/$preset/Testing/Temporary/LastTest.log
awk '/^[0-9]+\/[0-9]+ Testing: / { test = $3; why = "" }
  /^skipped: / { why = ": " substr($0, 10) }
  /^\[  SKIPPED \] [0-9]+ test/ { next }
  /^\[  SKIPPED \] / { sub(/^[^]]*\] */, ""); name = test " (" $0 ")"; if (!seen[name]++) skipped[++count] = name }
  /^Test Skipped/ { skipped[++count] = test why }
  END { if (count) print "\nskipped:"
    for (i = 1; i <= count; i++) print "  " skipped[i] }' "$log"
exit $code
