#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Walks the guide's pages as a new user does: from a fresh clone, in a Debian with nothing but git, each page in one of its own.

What is not committed is not seen. As root (scripts/in_debian.sh); most of the time goes into compiling. Exits with 1 where a command
fails, or prints other than the page shows.
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

from documents import ROOT
from walking import DONE, missing_line, script_of, walk

PAGES = ("first-run", "my-own-silo")
GIT = "apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends git >/dev/null 2>&1; cd"


def script(steps):
    """The steps, from the home of a user who has git; the repository is shared by the system around."""
    return f"{GIT}\n" + script_of([(command.replace("REPOSITORY", "/shared"), shown) for command, shown in steps])


def walk_page(page, release):
    """Prints each command when it is done; returns whether all is as the page shows."""
    steps = walk(ROOT / "docs" / f"{page}.md", ["fresh", "run"])
    print(f"== docs/{page}.md, {len(steps)} commands, in a bare Debian {release}", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "clone", "--quiet", "--bare", ROOT, folder], check=True)
        program = subprocess.Popen([ROOT / "scripts" / "in_debian.sh", "--bare", "--share", folder, release, "bash", "-c", script(steps)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        remaining, printed, start, right = iter(steps), [], time.monotonic(), True
        command, shown = next(remaining)
        for line in program.stdout:
            if line.rstrip("\n") != DONE:
                printed.append(line.rstrip("\n"))
                continue
            missing = missing_line(shown, printed)
            print(f"{time.monotonic() - start:5.0f} s  $ {command}", flush=True)
            if missing is not None:
                print(f"error: did not print '{missing}', but", *printed, sep="\n")
                right = False
            printed, (command, shown) = [], next(remaining, (None, None))
        if program.wait() != 0 or command is not None:
            print(f"error: '{command}' failed, exit status {program.returncode}", *printed[-40:], sep="\n")
            right = False
    return right


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("release", choices=["12", "13"], nargs="?", default="13", help="(default: %(default)s)")
    parser.add_argument("--page", choices=PAGES, action="append", help="this page alone; repeatable")
    options = parser.parse_args()
    sys.exit(0 if all([walk_page(page, options.release) for page in options.page or PAGES]) else 1)
