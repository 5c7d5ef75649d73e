# SPDX-License-Identifier: GPL-2.0-or-later
"""The comparison as one self-contained HTML page."""

import base64
import html

from .figures import FIGURES, SECTIONS, WIDE
from .table import HEAD, cells, describe, verdict


def write_html(path, rows, views, pictures, families):
    """One page with the pictures inside: the figures of 2006 first, then the tables, then the others.

    families : the table by family as HTML
    """
    runs = "".join(f"<li><b>{name}</b>: {html.escape(_describe_run(view.run))}</li>" for name, view in views.items())
    first, *others = (_figures(title, names, pictures) for title, names in SECTIONS.items())
    interval = html.escape(describe(views["spot"])).replace("\n", "<br>\n")
    with open(path, "w", encoding="utf-8") as handle:
        handle.write(PAGE.format(runs=runs, interval=interval, verdict=html.escape(verdict(rows)), first=first,
                                 table=_html_table(rows), families=families, others="".join(others)))


def _figures(title, names, pictures):
    """A heading and its pictures, two narrow ones side by side."""
    blocks = []
    for name in names:
        if name in pictures:
            blocks.append(f'<figure class="{"wide" if name in WIDE else "half"}"><img alt="{name}" '
                          f'src="data:image/png;base64,{_base64(pictures[name])}">'
                          f"<figcaption>{html.escape(FIGURES[name][1])}</figcaption></figure>\n")
    return f"<h2>{html.escape(title)}</h2>\n<div class=\"figures\">\n{''.join(blocks)}</div>\n"


def _html_table(rows):
    lines, section = ["<tr>" + "".join(f"<th>{html.escape(cell)}</th>" for cell in HEAD) + "</tr>\n"], None
    for row in rows:
        if row.section != section:
            section = row.section
            lines.append(f'<tr><th class="section" colspan="{len(HEAD)}">{html.escape(section)}</th></tr>\n')
        mark = {None: "", True: ' class="met"', False: ' class="missed"'}[row.met]
        body = "".join(f"<td>{html.escape(cell).replace('+-', '&plusmn;')}</td>" for cell in cells(row))
        lines.append(f"<tr{mark}>{body}</tr>\n")
    return "".join(lines)


def _describe_run(run):
    source = run.provenance.get("source", run.scene.program)
    return f"{source}; {len(run.times)} snapshots, {run.times[0]:g} to {run.times[-1]:g} tau"


def _base64(path):
    with open(path, "rb") as handle:
        return base64.b64encode(handle.read()).decode("ascii")


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Spot model against DEM</title>
<style>
body {{ font-family: sans-serif; max-width: 84em; margin: 2em auto; padding: 0 1em; color: #222; }}
table {{ border-collapse: collapse; font-size: 0.8em; }}
th, td {{ text-align: left; padding: 0.2em 0.6em; border-bottom: 1px solid #ddd; vertical-align: top; }}
th.section {{ padding-top: 1.2em; }}
td:nth-child(n+3):nth-child(-n+5) {{ font-variant-numeric: tabular-nums; white-space: nowrap; }}
tr.met td:nth-child(8) {{ color: #2a7d2a; }} tr.missed td:nth-child(8),
table.families tr.missed td:last-child {{ color: #b3202c; font-weight: bold; }}
.figures {{ display: flex; flex-wrap: wrap; gap: 1.5em 2%; align-items: flex-end; }}
figure {{ margin: 0; }} figure.wide {{ width: 64%; }} figure.half {{ width: 32%; }}
img {{ max-width: 100%; }} figcaption {{ color: #555; font-size: 0.85em; }}
@media (max-width: 60em) {{ figure.wide, figure.half {{ width: 100%; }} }}
</style></head><body>
<h1>Spot model against DEM</h1>
<ul>{runs}</ul>
<p>{interval}</p>
<p>{verdict}</p>
{first}<h2>Numbers</h2>
<p>Lengths in grain diameters d, times in tau = sqrt(d/g). Standard errors: bootstrap over blocks of at
least 6 tau; none where the interval holds fewer than four. Papers: DEM, or DEM / spot model, as printed there, from other
packings. Bounds: on spot against DEM; SE is the standard error of their difference.</p>
<table>
{table}</table>
<h2>By family</h2>
<p>Bounds on quantities that depend on each other, together: families are what is independent.</p>
{families}
{others}</body></html>
"""
