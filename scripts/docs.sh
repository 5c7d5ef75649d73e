#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs Sphinx, MyST and furo, and builds the documents as a site: results/docs/index.html. Warnings are errors, among
# them links that lead nowhere.
#
#   scripts/docs.sh            builds the site
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."

case "${1:-}" in
  "") ;;
  -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) echo "docs.sh: unknown option '$1'; there is none but --help" >&2; exit 2 ;;
esac

scripts/install-packages.sh python3-sphinx python3-myst-parser furo

echo "== Building the site"
rm -rf results/docs
/usr/bin/python3 -m sphinx -c docs/site -b html -d results/docs.doctrees -W --keep-going -q . results/docs
/usr/bin/python3 docs/site/check_links.py results/docs
echo "results/docs/index.html"
