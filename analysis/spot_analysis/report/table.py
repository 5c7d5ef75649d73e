# SPDX-License-Identifier: GPL-2.0-or-later
"""The comparison as a text table, with the interval before it and the verdict after it."""

from ..statistics.interval import STEADY_FROM

HEAD = ("quantity", "unit", "DEM", "spot", "difference", "papers", "bound", "met", "meaning")


def describe(view):
    """One line on the interval and one on the region of g(r), packing fraction, contacts and badness."""
    interval, scene, region = view.interval, view.run.scene, view.run.region()
    kinds = {"steady": "the steady part", "everything": "everything both have, start-up included",
             "chosen": "as chosen"}
    seconds = [f"{time * scene.tau:.3f}" for time in interval.span]
    text = f"interval compared: {interval.start:g} to {interval.end:g} tau ({kinds[interval.kind]})"
    text += f" = {seconds[0]} to {seconds[1]} s" if scene.tau != 1 else ""
    return (f"{text}\nstructure region: |x| < {region.half_width:g} d, {region.bottom:g} d < z < {region.top:g} d, "
            "over snapshots that fill it")


def cells(row):
    """The texts of one row of the table."""
    difference = "-"
    if row.difference is not None:
        relative = f" ({100 * row.difference / abs(row.dem):+.1f} %)" if row.dem else ""
        difference = _with_error(row.difference, row.difference_error, "+") + relative
    met = {None: "", True: "yes", False: "NO"}[row.met]
    return (row.name, row.unit, _with_error(row.dem, row.dem_error), _with_error(row.spot, row.spot_error),
            difference, _papers(row.paper), row.bound or "", met, row.meaning)


def _papers(paper):
    """DEM / spot of the literature."""
    if paper is None:
        return ""
    dem, spot, source = paper
    values = ["-" if value is None else _number(value) for value in (dem, spot)]
    return f"{values[0] if spot is None else ' / '.join(values)} ({source})"


def _with_error(value, error, sign=""):
    if value is None:
        return "-"
    return _number(value, sign) + ("" if error is None else f" +- {error:.2g}")


def _number(value, sign=""):
    return f"{value:{sign}d}" if isinstance(value, int) else f"{value:{sign}.4g}"


def table(rows):
    """The rows as text in aligned columns, section by section."""
    texts = [cells(row) for row in rows]
    widths = [max(len(line[column]) for line in [HEAD, *texts]) for column in range(len(HEAD))]
    lines, section = [_aligned(HEAD, widths)], None
    for row, text in zip(rows, texts):
        if row.section != section:
            section = row.section
            lines.append(f"-- {section}")
        lines.append(_aligned(text, widths))
    return "\n".join(lines)


def _aligned(texts, widths):
    return "  ".join(text.ljust(width) for text, width in zip(texts, widths)).rstrip()


def verdict(rows):
    """One line: how many bounds are met, and which are not."""
    judged = [row for row in rows if row.met is not None]
    failed = ", ".join(row.name for row in judged if not row.met)
    text = f"bounds met: {sum(row.met for row in judged)} of {len(judged)}" + (f"; not met: {failed}" if failed else "")
    left_out = sum(row.bound is not None for row in rows) - len(judged)
    return text + (f"; {left_out} not judged: most need steady flow, from {STEADY_FROM:g} tau on" if left_out else "")
