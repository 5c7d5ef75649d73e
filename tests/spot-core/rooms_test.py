#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Each room (folder) of spot-core includes itself and the rooms below it only; no class header is longer than a screen
or two. Prints what breaks that, and exits with 1."""
import pathlib
import re
import sys

# From top to bottom.
ROOMS = ("drivers", "relaxation", "packing", "walk", "geometry", "parallel", "base")
LONGEST_HEADER = 150


def main(core):
    faults = []
    files = [path for folder in ("include/spot", "src") for path in sorted((core / folder).rglob("*.[hci]*"))]
    for path in files:
        room = path.parent.name
        if room not in ROOMS:
            faults.append(f"{path.relative_to(core)} is in no room")
            continue
        text = path.read_text()
        for included in re.findall(r'#include "(?:spot/)?(\w+)/\w+\.\w+"', text):
            if included not in ROOMS or ROOMS.index(included) < ROOMS.index(room):
                faults.append(f"{path.relative_to(core)} includes something of {included}, which is not below {room}")
        for included in re.findall(r'#include "([^"/]*)"', text):
            faults.append(f"{path.relative_to(core)} includes {included} without naming its room")
        lines = text.count("\n")
        if path.suffix == ".hpp" and lines > LONGEST_HEADER:
            faults.append(f"{path.relative_to(core)} has {lines} lines; at most {LONGEST_HEADER} are allowed")
    if len(files) < 20:
        faults.append(f"only {len(files)} source files found in {core}")
    print("\n".join(faults) or f"{len(files)} files, all includes downwards")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
