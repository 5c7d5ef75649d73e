#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Prints a Python that can import what analysis and tests need. The first python3 on the PATH is often not the one
# for which Debian's packages are installed.
for python in python3 /usr/bin/python3; do
  if "$python" -c "import numpy, scipy, matplotlib, PIL, zstandard, pytest" 2>/dev/null; then
    echo "$python"
    exit 0
  fi
done
echo "python.sh: neither python3 nor /usr/bin/python3 can import numpy, scipy, matplotlib, PIL, zstandard and pytest" \
  "(Debian: python3-numpy python3-scipy python3-matplotlib python3-pil python3-zstandard python3-pytest)" >&2
exit 1
