#!/bin/sh
# The module installed by pip into an environment of its own, without network: it finds the library inside.
# usage: install.sh SOURCE_DIR LIBRARY PYTHON      Exits 77 where Python has no venv or no pip.
set -eu
root=$1 library=$2 python=$3
"$python" -m venv --help >/dev/null 2>&1 && "$python" -c 'import ensurepip' 2>/dev/null || {
  echo "skipped: $python makes no environments (Debian: python3-venv)"
  exit 77
}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset PYTHONPATH
"$python" -m venv "$folder/env"
SCREE_LIBRARY=$library "$folder/env/bin/pip" install -q --no-index --disable-pip-version-check "$root/python"
cd "$folder"
unset SCREE_LIBRARY
"$folder/env/bin/python" -c '
import scree
box = scree.load("sample:box-12").measure()
print(scree.__file__, box.volume)
assert "env" in scree.__file__ and box.volume > 0'
"$folder/env/bin/pip" uninstall -qy scree
