#!/bin/sh
# Builds and runs some tests, by their names for ctest. usage: tools/check.sh PRESET -j JOBS TEST...
set -eu
preset=$1 jobs=$3
cd "$(dirname "$0")/.."
shift 3
[ $# -gt 0 ] || { echo "check.sh: no test is named; DIR=src/world names a folder's" >&2; exit 2; }
cmake --preset "$preset" -DBUILD_TESTING=ON >build.log 2>&1 || { cat build.log; exit 1; }
rm -f build.log
# of unit.weld and the like the program unit_weld; the others are scripts that take the program
targets=$(printf '%s\n' "$@" | sed -n 's/^\(unit\|law\|golden\|fuzz\|example\)\./\1_/p')
# shellcheck disable=SC2086
cmake --build --preset "$preset" -j "$jobs" --target scree $targets
ctest --preset "$preset" -j "$jobs" -R "^($(printf '%s\n' "$@" | sed 's/\./\\./g' | paste -sd '|'))$"
