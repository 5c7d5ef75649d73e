#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Runs a command as root in a bare Debian of another release, at the top of a fresh copy of this checkout.
#
#   scripts/in_debian.sh 13 ./run.sh --time 0.1
#   scripts/in_debian.sh 12 bash                 to look around
#   scripts/in_debian.sh --bare 13 ./run.sh      with nothing installed
#   scripts/in_debian.sh --share FOLDER 12 ...   the folder is /shared there
#
# The Debian is made once, by debootstrap from the package source that apt has here, and kept with what was installed in
# it in ${XDG_CACHE_HOME:-~/.cache}/spot-drainage/debian-RELEASE; remove that folder to start anew. --bare takes one as
# debootstrap left it, and removes it afterwards. Files that git ignores are not copied, and what the command makes in
# the copy, /spot-drainage there, is gone with the next call.
# The exit status is the command's, or 125 where such a Debian can't be had.
set -euo pipefail
checkout=$(dirname "$(dirname "$(readlink -f "$0")")")

cannot() {
  echo "in_debian: $*" >&2
  exit 125
}

bare=false
share=
while [[ "${1:-}" == -* ]]; do
  case "$1" in
    -h | --help) sed -n '3,14s/^# \{0,1\}//p' "$0"; exit 0 ;;
    --bare) bare=true ;;
    --share)
      [ -d "${2:-}" ] || { echo "in_debian: --share needs a folder" >&2; exit 2; }
      share=$(readlink -f "$2")
      shift ;;
    *) echo "in_debian: unknown option '$1'; allowed are --bare and --share FOLDER" >&2; exit 2 ;;
  esac
  shift
done
case "${1:-}" in
  12) suite=bookworm ;;
  13) suite=trixie ;;
  *) echo "in_debian: unknown release '${1:-}'; allowed are 12 and 13" >&2; exit 2 ;;
esac
release=$1
shift
[ $# -gt 0 ] || { echo "in_debian: a command is missing" >&2; exit 2; }

[ "$(id -u)" -eq 0 ] || cannot "only root can make and enter another Debian"
unshare --mount true 2>/dev/null || cannot "this system lets nobody mount file systems (unshare --mount fails)"

# Of Debian itself, not of its updates or another source.
mirror() {
  apt-get indextargets --format '$(REPO_URI) $(ORIGIN) $(LABEL)' 'Identifier: Packages' |
    awk '$2 == "Debian" && $3 == "Debian" {print $1; exit}'
}

# As debootstrap leaves it.
make_pristine() {
  command -v apt-get >/dev/null || cannot "apt-get is missing, which says where packages come from"
  if ! command -v debootstrap >/dev/null || [ -z "$(mirror)" ]; then
    apt-get update -qq || cannot "the package source can't be reached"
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends debootstrap debian-archive-keyring >/dev/null ||
      cannot "debootstrap is missing and can't be installed"
  fi
  local source log=$pristine.log
  source=$(mirror)
  [ -n "$source" ] || cannot "apt's sources here name no source of Debian's packages"
  echo "== Making a Debian $release in $cache"
  rm -rf "$pristine.new"
  # debootstrap leaves nothing mounted in a mount namespace of its own.
  unshare --mount debootstrap --variant=minbase --include=ca-certificates "$suite" "$pristine.new" "$source" >"$log" 2>&1 ||
    { tail -3 "$log" >&2; rm -rf "$pristine.new"; cannot "debootstrap failed: is the package source reachable?"; }
  apt-config dump 'Acquire::http::Proxy' 'Acquire::https::Proxy' >"$pristine.new/etc/apt/apt.conf.d/proxy"
  mv "$pristine.new" "$pristine"
}

cache=${XDG_CACHE_HOME:-$HOME/.cache}/spot-drainage
pristine=$cache/pristine-$release
root=$cache/debian-$release
mkdir -p "$cache"
exec {lock}>"$root.lock"
flock "$lock"  # the copy is one call's
if $bare; then
  [ -d "$pristine" ] || make_pristine
  root=$(mktemp -d "$cache/bare-$release.XXXXXX")
  trap 'rm -rf "$root"' EXIT
  cp -a "$pristine/." "$root"
  flock -u "$lock"
elif [ ! -d "$root" ]; then
  [ -d "$pristine" ] || make_pristine
  rm -rf "$root.new"
  cp -a "$pristine" "$root.new"
  mv "$root.new" "$root"
fi

rm -rf "$root/spot-drainage"
mkdir "$root/spot-drainage"
# Files that git knows but that were removed are no error.
(cd "$checkout" && git ls-files -z --cached --others --exclude-standard --deduplicate |
  while IFS= read -r -d '' file; do if [ -e "$file" ]; then printf '%s\0' "$file"; fi; done |
  tar --null -T - -c) | tar -x -C "$root/spot-drainage"
cp -L /etc/resolv.conf "$root/etc/resolv.conf" 2>/dev/null || true

# Mounted for this command alone.
status=0
unshare --mount bash -euc '
  root=$1 share=$2
  shift 2
  mount -t proc proc "$root/proc"
  mount --rbind /sys "$root/sys"
  mount --rbind /dev "$root/dev"
  if [ -n "$share" ]; then
    mkdir -p "$root/shared"
    mount --bind "$share" "$root/shared"
  fi
  exec chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 TERM="${TERM:-dumb}" CI="${CI:-}" \
    ${CMAKE_BUILD_PARALLEL_LEVEL:+"CMAKE_BUILD_PARALLEL_LEVEL=$CMAKE_BUILD_PARALLEL_LEVEL"} \
    ${http_proxy:+"http_proxy=$http_proxy"} ${https_proxy:+"https_proxy=$https_proxy"} \
    sh -c "cd /spot-drainage && exec \"\$@\"" in_debian "$@"
' in_debian "$root" "$share" "$@" {lock}>&- || status=$?
exit "$status"
