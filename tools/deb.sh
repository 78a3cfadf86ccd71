#!/bin/sh
# Builds the Debian packages from a copy of this checkout into build/deb and looks at them with lintian.
# The maintainer's name and address are those of the file debian/maintainer, where there is one: `Name <address>`.
# usage: deb.sh
set -eu
cd "$(dirname "$0")/.."
tools/install-packages.sh build deb
version=$(cat VERSION)
said=$(sed -n '1s/^scree (\(.*\)) .*/\1/p' debian/changelog)
[ "$said" = "$version" ] || { echo "debian/changelog says version $said, VERSION says $version" >&2; exit 1; }
rm -rf build/deb
mkdir -p "build/deb/scree-$version"
tar --exclude=./build --exclude=./.git --exclude=./demo -c . | tar -x -C "build/deb/scree-$version"
forgive="--suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog" # of the address that stands in for one
if [ -s debian/maintainer ]; then
  forgive=""
  sed -i "s|^Maintainer: .*|Maintainer: $(head -n 1 debian/maintainer)|" "build/deb/scree-$version/debian/control"
  sed -i "1,/^ -- /s|^ -- .*>  | -- $(head -n 1 debian/maintainer)  |" "build/deb/scree-$version/debian/changelog"
fi
(cd "build/deb/scree-$version" && dpkg-buildpackage -us -uc -b) >build/deb/log 2>&1 || {
  tail -30 build/deb/log
  exit 1
}
rm -r "build/deb/scree-$version"
# shellcheck disable=SC2086
lintian $forgive --allow-root build/deb/*.changes
ls build/deb/*.deb
