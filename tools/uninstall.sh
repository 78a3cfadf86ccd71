#!/bin/sh
# Removes what `make install` has put in place, and folders of ours that are empty then.
# usage: uninstall.sh BUILD_DIR (DESTDIR as it was for the installation)
set -eu
manifest=$1/install_manifest.txt
[ -f "$manifest" ] || { echo "$manifest: not there, so nothing was installed from this build" >&2; exit 1; }
while read -r file || [ -n "$file" ]; do
  rm -f "${DESTDIR:-}$file"
  folder=$(dirname "${DESTDIR:-}$file")
  if [ "$(basename "$folder")" = scree ]; then
    rm -rf "$folder/__pycache__"
    rmdir "$folder" 2>/dev/null || true
  fi
done <"$manifest"
rm "$manifest"
