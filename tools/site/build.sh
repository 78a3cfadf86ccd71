#!/bin/sh
# Builds the manual as a site that works from disk: BUILD/docs/index.html.
# usage: build.sh BUILD_FOLDER [OUTPUT_FOLDER]     BUILD_FOLDER has bin/scree and libscree.so, as build/release
set -eu
build=$1
output=${2:-$build/../docs}
here=$(cd "$(dirname "$0")" && pwd)
/usr/bin/python3 -c 'import furo, myst_parser, sphinx_copybutton' 2>/dev/null && [ -d /usr/share/nodejs/katex ] && [ -d /usr/share/javascript/lunr ] ||
  { echo "the site needs Sphinx, Furo, MyST, KaTeX and lunr: tools/install-packages.sh docs" >&2; exit 77; }
/usr/bin/python3 "$here/generate.py" "$build/bin/scree" "$build/libscree.so" "$build/site"
rm -rf "$output"
/usr/bin/python3 -m sphinx -q -W --keep-going -b html -d "$build/site.doctrees" -E -c "$here" "$build/site" "$output"
echo "$(cd "$output" && pwd)/index.html"
