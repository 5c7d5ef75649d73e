# SPDX-License-Identifier: GPL-2.0-or-later
"""What the spot model must reach: how far it may be from DEM, by families of quantities that depend on each other."""

import math
from dataclasses import dataclass

from .by_name import by_name


@dataclass(frozen=True)
class Bound:
    """How far a quantity of the spot model may be from DEM's.

    kind : "near" DEM's value; "not above" DEM's; or "at most", where the spot's own value must not exceed ``absolute``
    relative, absolute : allowed deviation, as a share of DEM's value and in the quantity's unit; the larger one counts
    always : whether it holds for start-up, too, or for steady flow only

    Twice the standard error of the difference is allowed as well: where that is wider, the runs do not say more.
    """

    kind: str = "near"
    relative: float = 0.0
    absolute: float = 0.0
    always: bool = False

    def text(self):
        """The bound in words."""
        if self.kind == "at most":
            return f"<= {self.absolute:g}"
        widths = [f"{100 * self.relative:g} %"] * (self.relative > 0) + [f"{self.absolute:g}"] * (self.absolute > 0)
        if self.kind == "not above":
            return f"<= DEM + max({', '.join([*widths, '2 SE'])})" if widths else "<= DEM + 2 SE"
        return f"max({', '.join([*widths, '2 SE'])})"

    def width(self, dem, spot):
        """How far ``spot`` may be from ``dem``, Values of which the first is known."""
        error = math.hypot(dem.error or 0, spot.error or 0)
        return max(self.relative * abs(dem.value), self.absolute, 2 * error)

    def is_met(self, dem, spot):
        """True or False; None where one of the Values that it needs is unknown."""
        if spot.value is None or (dem.value is None and self.kind != "at most"):
            return None
        if self.kind == "at most":
            return spot.value <= self.absolute
        above = spot.value - dem.value
        return above <= self.width(dem, spot) and (self.kind == "not above" or -above <= self.width(dem, spot))


# family -> pattern of names -> Bound. Families are what is independent of each other.
FAMILIES = {
    "rate": {"outflow": Bound(relative=0.02)},
    "volume": {
        "packing_fraction_*tau": Bound(relative=0.005, always=True),
        "packing_axis_less_shoulder": Bound(absolute=0.004),
        "packing_profile_rms": Bound("at most", absolute=0.005),
        **{f"flux_{z}d_over_outflow": Bound(absolute=0.02) for z in (2, 10, 30, 60)},
        "density_drop": Bound(relative=0.05),
    },
    "front": {f"arrival_{z}d": Bound(relative=0.10) for z in (30, 60, 90)},
    "width": {
        **{f"{width}_variance_{z}d": Bound(relative=0.05) for width in ("profile", "gaussian") for z in (10, 30, 50)},
        **{f"stagnant_boundary_{z}d": Bound(relative=0.05) for z in (10, 20, 30)},
    },
    "mixing": {
        "particle_diffusion": Bound(relative=0.06),
        **{f"residence_{part}_{z}d": Bound(relative=0.05) for z in (10, 20) for part in ("p16", "median", "p84")},
    },
    "velocity": {"frame_correlation_rms": Bound("at most", absolute=0.05)},
    "structure": {
        "rdf_l2_ratio": Bound("at most", absolute=0.3),
        "g3_l2_ratio": Bound("at most", absolute=0.3),
        "crystal_share": Bound("not above", absolute=0.02),
    },
    "contacts": {
        "contacts_per_grain": Bound(relative=0.10),
        "badness": Bound("not above", always=True),
        "largest_overlap": Bound("at most", absolute=0.02),
    },
    "surface": {"surface_angle_*tau": Bound(relative=0.20, absolute=2.0, always=True)},
    "walls": {"speed_wall_over_middle": Bound(relative=0.05)},
}
BOUNDS = {"grains_outside": Bound("at most", absolute=0, always=True),
          **{name: bound for family in FAMILIES.values() for name, bound in family.items()}}


def bound_of(name):
    """The Bound on a quantity, None if there is none."""
    return by_name(BOUNDS, name, None)
