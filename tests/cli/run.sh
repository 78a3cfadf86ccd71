#!/bin/sh
# Runs one CLI test: a script whose commands see the program as $SCREE, an empty folder as the current
# one, $DATA (tests/data) and $SCREE_SCAN_DATA. Beside NAME.sh lies NAME.out: what stdout, stderr and the
# exit codes must be, as the script's own output (2>&1). UPDATE=1 writes it anew.
# usage: run.sh PROGRAM SCRIPT
set -u
SCREE=$1
script=$2
here=$(cd "$(dirname "$script")" && pwd)
script=$here/$(basename "$script")
DATA=$here/../data
NO_COLOR=1
export SCREE DATA NO_COLOR
# `run WORDS...` shows the words, the output and the exit code.
run() {
  echo "\$ scree $*"
  "$SCREE" "$@"
  code=$?
  [ $code -eq 0 ] || echo "exit code $code"
}
folder=$(mktemp -d)
trap 'rm -rf "$folder" "$folder.out"' EXIT
cd "$folder" || exit 1
(. "$script") >"$folder.out" 2>&1 </dev/null
expected=${script%.sh}.out
if [ "${UPDATE:-}" = 1 ]; then
  cp "$folder.out" "$expected"
  exit 0
fi
diff -u "$expected" "$folder.out"
