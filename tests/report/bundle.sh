#!/bin/sh
# Whether src/report/page.inc and page_script.inc are what the sources and the lockfile in web/ give. usage: bundle.sh SOURCE_DIR
# Exits 77 where node, npm or its registry is missing.
set -eu
root=$1
for program in node npm; do
  command -v $program >/dev/null || { echo "skipped: no $program installed"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/src/report" "$folder/web"
cp "$root"/src/report/page*.inc "$folder/src/report"
(cd "$root/web" && cp -r app build.mjs bundle.mjs licences package.json package-lock.json page.html src "$folder/web")
cd "$folder/web"
if ! npm ci --ignore-scripts --no-audit --no-fund >"$folder/log" 2>&1; then
  if grep -qE 'ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ECONNRESET|ETIMEDOUT|ENETUNREACH|E40[134]|E5[0-9][0-9]' "$folder/log"; then
    echo "skipped: npm's registry cannot be reached"
    exit 77
  fi
  cat "$folder/log"
  exit 1
fi
node build.mjs --check
for name in three meshoptimizer; do
  for file in node_modules/$name/LICENSE*; do
    cmp "$file" licences/$name.txt || { echo "the licence of $name is another"; exit 1; }
  done
done
