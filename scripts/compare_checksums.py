#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""compare_checksums.py FILE.sha256 FOLDER: are the texts of the compressed dumps in the folder those of the checksums?"""

import hashlib
import pathlib
import sys

import zstandard


def main(checksums, folder):
    for line in pathlib.Path(checksums).read_text().splitlines():
        expected, name = line.split()
        with zstandard.open(pathlib.Path(folder) / f"{name}.zst", "rb") as handle:
            if hashlib.sha256(handle.read()).hexdigest() != expected:
                sys.exit(f"error: {folder}/{name}.zst is another one")
        print(f"{name}: OK")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(f"usage: {__doc__.partition(': ')[0]}")
    main(*sys.argv[1:])
