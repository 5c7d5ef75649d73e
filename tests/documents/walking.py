# SPDX-License-Identifier: GPL-2.0-or-later
"""The commands of a page of the guide, and whether they print what the page shows.

In blocks below a line `<!-- run -->`, or `<!-- fresh -->` for what only a new user runs, lines that begin with `$ ` are commands,
the others are what they print. There `...` stands for whatever is left out, a line of it for any lines, and numbers may be others.
All blocks of a page run one after the other, in one shell.
"""

import re

import documents

DONE = "@@ done @@"


def walk(page, marks):
    """(command, lines that it prints) of all blocks of a page with one of the marks."""
    steps = []
    for block in documents.blocks(page.read_text()):
        if block.mark not in marks:
            continue
        for line in block.text.splitlines():
            if line.startswith("$ "):
                steps.append([line[2:], []])
            elif steps and not steps[-1][1] and _is_open(steps[-1][0]):
                steps[-1][0] += "\n" + line
            else:
                steps[-1][1].append(line)
    return steps


def _is_open(command):
    return command.endswith("\\") or command.count("'") % 2 == 1


def script_of(steps):
    """For bash: it ends at the first command that fails."""
    return "set -e -o pipefail\n" + "".join(f"{command}\necho; echo '{DONE}'\n" for command, _ in steps)


def outputs(printed):
    """What each command printed, of what the script did."""
    return re.split(rf"\n?{DONE}\n", printed)


NUMBER = r"[-+]?\d[\d.]*(?:e[-+]?\d+)?"


def expected(line):
    """A regular expression for a line as the page shows it."""
    parts = re.split(rf"(\.\.\.|{NUMBER}|\s+)", line.strip())
    return "".join(".*" if part == "..." else NUMBER if re.fullmatch(NUMBER, part) else r"\s+" if part.isspace() else re.escape(part)
                   for part in parts)


def missing_line(shown, printed):
    """The first shown line that was not printed, in this order; None if there is none."""
    k, anywhere = 0, False
    for line in shown:
        if line.strip() == "...":
            anywhere = True
            continue
        pattern = re.compile(expected(line))
        places = range(k, len(printed)) if anywhere else range(k, min(k + 1, len(printed)))
        k = next((n + 1 for n in places if pattern.fullmatch(printed[n].strip())), None)
        if k is None:
            return line
        anywhere = False
    return None
