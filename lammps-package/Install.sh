#!/bin/sh
# SPDX-License-Identifier: GPL-2.0-only
# What `make yes-spot`, `no-spot` and `package-update` of LAMMPS call in src/SPOT, with 1, 0 and 2. LAMMPS' own script
# copies the sources to src and takes them away; the settings for spot-core go to Makefile.package and come out again.
mode=$1
sh ../Install.sh "$mode" || exit 1

[ "$mode" != 2 ] && [ -e ../Makefile.package ] || exit 0
compile='-std=c++17 $(shell pkg-config --cflags eigen3) '
link='-lspot-core -lpthread '
literally() { printf '%s' "$1" | sed 's/[$.]/\\&/g'; }
sed -i -e "s|$(literally "$compile")||" -e "s|$(literally "$link")||" ../Makefile.package
if [ "$mode" = 1 ]; then
  sed -i -e "s|^PKG_SYSINC = *|&$compile|" -e "s|^PKG_SYSLIB = *|&$link|" ../Makefile.package
fi
