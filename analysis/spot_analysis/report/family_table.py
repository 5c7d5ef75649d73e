# SPDX-License-Identifier: GPL-2.0-or-later
"""The families of quantities as a table, a column for each run that is judged, and how many families are met."""

import html

from .criteria import CRITERIA


def family_counts(verdicts):
    """family -> (bounds met, bounds judged), of Criterion -> Verdict."""
    counts = {}
    for criterion, verdict in verdicts.items():
        met, judged = counts.get(criterion.family, (0, 0))
        counts[criterion.family] = met + (verdict.met is True), judged + (verdict.met is not None)
    return counts


def families_met(verdicts):
    """(met, judged): families all of whose judged bounds are met, of those that have any."""
    judged = [(met, total) for met, total in family_counts(verdicts).values() if total]
    return sum(met == total for met, total in judged), len(judged)


def describe(windows):
    """The intervals in words, of window -> (start, end)."""
    spans = [f"{name}: {start:g} to {end:g} tau" for name, (start, end) in windows.items()]
    return "; ".join(spans) or "the runs are too short for any interval of steady flow"


def rows(columns):
    """Lists of texts, the heading first: a line for each family with how many of its bounds are met, and one for each quantity.

    columns : heading -> Criterion -> Verdict. A cell is the spot's value / DEM's, and whether the bound is met; quantities that
    no column knows are left out.
    """
    counts = {heading: family_counts(verdicts) for heading, verdicts in columns.items()}
    table, family = [["", "bound", *columns]], None
    for criterion in CRITERIA:
        found = [verdicts.get(criterion) for verdicts in columns.values()]
        if not any(_is_known(one) for one in found):
            continue
        if criterion.family != family:
            family = criterion.family
            table.append([f"**{family}**", "", *(_score(*counts[heading].get(family, (0, 0))) for heading in columns)])
        table.append([criterion.label, criterion.bound.text() if criterion.bound else "reported", *map(_cell, found)])
    table.append(["**families met**", "", *("{} of {}".format(*families_met(verdicts)) for verdicts in columns.values())])
    return table


def _score(met, judged):
    if not judged:
        return "-"
    return f"met, {judged}" if met == judged else f"**{met} of {judged}**"


def _is_known(verdict):
    return verdict is not None and (verdict.spot.value is not None or verdict.met is not None)


def _cell(verdict):
    if not _is_known(verdict):
        return "-"
    text = number(verdict.spot) + (f" / {number(verdict.dem)}" if verdict.dem.value is not None else "")
    return text + {True: " yes", False: " **NO**", None: ""}[verdict.met]


def number(value):
    """A Value with its error, if it has one that is not of rounding."""
    if value.value is None:
        return "unknown"
    is_certain = not value.error or value.error < 1e-9 * abs(value.value)
    return f"{value.value:.4g}" + ("" if is_certain else f" +- {value.error:.2g}")


def markdown(table):
    """The table of ``rows`` as Markdown."""
    lines = [f"| {' | '.join(line)} |" for line in table]
    return "\n".join([lines[0], "|---" * len(table[0]) + "|", *lines[1:]])


def as_html(table):
    """The table of ``rows`` as HTML."""
    lines = []
    for place, line in enumerate(table):
        tag = "th" if place == 0 or line[0].startswith("**") else "td"
        cells = (html.escape(cell.replace("**", "")).replace("+-", "&plusmn;") for cell in line)
        mark = ' class="missed"' if any(cell.endswith("**NO**") for cell in line) else ""
        lines.append(f"<tr{mark}>" + "".join(f"<{tag}>{cell}</{tag}>" for cell in cells) + "</tr>\n")
    return '<table class="families">\n' + "".join(lines) + "</table>\n"
