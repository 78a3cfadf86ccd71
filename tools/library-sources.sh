#!/bin/sh
# Fetches the sources of the libraries that scree stands on, for builds for other systems (Windows, WebAssembly)
# for which Debian packages none: Debian's own source packages, and SQLite as npm's better-sqlite3 carries it.
# usage: library-sources.sh FOLDER
set -eu
[ $# -eq 1 ] || { echo "usage: library-sources.sh FOLDER" >&2; exit 2; }
command -v npm >/dev/null || "$(dirname "$0")/install-packages.sh" npm
mkdir -p "$1"
cd "$1"
[ ! -e complete ] || exit 0
# Where packages come from on this machine, sources come from as well.
mkdir -p apt/lists/partial apt/sources
for list in /etc/apt/sources.list.d/*.sources; do
  [ -e "$list" ] || continue
  sed 's/^Types:.*/Types: deb-src/' "$list" >"apt/sources/$(basename "$list")"
done
if [ -e /etc/apt/sources.list ]; then
  sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >apt/sources/main.list
fi
apt="apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts=$PWD/apt/sources
  -o Dir::State::Lists=$PWD/apt/lists -o APT::Sandbox::User=root"
# shellcheck disable=SC2086
$apt update
for package in qhull xxhash libyaml meshoptimizer expat zlib; do
  # a mirror may lack what the security archive's index names
  # shellcheck disable=SC2086
  $apt source --download-only "$package" >/dev/null 2>&1 ||
    $apt source --download-only "$package/$(. /etc/os-release && echo "$VERSION_CODENAME")" >/dev/null
  dpkg-source --no-check -x "$package"_*.dsc "$package" >/dev/null
done
npm pack --silent better-sqlite3@12 >/dev/null
mkdir -p sqlite
tar xzf better-sqlite3-*.tgz -C sqlite --strip-components=3 package/deps/sqlite3
rm -rf apt ./*.dsc ./*.tar.* ./*.tgz
touch complete
