# SPDX-License-Identifier: GPL-2.0-or-later
"""The comparison as ``comparison.json``."""

import json

from . import curves


def write_json(path, rows, views, verdicts):
    """``comparison.json``: interval, the two runs, the quantities by name, and those judged by family; null where unknown.

    verdicts : Criterion -> Verdict of ``families``
    """
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
        "families": [{"family": one.family, "name": one.name, "window": one.window, "dem": found.dem.value,
                      "dem_error": found.dem.error, "spot": found.spot.value, "spot_error": found.spot.error,
                      "bound": one.bound and one.bound.text(), "met": found.met, "left_out": found.left_out}
                     for one, found in verdicts.items()],
        "curves": curves.as_lists(views),
    }
    with open(path, "w", encoding="utf-8") as handle:
        json.dump(content, handle, indent=2, allow_nan=False)
        handle.write("\n")
