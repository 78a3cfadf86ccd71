#!/bin/sh
# Runs one CLI test: a script whose commands see the program as $SCREE, an empty folder as the current
# one, and $SCREE_SCAN_DATA. Beside NAME.sh lies NAME.out: what stdout, stderr and the
# exit codes must be, as the script's own output (2>&1). UPDATE=1 writes it anew.
# usage: run.sh PROGRAM SCRIPT
set -u
SCREE=$(realpath "$1")
script=$2
here=$(cd "$(dirname "$script")" && pwd)
script=$here/$(basename "$script")
NO_COLOR=1
export SCREE NO_COLOR
# `run WORDS...` shows the words, the output and the exit code.
run() {
  echo "\$ scree $*"
  "$SCREE" "$@"
  code=$?
  [ $code -eq 0 ] || echo "exit code $code"
}
# `lines 2` or `lines 1,4`: so many of what was said; a line of progress, which a busy machine adds, is none of them.
lines() { sed '/^scree, after /d' | sed -n "$1p"; }
# `box X Y Z` writes a box from the origin to (X, Y, Z) in six quads, as OFF.
box() {
  printf 'OFF\n8 6 0\n'
  for z in 0 "$3"; do printf '0 0 %s\n%s 0 %s\n%s %s %s\n0 %s %s\n' $z "$1" $z "$1" "$2" $z "$2" $z; done
  printf '4 0 3 2 1\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n'
}
folder=$(mktemp -d)
XDG_CACHE_HOME=$folder.cache
export XDG_CACHE_HOME
trap 'rm -rf "$folder" "$folder.out" "$XDG_CACHE_HOME"' EXIT
cd "$folder" || exit 1
# lines of progress depend on the machine
(. "$script") 2>&1 </dev/null | sed '/^scree, after /d' >"$folder.out"
expected=${script%.sh}.out
if [ "${UPDATE:-}" = 1 ]; then
  cp "$folder.out" "$expected"
  exit 0
fi
diff -u "$expected" "$folder.out"
