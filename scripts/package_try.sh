#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs a package in a Debian that has none of what it needs, uses it, removes it, and looks for what is left. As root.
#
#   scripts/package_try.sh FILE.deb
set -euo pipefail

case "${1:-}" in
  "" | -*) sed -n '3,5s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
deb=$1
share=/usr/share/spot-drainage
here=$(dirname "$(readlink -f "$0")")

echo "== $(basename "$deb") in a bare Debian $(cat /etc/debian_version)"
dpkg-deb --field "$deb" Version Depends Installed-Size

# What it needs comes first, so that what is left in the end can be told.
export DEBIAN_FRONTEND=noninteractive
apt-get update -qq
apt-get satisfy -y -qq --no-install-recommends "$(dpkg-deb --field "$deb" Depends)" >/dev/null 2>&1
useradd --create-home user
everything() { find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /home -o -path /var/lib -o -path /var/cache -o -path /var/log \) -prune -o -print | sort; }
everything >/tmp/before

echo "== apt-get install"
apt-get install -y -qq --no-install-recommends "$deb" >/dev/null 2>/tmp/apt.log || { cat /tmp/apt.log; exit 1; }

as_user() { echo "\$ $1"; runuser -u user -- env HOME=/home/user bash -eo pipefail -c "cd ~ && $1" 2>&1; }
as_user "cp -r $share/examples/silo . && ls silo"
as_user "cd silo && lmp -in in.silo_spot -var time 0.06 | tee run.log | grep -A9 '^Step'"
as_user "cd silo && python3 $here/compare_checksums.py dumps.sha256 post"
as_user "cd silo && /usr/libexec/spot-drainage/lmp -in in.silo_spot -var time 0.06 -var out again >again.log && python3 $here/compare_checksums.py dumps.sha256 again"
as_user "cd silo && spot-compare reference/dem-statistics.npz post -o report && ls report"
as_user "cd silo && spot-measure post -o spot.npz"
as_user "cd silo && spot-render spot=post --times 0 2 -o silo.png && ls -s silo.png"
as_user "cd silo && spot-calibrate --help | head -1"
as_user "spot-import $share/examples/own-hopper/packing.data.gz --fit cone-and-cylinder --orifice 0.012 --outflow 5700 -o own"
as_user "cd own && spot-check in.spot"
as_user "cd own && sed -i 's/^run .*/run 4/' in.spot && lmp -in in.spot | grep -A2 '^Step'"
as_user "python3 -c 'import spotcore; print(spotcore.__version__)'"

echo "== apt-get purge"
apt-get purge -y -qq spot-drainage >/dev/null 2>&1
everything >/tmp/after
if ! left=$(diff /tmp/before /tmp/after); then
  echo "left behind or gone:" >&2
  echo "$left" >&2
  exit 1
fi
echo "nothing is left"
