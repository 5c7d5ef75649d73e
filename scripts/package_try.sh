#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs a package in a Debian that has none of what it needs, uses it, removes it, and looks for what is left.
# As root.
#
#   scripts/package_try.sh FILE.deb
set -euo pipefail

case "${1:-}" in
  "" | -*) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
deb=$1
share=/usr/share/spot-drainage
here=$(dirname "$(readlink -f "$0")")

echo "== $(basename "$deb") in a bare Debian $(cat /etc/debian_version)"
dpkg-deb --info "$deb" | grep -E "^ (Version|Depends|Installed-Size):"
needed=$(dpkg-deb --info "$deb" | sed -n 's/^ Depends: //p')

export DEBIAN_FRONTEND=noninteractive
quietly() { "$@" >/tmp/quiet.log 2>&1 || { cat /tmp/quiet.log >&2; exit 1; }; }
everything() {
  local elsewhere=(-false) folder
  for folder in /proc /sys /dev /tmp /home /var/lib /var/cache /var/log; do elsewhere+=(-o -path "$folder"); done
  find / -xdev \( "${elsewhere[@]}" \) -prune -o -print | sort
}

# What it needs comes first, so that what is left in the end can be told.
quietly apt-get update
quietly apt-get satisfy -y --no-install-recommends "$needed"
useradd --create-home user
everything >/tmp/before

echo "== apt-get install"
quietly apt-get install -y --no-install-recommends "$deb"

# as_user COMMAND [FILTER ...] prints what the filter leaves, or everything, should the command or the filter fail.
as_user() {
  local command=$1
  shift
  [ $# -gt 0 ] || set -- cat
  echo "\$ $command"
  if ! runuser -u user -- env HOME=/home/user bash -eo pipefail -c "cd ~ && $command" >/tmp/output 2>&1 || ! "$@" /tmp/output; then
    cat /tmp/output
    echo "package_try: '$command' failed, or printed other than expected" >&2
    exit 1
  fi
}
log='^ *Step '  # LAMMPS of Debian 13 indents it
as_user "cp -r $share/examples/silo . && ls silo"
as_user "cd silo && lmp -in in.silo_spot -var time 0.06" grep -A3 "$log"
as_user "cd silo && python3 $here/compare_checksums.py dumps.sha256 post"
as_user "cd silo && /usr/libexec/spot-drainage/lmp -in in.silo_spot -var time 0.06 -var out again" grep -A3 "$log"
as_user "cd silo && python3 $here/compare_checksums.py dumps.sha256 again"
as_user "cd silo && spot-compare reference/dem-statistics.npz post -o report && ls report"
as_user "cd silo && spot-measure post -o spot.npz"
as_user "cd silo && spot-render spot=post --times 0 2 -o silo.png && ls -s silo.png"
as_user "cd silo && spot-calibrate --help" head -1
as_user "cp $share/examples/own-hopper/packing.data.gz ."
as_user "spot-import packing.data.gz --fit cone-and-cylinder --orifice 0.012 --outflow 5700 -o own"
as_user "cd own && spot-check in.spot"
as_user "cd own && sed -i 's/^run .*/run 4/' in.spot && lmp -in in.spot" grep -A2 "$log"
as_user "python3 -c 'import spotcore; print(spotcore.__version__)'"

echo "== apt-get purge"
quietly apt-get purge -y spot-drainage
everything >/tmp/after
ls /var/lib/dpkg/info/spot-drainage.* 2>/dev/null && exit 1
if ! left=$(diff /tmp/before /tmp/after); then
  echo "left behind or gone:" >&2
  echo "$left" >&2
  exit 1
fi
echo "nothing is left"
