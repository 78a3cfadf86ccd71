#!/bin/sh
# Builds the Debian packages from a copy of this checkout into build/deb and looks at them with lintian.
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
(cd "build/deb/scree-$version" && dpkg-buildpackage -us -uc -b) >build/deb/log 2>&1 || {
  tail -30 build/deb/log
  exit 1
}
rm -r "build/deb/scree-$version"
# The project has no mail address of its own.
lintian --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog --allow-root build/deb/*.changes
ls build/deb/*.deb
