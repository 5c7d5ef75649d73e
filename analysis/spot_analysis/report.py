# SPDX-License-Identifier: GPL-2.0-or-later
"""The comparison as a text table, ``comparison.json``, pictures and one self-contained HTML page."""

import base64
import html
import json
import os

import matplotlib.pyplot as plt

from .plots import FIGURES

MEANING = {
    "grains_initial": "above z = 0 at the first common time",
    "grains_left": "above z = 0 at the last common time",
    "grains_drained": "between them, whatever the interval",
    "outflow": "through z = 0",
    "slab_count": "grains in 50 d < z < 70 d",
    "density_drop": "grains the slab lost since the start",
    "density_drop_fraction": "the same as a share",
    "packing_fraction": "in the structure region",
    "contacts_per_grain": "grains that overlap a grain there",
    "badness": "sum of squared overlaps a grain there",
    "largest_overlap_region": "there, mean over snapshots",
    "largest_overlap": "anywhere above z = 0",
    "largest_wall_overlap": "of a grain with walls or base",
    "grains_outside": "must be 0",
    "rdf_contact_peak": "g(r) in 0.95 d < r < 1.05 d",
    "rdf_l2_initial": "rms change of g(r) since the start, r > 1.05 d",
    "rdf_l2": "rms difference of g(r), spot and DEM",
    "rdf_l2_ratio": "rdf_l2 over DEM's rdf_l2_initial",
}
MEANING_OF_FAMILY = {  # by the end or the start of the name
    "_over_outflow": "1 in steady flow",
    "flux_": "through that height",
    "profile_variance_": "of the profile of v_z across x",
}
HEAD = ("quantity", "unit", "DEM", "spot", "difference", "meaning")


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
    relative = ""
    if row.difference is not None and row.dem:
        relative = f" ({100 * row.difference / abs(row.dem):+.1f} %)"
    difference = "-" if row.difference is None else f"{_number(row.difference, '+')}{relative}"
    return (row.name, row.unit, _with_error(row.dem, row.dem_error), _with_error(row.spot, row.spot_error),
            difference, _meaning(row.name))


def _meaning(name):
    families = (text for part, text in MEANING_OF_FAMILY.items() if name.startswith(part) or name.endswith(part))
    return MEANING.get(name) or next(families, "")


def _with_error(value, error):
    if value is None:
        return "-"
    return _number(value) + ("" if error is None else f" +- {error:.2g}")


def _number(value, sign=""):
    return f"{value:{sign}d}" if isinstance(value, int) else f"{value:{sign}.4g}"


def table(rows):
    """The rows as text in aligned columns."""
    lines = [HEAD, *(cells(row) for row in rows)]
    widths = [max(len(line[column]) for line in lines) for column in range(len(HEAD))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def write_json(path, rows, views):
    """``comparison.json``: interval, the two runs, and the quantities by name; null where unknown."""
    dem = views["DEM"]
    interval = dem.interval
    content = {
        "interval": {
            "from": interval.start, "to": interval.end, "unit": "tau", "kind": interval.kind,
            "snapshots": len(dem.snapshots),
            "common_from": float(dem.run.times[dem.common[0]]), "common_to": float(dem.run.times[dem.common[-1]]),
        },
        "runs": {name.lower(): {"scene": view.run.scene.as_dict(), "provenance": view.run.provenance}
                 for name, view in views.items()},
        "quantities": {row.name: row.as_dict() for row in rows},
    }
    with open(path, "w", encoding="utf-8") as handle:
        json.dump(content, handle, indent=2, allow_nan=False)
        handle.write("\n")


def draw_pictures(folder, views, progress):
    """Draw every figure into ``folder``; returns name -> path of those that could be drawn."""
    paths = {}
    for name, (draw, _) in FIGURES.items():
        progress(f"drawing {name}")
        figure = draw(views)
        if figure is not None:
            paths[name] = os.path.join(folder, f"{name}.png")
            figure.savefig(paths[name], dpi=130)
            plt.close(figure)
    return paths


def write_html(path, rows, views, pictures):
    """One page with the table and the pictures inside."""
    runs = "".join(f"<li><b>{name}</b>: {html.escape(_describe_run(view.run))}</li>" for name, view in views.items())
    head = "".join(f"<th>{html.escape(cell)}</th>" for cell in HEAD)
    body = "".join("<tr>" + "".join(f"<td>{html.escape(cell).replace('+-', '&plusmn;')}</td>" for cell in cells(row))
                   + "</tr>\n" for row in rows)
    figures = "".join(f'<figure><img src="data:image/png;base64,{_base64(picture)}" alt="{name}">'
                      f"<figcaption>{html.escape(FIGURES[name][1])}</figcaption></figure>\n"
                      for name, picture in pictures.items())
    interval = html.escape(describe(views["spot"])).replace("\n", "<br>\n")
    with open(path, "w", encoding="utf-8") as handle:
        handle.write(PAGE.format(runs=runs, interval=interval, head=head, body=body, figures=figures))


def _describe_run(run):
    source = run.provenance.get("source", run.scene.program)
    return f"{source}; {len(run.times)} snapshots, {run.times[0]:g} to {run.times[-1]:g} tau"


def _base64(path):
    with open(path, "rb") as handle:
        return base64.b64encode(handle.read()).decode("ascii")


PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Spot model against DEM</title>
<style>
body {{ font-family: sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #222; }}
table {{ border-collapse: collapse; font-size: 0.9em; }}
th, td {{ text-align: left; padding: 0.25em 0.8em; border-bottom: 1px solid #ddd; }}
td:nth-child(n+3):nth-child(-n+5) {{ font-variant-numeric: tabular-nums; white-space: nowrap; }}
figure {{ margin: 2em 0; }} img {{ max-width: 100%; }} figcaption {{ color: #555; font-size: 0.9em; }}
</style></head><body>
<h1>Spot model against DEM</h1>
<ul>{runs}</ul>
<p>{interval}</p>
<p>Lengths in grain diameters d, times in tau = sqrt(d/g). Standard errors: bootstrap over blocks of at
least 6 tau; none where the interval holds fewer than four.</p>
<table><thead><tr>{head}</tr></thead><tbody>
{body}</tbody></table>
{figures}</body></html>
"""
