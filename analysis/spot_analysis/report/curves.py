# SPDX-License-Identifier: GPL-2.0-or-later
"""The curves of a comparison, as they are drawn and stored: name -> x and y of one run over the interval."""

from dataclasses import dataclass
from typing import Callable

import numpy as np

from ..statistics import (bond_angles, free_surface, mixing, particle_diffusion, profile_width, radial_distribution, residence,
                          stagnation, thickness, velocity_correlation)


@dataclass(frozen=True)
class Curve:
    """of : maps a view to x (n,) and y (n,), not a number where unknown; initial : the same of the first snapshot."""

    x: str
    y: str
    of: Callable
    initial: Callable = None


def _profile(index):
    def of(view):
        edges = view.run.profile_edges
        return (edges[1:] + edges[:-1]) / 2, profile_width.mean_profile(view, index)
    return of


def _correlation(view):
    curve = velocity_correlation.mean_correlation(view)
    return velocity_correlation.middles(), curve if curve is not None else 0 * velocity_correlation.middles() + np.nan


def _diffusion(view):
    curve = particle_diffusion.mean_variances(view)
    return particle_diffusion.DROPS, curve if curve is not None else 0 * particle_diffusion.DROPS + np.nan


def _angles(density):
    return lambda view: ((bond_angles.EDGES[1:] + bond_angles.EDGES[:-1]) / 2, density(view))


def _residence(index):
    return lambda view: ((residence.EDGES[1:] + residence.EDGES[:-1]) / 2, residence.distribution(view, index))


def _surface(view):
    part = view.run.measured[free_surface.NAME]
    return part.x, part.heights[view.rows(part.times)[-1]]


def curves(run):
    """Every Curve by its name; run : RunStatistics, for its profile heights."""
    named = {
        "velocity_correlation": Curve("r (d)", "C(r)", _correlation),
        "particle_variance": Curve("drop (d)", "variance of x (d^2)", _diffusion),
        "profile_variance": Curve("z (d)", "variance (d^2)", profile_width.mean_variances),
        "rdf": Curve("r (d)", "g(r)", lambda view: (radial_distribution.middles(view.run),
                                                    radial_distribution.mean_rdf(view)),
                     lambda view: (radial_distribution.middles(view.run), radial_distribution.initial_rdf(view))),
        "g3": Curve("angle (deg)", "density (1/deg)", _angles(bond_angles.mean_density),
                    _angles(bond_angles.initial_density)),
        "packing_across": Curve("y (d)", "packing fraction", thickness.fraction_profile),
        "velocity_across": Curve("y (d)", "-v_z (d/tau)", thickness.speed_profile),
        "surface": Curve("x (d)", "z (d)", _surface),
        "stagnant_boundary": Curve("z (d)", "|x| (d)", stagnation.boundaries),
        "drained_by_height": Curve("starting height (d)", "grains drained", mixing.drained),
    }
    if run.scene.periodic_y:
        del named["packing_across"], named["velocity_across"]
    named.update({f"residence_{level:g}d": Curve("residence time (tau)", "share (1/tau)", _residence(index))
                  for index, level in enumerate(residence.LEVELS)})
    named.update({f"velocity_{height:g}d": Curve("x (d)", "-v_z (d/tau)", _profile(index))
                  for index, height in enumerate(run.profile_heights)})
    return named


def as_lists(views):
    """name -> x, y labels and values of both runs, for JSON; null where unknown."""
    stored = {}
    for name, curve in curves(views["DEM"].run).items():
        entry = {"x_label": curve.x, "y_label": curve.y}
        for run, view in views.items():
            x, y = curve.of(view)
            entry[run.lower()] = {"x": _rounded(x), "y": _rounded(y)}
        if curve.initial:
            x, y = curve.initial(views["DEM"])
            entry["initial"] = {"x": _rounded(x), "y": _rounded(y)}
        stored[name] = entry
    return stored


def _rounded(values):
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in np.asarray(values, dtype=float)]
