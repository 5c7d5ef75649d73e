# SPDX-License-Identifier: GPL-2.0-or-later
"""The numbers of two runs side by side, over the times that both have."""

import math
from dataclasses import dataclass

from ..statistics import (bond_angles, bond_order, counts, fluctuations, frame_correlation, free_surface, front, mixing, packing,
                          particle_diffusion, profile_width, radial_distribution, residence, stagnation, thickness, through_time,
                          velocity_correlation, voronoi)
from ..statistics.interval_view import whole_run
from ..statistics.value import Value
from . import left_out
from .bounds import bound_of
from .by_name import by_name
from .papers import PAPERS

# Each concept has quantities(view): name -> Value, and some between(dem view, spot view) for what needs both. MEANING says
# what each of them is, and NEEDS what it needs to be known, of ``left_out.NEEDS``; in both the first pattern counts that fits.
SECTIONS = {
    "Counts and fluxes": (counts, fluctuations, front),
    "Velocities": (profile_width, velocity_correlation, frame_correlation, particle_diffusion),
    "Packing": (packing, radial_distribution, bond_angles, bond_order, voronoi, thickness),
    "Surface, stagnant zone, mixing": (free_surface, stagnation, residence, mixing),
    "Through time, whatever the interval": (through_time,),
}


@dataclass(frozen=True)
class Row:
    """One line of the comparison; None where a value is unknown.

    section : of SECTIONS
    difference : spot less DEM, with its standard error where both have one
    bound, met : in words, and whether the spot model keeps it
    paper : (DEM, spot, source) of the literature
    left_out : why a value is unknown
    meaning : what it is, in a few words
    """

    name: str
    section: str
    unit: str
    dem: float
    dem_error: float
    spot: float
    spot_error: float
    difference: float
    difference_error: float
    bound: str = None
    met: bool = None
    paper: tuple = None
    left_out: str = None
    meaning: str = ""

    def as_dict(self):
        keys = ("unit", "dem", "dem_error", "spot", "spot_error", "difference", "difference_error", "bound", "met")
        paper = self.paper and dict(zip(("dem", "spot", "source"), self.paper))
        return {**{key: getattr(self, key) for key in keys}, "paper": paper}


def quantities(view):
    """Every number of one run by its name, as Value, in the order of the table."""
    return {name: value for concepts in SECTIONS.values() for concept in concepts
            for name, value in concept.quantities(view).items()}


def left_out_of(run):
    """name -> why it is unknown, of the numbers of a RunStatistics over the interval that would be chosen."""
    view = whole_run(run)
    return {name: left_out.why(view, concept, name) for concepts in SECTIONS.values() for concept in concepts
            for name, value in concept.quantities(view).items() if value.value is None}


def compare(dem_view, spot_view, progress=lambda text, share: None, sections=SECTIONS):
    """The rows of the comparison; sections : name -> concepts."""
    steady = dem_view.interval.is_steady()
    rows, done, total = [], 0, sum(map(len, sections.values()))
    for section, concepts in sections.items():
        for concept in concepts:
            progress(f"estimating {concept.__name__.rpartition('.')[2]}", done / total)
            done += 1
            dem, spot = concept.quantities(dem_view), concept.quantities(spot_view)
            for name in dem:
                lacking = {run: view for run, view, value in (("DEM", dem_view, dem[name]), ("spot", spot_view, spot[name]))
                           if value.value is None}
                rows.append(_row(section, concept, name, dem[name], spot[name], steady, lacking))
            if hasattr(concept, "between"):
                for name, value in concept.between(dem_view, spot_view).items():
                    lacking = {"DEM": dem_view, "spot": spot_view} if value.value is None else {}
                    rows.append(_row(section, concept, name, Value(value.unit), value, steady, lacking))
    return rows


def _row(section, concept, name, dem, spot, steady, lacking):
    """The Row with its difference, bound and literature; most bounds are judged in steady flow only.

    lacking : name -> IntervalView of the runs in which it is unknown
    """
    difference = error = None
    if dem.value is not None and spot.value is not None:
        difference = spot.value - dem.value
        error = None if dem.error is None or spot.error is None else math.hypot(dem.error, spot.error)
    bound = bound_of(name)
    met = bound.is_met(dem, spot) if bound and (steady or bound.always) else None
    return Row(name, section, dem.unit, dem.value, dem.error, spot.value, spot.error, difference, error,
               bound and bound.text(), met, PAPERS.get(name),
               left_out.of_runs(lacking, concept, name) if lacking else None, by_name(concept.MEANING, name, ""))
