# SPDX-License-Identifier: GPL-2.0-or-later
"""The documents of the repository, and what can be read off them: lines, tables, links, anchors, commands."""

import dataclasses
import functools
import pathlib
import re
import shlex

ROOT = pathlib.Path(__file__).resolve().parents[2]
_NOT_OURS = re.compile(r"(\..*|build.*|results|post|venv|__pycache__|.*\.egg-info)$")


def _walk(folder):
    for path in sorted(folder.iterdir()):
        if path.is_dir():
            if not _NOT_OURS.match(path.name):
                yield from _walk(path)
        else:
            yield path


@functools.cache
def files():
    """All files of a checkout, without what git ignores."""
    return tuple(_walk(ROOT))


@functools.cache
def documents():
    return tuple(path for path in files() if path.suffix in (".md", ".rst"))


def name(path):
    return str(path.relative_to(ROOT))


@dataclasses.dataclass
class Block:
    """A fenced block of code, its language, the line of its fence, and the comment just above it, if there is one."""

    language: str
    first_line: int
    text: str
    mark: str


def blocks(text):
    found, lines, k = [], text.splitlines(), 0
    while k < len(lines):
        fence = re.match(r" *```(.*)$", lines[k])
        if fence:
            end = next(n for n in range(k + 1, len(lines)) if lines[n].strip() == "```")
            above = re.match(r"<!-- (.*) -->$", lines[k - 1]) if k else None
            found.append(Block(fence.group(1).strip(), k + 1, "\n".join(lines[k + 1:end]), above.group(1) if above else ""))
            k = end
        k += 1
    return found


def without_blocks(text):
    """The text with its fenced blocks emptied; lines keep their numbers."""
    kept, inside = [], False
    for line in text.splitlines():
        fence = line.strip().startswith("```")
        kept.append("" if inside or fence else line)
        inside ^= fence
    return "\n".join(kept)


def tables(path, text):
    """(line, columns) of each row of a table."""
    for number, line in enumerate(without_blocks(text).splitlines(), 1):
        if path.suffix == ".md" and line.startswith("|"):
            yield number, len(re.findall(r"(?<!\\)\|", line.rstrip())) - 1
        elif path.suffix == ".rst" and re.match(r"=+( +=+)+$", line):
            yield number, len(line.split())


def links(text):
    """(line, target) of links and pictures, Markdown's and HTML's."""
    for match in re.finditer(r"\]\(([^()\s]+)\)|(?:src|href)=\"([^\"]+)\"", without_blocks(text)):
        yield text.count("\n", 0, match.start()) + 1, match.group(1) or match.group(2)


def anchors(text):
    """What headings are called in links, as forges and MyST do it."""
    for heading in re.findall(r"^#+ (.*)$", without_blocks(text), re.MULTILINE):
        shown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        yield re.sub(r"[^\w\- ]", "", shown.lower()).strip().replace(" ", "-")


def in_backticks(text):
    for match in re.finditer(r"(?<!`)`([^`\n]+)`(?!`)", without_blocks(text)):
        yield text.count("\n", 0, match.start()) + 1, match.group(1)


def command_lines(block):
    """Commands of a block, continued lines joined. Where some begin with `$ `, the other lines are what they print."""
    joined = re.sub(r"\\\n\s*", "", block.text)
    lines = joined.splitlines()
    prompted = [line[2:] for line in lines if line.startswith("$ ")]
    return prompted or [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]


_PROGRAMS = re.compile(r"(.*/)?(python3?|nice|bash|sudo|time)$")


@functools.cache
def entry_points():
    """The command of each entry point of the Python package, and the script that does the same."""
    found = re.findall(r'^(spot-[\w-]+) = "spot_analysis\.commands\.(\w+):main"', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    return {command: ROOT / "analysis" / f"{module}.py" for command, module in found}


def script_and_options(path, line):
    """(word, script, options) of the script of ours that a command starts with. No script: None if the word says that it is one
    of ours, but there is none."""
    try:
        words = shlex.split(line, comments=True)
    except ValueError:
        return None
    if "&&" in words:
        words = words[words.index("&&") + 1:] if words[0] == "cd" else words[:words.index("&&")]
    while words and (_PROGRAMS.match(words[0]) or re.match(r"[A-Z_]+=", words[0])):
        words = words[1:]
    if not words:
        return None
    word = words[0]
    if word in entry_points():
        script = entry_points()[word]
    elif re.search(r"\.(py|sh)$", word) and not re.search(r"[A-Z]{3,}|[*{$]", word):
        script = _find_script(path, word)
    else:
        return None
    end = next((k for k, other in enumerate(words) if re.match(r"[|>;<]", other) or other == "&&"), len(words))
    options = [other.split("=")[0] for other in words[1:end] if re.match(r"--?[A-Za-z]", other)]
    return word, script, options


def _find_script(path, word):
    """As given, from the folder of the document or the root; `../` leads out of whichever folder of ours commands run in."""
    from_above = re.sub(r"^(\./|\.\./)+", "", word)
    for candidate in (path.parent / word, ROOT / from_above):
        if candidate.is_file():
            return candidate
    return None
