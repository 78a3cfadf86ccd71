#!/bin/sh
# Installs what is missing of the packages in tools/packages.txt for the groups named; says what it
# installs; does nothing, at once and offline, where all are there.
# usage: install-packages.sh GROUP...
set -eu
here=$(cd "$(dirname "$0")" && pwd)
missing=""
for group in "$@"; do
  for package in $(sed -n "s/^$group  *\([^ #]*\).*/\1/p" "$here/packages.txt"); do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$state" = installed ] || missing="$missing $package"
  done
done
[ -n "$missing" ] || exit 0
if ! command -v apt-get >/dev/null; then
  echo "scree needs these Debian packages (or their like); install them, then go on:$missing" >&2
  exit 1
fi
sudo=""
if [ "$(id -u)" -ne 0 ]; then
  sudo=sudo
  command -v sudo >/dev/null || {
    echo "not root and no sudo; as root, run: apt-get install --no-install-recommends$missing" >&2
    exit 1
  }
fi
echo "installing:$missing"
$sudo apt-get update -q >/dev/null
# another installation may be under way: it is waited for
# shellcheck disable=SC2086
DEBIAN_FRONTEND=noninteractive $sudo apt-get -o DPkg::Lock::Timeout=900 install -qy --no-install-recommends $missing >/dev/null
