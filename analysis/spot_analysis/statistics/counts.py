# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains in the silo, fluxes through heights and the density drop of the slab that 2006 counts in."""

from .value import Value

FLUX_HEIGHTS = (2, 10, 30, 60)  # d
SLAB = (50, 70)  # d
MEANING = {
    "grains_initial": "above z = 0 at the first common time",
    "grains_left": "above z = 0 at the last common time",
    "grains_drained": "between them, whatever the interval",
    "grains_outside": "must be 0",
    "outflow": "through z = 0",
    "slab_count": "grains in 50 d < z < 70 d",
    "density_drop": "grains the slab lost since the start",
    "density_drop_fraction": "the same as a share",
    "*_over_outflow": "1 in steady flow",
    "flux_*": "through that height",
}
NEEDS = {"*": ("height", "outflow")}


def slab_counts(run):
    """(T,) grains in the slab."""
    return run.count_above(SLAB[0]) - run.count_above(SLAB[1])


def quantities(view):
    run = view.run
    above = run.count_above(0)[view.common]
    slab = slab_counts(run)
    slab_count = view.mean("grains", slab.astype(float)) if run.levels[-1] >= SLAB[1] else Value("grains")
    return {
        "grains_initial": Value("grains", int(above[0])),
        "grains_left": Value("grains", int(above[-1])),
        "grains_drained": Value("grains", int(above[0] - above[-1])),
        "grains_outside": Value("grains", int(run.outside[view.common].max())),
        "outflow": view.flux(0),
        **{f"flux_{z}d": view.flux(z) for z in FLUX_HEIGHTS},
        **{f"flux_{z}d_over_outflow": view.flux_over_outflow(z) for z in FLUX_HEIGHTS},
        "slab_count": slab_count,
        "density_drop": _drop("grains", slab_count, slab[0], 1),
        "density_drop_fraction": _drop("1", slab_count, slab[0], slab[0]),
    }


def _drop(unit, slab_count, initial, scale):
    """Grains that the slab lost since the run's first snapshot."""
    if slab_count.value is None or scale == 0:
        return Value(unit)
    error = None if slab_count.error is None else slab_count.error / scale
    return Value(unit, (float(initial) - slab_count.value) / scale, error)
