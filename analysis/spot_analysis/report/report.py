# SPDX-License-Identifier: GPL-2.0-or-later
"""The comparison as a text table, ``comparison.json``, pictures and one self-contained HTML page."""

import base64
import html
import json
import os

import matplotlib.pyplot as plt

from ..statistics.interval import STEADY_FROM
from . import curves
from .figures import FIGURES, SECTIONS, WIDE

MEANING = {
    "grains_initial": "above z = 0 at the first common time",
    "grains_left": "above z = 0 at the last common time",
    "grains_drained": "between them, whatever the interval",
    "grains_outside": "must be 0",
    "outflow": "through z = 0",
    "slab_count": "grains in 50 d < z < 70 d",
    "density_drop": "grains the slab lost since the start",
    "density_drop_fraction": "the same as a share",
    "outflow_fano": "variance over mean of counts in 2 tau; Poisson 1",
    "profile_variance_slope": "of the second moment over z, 10-40 d",
    "variance_slope": "of gaussian_variance over z, 10-40 d; 2 b_s",
    "variance_intercept": "of the same line",
    "correlation_length": "beta of C(r) = alpha exp(-r/beta), 1-6 d",
    "correlation_amplitude": "alpha",
    "correlation_rms": "rms difference of C(r), 1-6 d",
    "particle_diffusion": "b_p, from drops of 1-5 d",
    "packing_fraction": "in the structure region",
    "contacts_per_grain": "grains that overlap a grain there",
    "badness": "sum of squared overlaps a grain there",
    "badness_ratio": "spot over DEM",
    "largest_overlap_region": "there, mean over snapshots",
    "largest_overlap": "anywhere above z = 0",
    "largest_wall_overlap": "of a grain with walls or base",
    "rdf_contact_peak": "g(r) in 0.95 d < r < 1.05 d",
    "rdf_first_minimum": "of g(r)",
    "rdf_at_sqrt3": "g(r) around sqrt(3) d; grows with order",
    "rdf_at_2": "g(r) around 2 d; grows with order",
    "rdf_l2_initial": "rms change of g(r) since the start, r > 1.05 d",
    "rdf_l2": "rms difference of g(r), spot and DEM",
    "rdf_l2_ratio": "rdf_l2 over DEM's rdf_l2_initial",
    "g3_l2_initial": "rms change of g3 since the start",
    "g3_l2": "rms difference of g3, spot and DEM",
    "g3_l2_ratio": "g3_l2 over DEM's g3_l2_initial",
    "crystal_share": "7 or more bonds with q6.q6 > 0.7",
    "voronoi_fraction": "mean over grains of pi/6 over cell volume",
    "voronoi_fraction_spread": "its standard deviation over grains",
    "voronoi_map_rms": "rms difference of the maps, cells of 2 d",
    "speed_wall_over_middle": "v_z within 1 d of a wall over that in |y| < half",
    "packing_fraction_middle": "in the middle half of the thickness",
    "packing_wall_over_middle": "within 1 d of a wall over that",
    "surface_angle": "of the free surface, mean",
    "surface_angle_last": "at the last common time",
    "surface_height_axis": "highest grain, |x| < 2.5 d, then",
    "surface_height_wall": "highest grain within 2.5 d of a side wall, then",
    "unlike_neighbours": "share that started in another layer of 10 d",
    "drained_height_mean": "starting height of the drained grains",
    "drained_height_spread": "its standard deviation",
}
MEANING_OF_FAMILY = {  # by the end or the start of the name
    "_over_outflow": "1 in steady flow",
    "flux_": "through that height",
    "arrival_": "half the final flux reaches that height",
    "profile_variance_": "second moment of the profile of v_z across x",
    "gaussian_variance_": "of the Gaussian that fits this profile",
    "stagnant_boundary_": "|x| where v_z falls to 5 % of the axis",
    "residence_median_": "time from that level to the orifice",
    "residence_spread_": "half of its 16 % to 84 % range",
}
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
            difference, _papers(row.paper), row.bound or "", met, _meaning(row.name))


def _papers(paper):
    """DEM / spot of the literature."""
    if paper is None:
        return ""
    dem, spot, source = paper
    values = ["-" if value is None else _number(value) for value in (dem, spot)]
    return f"{values[0] if spot is None else ' / '.join(values)} ({source})"


def _meaning(name):
    families = (text for part, text in MEANING_OF_FAMILY.items() if name.startswith(part) or name.endswith(part))
    return MEANING.get(name) or next(families, "")


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
        "curves": curves.as_lists(views),
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
    """One page with the pictures inside: the figures of 2006 first, then the table, then the others."""
    runs = "".join(f"<li><b>{name}</b>: {html.escape(_describe_run(view.run))}</li>" for name, view in views.items())
    first, *others = (_figures(title, names, pictures) for title, names in SECTIONS.items())
    interval = html.escape(describe(views["spot"])).replace("\n", "<br>\n")
    with open(path, "w", encoding="utf-8") as handle:
        handle.write(PAGE.format(runs=runs, interval=interval, verdict=html.escape(verdict(rows)), first=first,
                                 table=_html_table(rows), others="".join(others)))


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
tr.met td:nth-child(8) {{ color: #2a7d2a; }} tr.missed td:nth-child(8) {{ color: #b3202c; font-weight: bold; }}
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
packings. Bounds: on spot against DEM; SE is the standard error of DEM.</p>
<table>
{table}</table>
{others}</body></html>
"""
