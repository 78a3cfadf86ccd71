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

# scree.exe, cross-built and run under Wine.
windows() {
  tools/install-packages.sh windows && tools/library-sources.sh build/library-sources && cmake --preset windows >/dev/null &&
    cmake --build --preset windows && tests/windows/run.sh build/windows/bin/scree.exe build/release/bin/scree
}

# The page and the npm package, and their tests with a large scan. Not in .ci/run: on a bare Debian emscripten alone
# takes 800 MB, and it builds all of the program once more.
browser() {
  make page npm && cc -O2 -std=gnu17 bench/decimation/shape.c -o "$shapes/shape" -lm && "$shapes/shape" phone 762008 "$shapes/phone.stl" &&
    SCREE_SCAN="$shapes/phone.stl" ctest --preset release --output-on-failure -R '^page\.' &&
    tests/page/picture.py build/page/scree.html build/page/browser.png
}

# Samples at 20, 60 and 200 triangles, to pour.
shapes=$(mktemp -d)
trap 'rm -rf "$shapes"' EXIT
make_shapes() {
  local sample n
  for sample in fp-1 fp-2 fp-3 dc-1 dc-2 dc-3 sp-1 sp-2 sp-3; do
    build/release/bin/scree sample "$sample" --resolution 1mm -q -f -o "$shapes/$sample.stl" >/dev/null || return 1
    for n in 20 60 200; do
      build/release/bin/scree simplify "$shapes/$sample.stl" -u mm -n $n -q -f -o "$shapes/${sample}_$n.ply" || return 1
    done
    rm "$shapes/$sample.stl"
  done
}
# `pour FIRST_SEED LAST_SEED [OPTIONS]`
pour() {
  tests/pours/run.sh build/release/bin/scree build/release/bin/inside "$shapes" "$@"
}

tools/install-packages.sh build test docs ci codes
part "release build" build release
part "Windows" windows
export SCREE_SLOW=1
part "the page in the browser, npm" browser
part "all tests, the slow ones too" tools/test.sh release
# Every tutorial from its own text, the long parts too.
tutorials() {
  local page bad=0
  for page in README.md docs/tutorials/*.md; do
    tests/docs/run_page.py build/release/bin/scree build/release/libscree.so "$page" --long || [ $? = 77 ] || bad=1
  done
  return $bad
}
part "tutorials, whole" tutorials
# `native COMPILER`: the states of tests/golden, by code for this very machine
native() {
  cmake -S . -B "build/native-$1" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_COMPILER="$1" \
    -DCMAKE_C_FLAGS=-march=native -DBUILD_TESTING=ON >/dev/null &&
    cmake --build "build/native-$1" --target golden_world && "build/native-$1/bin/golden_world"
}
part "the same bits with -march=native, gcc" native gcc
part "the same bits with -march=native, clang" native clang
part "shapes to pour" make_shapes
part "500 pours, none of which fails or leaves a body in another" pour 1 500
part "200 soft pours" pour 1 200 --stiffness 0.1
part "60 heaps" env MODE=repose tests/pours/run.sh build/release/bin/scree build/release/bin/inside "$shapes" 1 60
part "scenes: every template to its end, and killed" tests/scenes/templates.sh build/release/bin/scree
part "scenes: flow through round openings" tests/scenes/beverloo.sh build/release/bin/scree
part "scenes: the surface in a drum over seeds" tests/scenes/drum.sh build/release/bin/scree
part "sanitizer build" build asan
part "10,000 mutated files of every format, each in 20 s and 2 GB" tests/fuzz/mutated.py build/asan/bin/scree 10000 1 build/asan/mutated
part "slow and long tests under ASan and UBSan" tools/test.sh asan -L 'slow|long'
part "fuzzing build" build fuzz -DSCREE_FUZZ_SECONDS=1200
part "fuzzing, twenty minutes for each reader" ctest --preset fuzz
part "decimation and the whole job against their peers" bench/run.sh
part "checks of real scans against their peers" bench/check.sh
part "worlds against their peers" bench/world.sh
for what in seeds noise spacing; do
  part "the recommended level: $what" bench/fidelity.py build/release/bin/scree "$what"
done

printf '\n%d s; ' "$SECONDS"
if [ ${#failed[@]} -eq 0 ]; then
  echo "nothing failed"
else
  echo "failed:"
  printf '  %s\n' "${failed[@]}"
  exit 1
fi
