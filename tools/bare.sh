#!/bin/sh
# A bare Debian 12 in a folder of its own, with `make` and nothing else: what passes there needs no package that
# tools/packages.txt does not name and no habit of this machine. Copies the tracked files in, as they are here.
# usage: bare.sh [COMMAND]      `make demo && make test` without a COMMAND; the scans of DATA_DIR are at /data there
# BARE_DIR is the folder (build/bare); base.tar and archives/ in it save the next run the download, and may go.
# The mirror is the one that apt uses here. Exits 77 where root, debootstrap, unshare or that mirror is missing.
set -eu
cd "$(dirname "$0")/.."
command=${1:-make demo && make test DATA_DIR=${DATA_DIR:+/data}}
suite=bookworm
cannot() { echo "no bare system: $*" >&2; exit 77; }
[ "$(id -u)" -eq 0 ] || cannot "only root can make one"
for tool in debootstrap unshare chroot apt-get; do
  command -v $tool >/dev/null || cannot "$tool is not installed"
done
unshare --mount --pid --fork true 2>/dev/null || cannot "this machine allows no namespaces"
mirror=$(apt-get indextargets --format '$(REPO_URI)' "Codename: $suite" "Origin: Debian" "Component: main" | head -n 1)
[ -n "$mirror" ] || cannot "apt knows no mirror of Debian $suite here"

mkdir -p "${BARE_DIR:=build/bare}"
dir=$(cd "$BARE_DIR" && pwd)
system=$dir/system
rm -rf "$system"
mkdir -p "$system" "$dir/archives"
if [ ! -f "$dir/base.tar" ]; then
  debootstrap --variant=minbase --include=make,ca-certificates "$suite" "$system" "$mirror" >"$dir/debootstrap.log" 2>&1 ||
    { tail -n 5 "$dir/debootstrap.log" >&2; rm -rf "$system"; cannot "debootstrap failed, see $dir/debootstrap.log"; }
  tar -C "$system" --one-file-system -cf "$dir/base.part" .
  mv "$dir/base.part" "$dir/base.tar"
else
  tar -C "$system" -xf "$dir/base.tar"
fi
# what a network needs: names, proxies and the certificates this machine trusts
cp -L /etc/resolv.conf /etc/hosts "$system/etc/"
apt-config dump | grep -i '::proxy' >"$system/etc/apt/apt.conf.d/proxy" || true
cp /etc/ssl/certs/ca-certificates.crt "$system/etc/ssl/certs/" 2>/dev/null || true
mkdir "$system/scree"
git ls-files -z | tar --null -T - -cf - | tar -C "$system/scree" -xf -

# Mounts live in a namespace of their own and end with it, so that nothing outside is ever below this folder.
export dir system command DATA_DIR
# shellcheck disable=SC2016
code=0
unshare --mount --pid --fork --kill-child sh -euc '
  mount --rbind /dev "$system/dev"
  mount --rbind /sys "$system/sys"
  mount -t proc proc "$system/proc"
  mount --bind "$dir/archives" "$system/var/cache/apt/archives"
  if [ -n "${DATA_DIR:-}" ]; then
    mkdir "$system/data"
    mount --bind -o ro "$DATA_DIR" "$system/data"
  fi
  exec chroot "$system" /usr/bin/env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
    sh -c "cd /scree && $command"' || code=$?
rm -rf "$system"
exit $code
