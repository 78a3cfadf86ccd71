#!/bin/sh
# The npm package, installed from its tarball into a folder of its own: `npx scree` is the program to the byte.
# usage: npm.sh PROGRAM FOLDER      FOLDER has scree-VERSION.tgz
# Exits 77 where node or npm is missing, or the package was not made.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "$1") packed=$(realpath -m "$2")
for needed in node npm; do
  command -v $needed >/dev/null || { echo "skipped: no $needed installed"; exit 77; }
done
tarball=$(ls "$packed"/scree-*.tgz 2>/dev/null | tail -1)
[ -n "$tarball" ] || { echo "skipped: no package: \`make npm\` makes it"; exit 77; }
newer=$(find "$here/../../src" "$here/../../web/npm" "$here/../../web/wasm" "$here/../../include" -newer "$tarball" -type f | head -1)
[ -z "$newer" ] || { echo "skipped: $newer is newer than the package: \`make npm\` makes it anew"; exit 77; }

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
echo '{"private": true}' >package.json
npm install --silent --offline --no-audit --no-fund "$tarball"
fail() {
  echo "$1"
  exit 1
}

"$program" sample fp-1 --resolution 2.5mm -q -o fp-1.stl
for call in "choose fp-1.stl -u mm --json" "check fp-1.stl -u mm --json" "measure fp-1.stl -u mm --json" \
  "curve fp-1.stl -u mm --json"; do
  # shellcheck disable=SC2086
  "$program" $call >native.json
  # shellcheck disable=SC2086
  npx scree $call >package.json.out
  cmp native.json package.json.out || fail "npx scree $call: not the program's bytes"
done
npx scree choose fp-1.stl -u mm -o result >/dev/null 2>said
mkdir native
(cd native && "$program" choose ../fp-1.stl -u mm -o result >/dev/null 2>said)
sed -i '/^scree, after /d' said native/said # progress depends on the machine
cmp native/said said || fail "npx scree choose says something else beside its answer"
[ "$(tail -c +85 result/fp-1.stl | cksum)" = "$(tail -c +85 native/result/fp-1.stl | cksum)" ] || fail "npx scree choose -o: another mesh"
[ -s result/report.html ] || fail "npx scree choose -o: no report"

# Errors: the program's sentence and exit code.
printf 'solid x\nfacet normal 0 0' >broken.stl
for call in "choose broken.stl -u mm" "choose missing.stl" "nonsense" "choose --nonsense"; do
  code=0 native=0
  # shellcheck disable=SC2086
  npx scree $call >/dev/null 2>said || code=$?
  # shellcheck disable=SC2086
  "$program" $call >/dev/null 2>native.said || native=$?
  [ $code = $native ] || fail "npx scree $call: exit $code, the program's is $native"
  cmp native.said said || fail "npx scree $call: not the program's sentence"
done
