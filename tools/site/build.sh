#!/bin/sh
# Builds the manual as a site that works from disk: BUILD/docs/index.html.
# usage: build.sh BUILD_FOLDER [OUTPUT_FOLDER]     BUILD_FOLDER has bin/scree and libscree.so, as build/release
set -eu
build=$1
output=${2:-$build/../docs}
here=$(cd "$(dirname "$0")" && pwd)
command -v mkdocs >/dev/null || { echo "the site needs MkDocs (apt-get install mkdocs)" >&2; exit 77; }
/usr/bin/python3 "$here/generate.py" "$build/bin/scree" "$build/libscree.so" "$build/site" "$output"
mkdocs build --quiet --strict --clean -f "$build/site.yml"
echo "$(cd "$output" && pwd)/index.html"
