#!/bin/sh
# Makes every form in which scree is given away, from the tracked files: sources, Debian packages, wheel, scree.exe, the
# page and the npm package, with SHA256SUMS, in build/release-VERSION. Then tries what it can from that folder alone, each on
# a bare Debian: the packages, the wheel, the npm package; and scree.exe under Wine.
# usage: release.sh [--no-try]
set -eu
cd "$(dirname "$0")/.."
version=$(cat VERSION)
out=build/release-$version
rm -rf "$out"
mkdir -p "$out"

tools/deb.sh
cp build/deb/*.deb "$out"
tools/wheel.sh
cp build/wheel/*.whl "$out"
tools/install-packages.sh windows browser
tools/library-sources.sh build/library-sources
cmake --preset windows >/dev/null
cmake --build --preset windows --target scree
cp build/windows/bin/scree.exe "$out"
make page npm
cp build/page/scree.html "build/npm/scree-$version.tgz" "$out"
git archive --format=tar.gz --prefix="scree-$version/" -o "$out/scree-$version-src.tar.gz" HEAD
(cd "$out" && sha256sum ./* >SHA256SUMS)

if [ "${1:-}" != --no-try ]; then
  # `try NAME COMMAND`: in a bare Debian that has the folder at /data, a scan chosen is the test
  try() {
    printf 'trying %s\n' "$1"
    code=0
    DATA_DIR=$PWD/$out BARE_DIR=${BARE_DIR:-build/bare} tools/bare.sh "cd /data && sha256sum -c --quiet SHA256SUMS && $2" || code=$?
    case $code in
      0) ;;
      77) echo "NOT TRIED: $1" ;;
      *) echo "release.sh: what lies in $out fails on a bare Debian: $1" >&2; exit "$code" ;;
    esac
  }
  try "Debian packages" "apt-get update -qq && apt-get install -qqy ./scree_*.deb ./libscree0*.deb >/dev/null &&
    scree choose sample:dc-1 -q -o /tmp/check && test -s /tmp/check/report.html"
  try wheel "apt-get update -qq && apt-get install -qqy python3-venv >/dev/null && python3 -m venv /tmp/v &&
    /tmp/v/bin/pip install -q --no-index *.whl && /tmp/v/bin/python -c 'import scree; print(scree.version())'"
  try "npm package" "apt-get update -qq && apt-get install -qqy nodejs npm >/dev/null && npm install -s -g ./scree-$version.tgz &&
    scree choose sample:dc-1 -q -o /tmp/check && test -s /tmp/check/report.html"
  printf 'trying scree.exe\n'
  make build
  tests/windows/run.sh "$out/scree.exe" build/release/bin/scree
fi
ls -l "$out"
