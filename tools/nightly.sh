#!/usr/bin/env bash
# What is worth running but takes too long for `make test` and .ci/run: hours in all. Goes on where a part fails,
# and names at the end what did.
# usage: nightly.sh [DATA_DIR]      DATA_DIR: the folder of real scans that some tests read
set -uo pipefail
cd "$(dirname "$0")/.."
data=${1:-}
[ -n "$data" ] && data=$(cd "$data" && pwd)
failed=()

# `part TITLE COMMAND...`
part() {
  printf '\n== %s (%s s)\n' "$1" "$SECONDS"
  "${@:2}" || failed+=("$1")
}
# `build PRESET [CMAKE_OPTIONS...]`, and the tests with it
build() {
  cmake --preset "$1" -DSCREE_DATA_DIR="$data" -DBUILD_TESTING=ON "${@:2}" >/dev/null && cmake --build --preset "$1"
}

tools/install-packages.sh build test ci
part "release build" build release
part "all tests, the slow ones too" tools/test.sh release
# `native COMPILER`: the states of tests/golden, by code for this very machine
native() {
  cmake -S . -B "build/native-$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$1" \
    -DCMAKE_C_FLAGS=-march=native -DBUILD_TESTING=ON >/dev/null &&
    cmake --build "build/native-$1" --target golden_world && "build/native-$1/bin/golden_world"
}
part "the same bits with -march=native, gcc" native gcc
part "the same bits with -march=native, clang" native clang
part "sanitizer build" build asan
part "slow and long tests under ASan and UBSan" tools/test.sh asan -L 'slow|long'
part "fuzzing build" build fuzz -DSCREE_FUZZ_SECONDS=1200
part "fuzzing, twenty minutes for each reader" ctest --preset fuzz
part "decimation and the whole job against their peers" bench/run.sh
part "checks of real scans against their peers" bench/check.sh
part "worlds against their peers" bench/world.sh

printf '\n%d s; ' "$SECONDS"
if [ ${#failed[@]} -eq 0 ]; then
  echo "nothing failed"
else
  echo "failed:"
  printf '  %s\n' "${failed[@]}"
  exit 1
fi
