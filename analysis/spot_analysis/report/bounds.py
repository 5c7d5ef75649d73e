# SPDX-License-Identifier: GPL-2.0-or-later
"""What the spot model must reach: how far it may be from DEM."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Bound:
    """How far the spot model may be from DEM.

    kind : "relative" to DEM, "absolute", "target" (the spot's own value against ``target``), "below" (the spot's own value
        at most ``share``) or "below dem"
    share : allowed deviation, as a share of DEM's value if relative
    errors : also allowed, in standard errors of DEM; where those are wider, DEM itself does not say more
    always : whether it holds for start-up, too, or for steady flow only
    """

    kind: str
    share: float = 0.0
    errors: float = 0.0
    target: float = None
    always: bool = False

    def text(self):
        """The bound in words."""
        if self.kind == "below dem":
            return "<= DEM"
        if self.kind == "below":
            return f"<= {self.share:g}"
        width = f"{100 * self.share:g} %" if self.kind == "relative" else f"{self.share:g}"
        width = f"max({width}, {self.errors:g} SE)" if self.errors else width
        return width if self.target is None else f"{self.target:g} +- {width}"

    def is_met(self, dem, dem_error, spot):
        """True or False, None where a value is missing."""
        if spot is None or (dem is None and self.kind in ("relative", "absolute", "below dem")):
            return None
        if self.kind == "below dem":
            return spot <= dem
        if self.kind == "below":
            return spot <= self.share
        width = self.share * abs(dem) if self.kind == "relative" else self.share
        return abs(spot - (dem if self.target is None else self.target)) <= max(width, self.errors * (dem_error or 0))


TIGHT = Bound("relative", 0.02, 2)
BOUNDS = {
    "grains_outside": Bound("below", 0, always=True),
    "outflow": TIGHT,
    **{f"flux_{z}d_over_outflow": Bound("target", 0.02, 2, target=1) for z in (2, 10, 30, 60)},
    "density_drop": Bound("relative", 0.05, 2),
    **{f"arrival_{z}d": Bound("relative", 0.10, 2) for z in (30, 60, 90)},
    "variance_slope": Bound("relative", 0.05, 2),
    "particle_diffusion": Bound("relative", 0.06, 2),
    "correlation_length": Bound("relative", 0.15, 2),
    "correlation_rms": Bound("below", 0.05),
    "rdf_l2_ratio": Bound("below", 0.5),
    "g3_l2_ratio": Bound("below", 0.5),
    "packing_fraction": Bound("relative", 0.01, 2),
    "contacts_per_grain": Bound("relative", 0.10, 2),
    "badness": Bound("below dem", always=True),
}
