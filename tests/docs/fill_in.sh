#!/bin/sh
# What a person must fill in before a release is marked FILL-IN, and docs/releasing.md lists every file that has a mark, and no other.
# usage: fill_in.sh ROOT
set -eu
cd "$1"
marked=$(grep -rlI 'FILL-IN' --exclude-dir=build --exclude-dir=.git --exclude-dir=node_modules . | sed 's,^\./,,' | grep -v '^docs/releasing.md$\|^tests/docs/fill_in.sh$\|^CMakeLists\|^tests/CMakeLists' | sort)
listed=$(sed -n '/^## What a person fills in/,/^## /s/^| `\([^`]*\)`.*/\1/p' docs/releasing.md | sort)
[ "$marked" = "$listed" ] || { printf 'marked:\n%s\nlisted:\n%s\n' "$marked" "$listed"; exit 1; }
# and what names the version names that of VERSION
version=$(cat VERSION)
for file in CITATION.cff .zenodo.json codemeta.json packaging/conda/recipe.yaml packaging/spack/package.py packaging/homebrew/scree.rb; do
  grep -q "$version" "$file" || { echo "$file does not name version $version"; exit 1; }
done
for file in .zenodo.json codemeta.json; do python3 -m json.tool "$file" >/dev/null || { echo "$file is no JSON"; exit 1; }; done
python3 -m py_compile packaging/spack/package.py && rm -rf packaging/spack/__pycache__
