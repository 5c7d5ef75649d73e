# SPDX-License-Identifier: GPL-2.0-or-later
"""flow_law.py and its statistics: what is planted is found."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from spot_analysis.base.errors import AnalysisError
from spot_analysis.reading.container import Container
from spot_analysis.statistics import flow_law, flow_places, fraction_law, widening
from spot_analysis.statistics.flow_sums import Measurement
from spot_analysis.statistics.snapshot import Snapshot

from conftest import script
from synthetic import frame_text, write_text

CONTAINER = Container(25.0, 4.0, 4.0)
WIDTH, SPEED, INWARDS, LOOSENING = 10.0, 0.2, 0.004, 0.01  # d, d/tau, 1/tau, 1/tau
X = np.arange(25) + 0.5


def inwards(x):
    return -INWARDS * x * (1 - (x / 25)**2)


def velocity(points):
    """Planted (n, 3): u = SPEED exp(-x^2 / (2 WIDTH^2)), v_x = ``inwards``."""
    x = points[:, 0]
    return np.stack([inwards(x), 0 * x, -SPEED * np.exp(-x**2 / (2 * WIDTH**2))], axis=1)


def packings(snapshots=6, grains=60_000, loosening=0.0):
    """Positions every 2 tau of grains that follow ``velocity``; a share ``loosening`` of them each tau is gone at |x| > 12."""
    rng = np.random.default_rng(17)
    points = rng.uniform((-25, -4, 0), (25, 4, 70), (grains, 3))
    lot = rng.uniform(size=grains)
    for number in range(snapshots):
        here = (lot > 2 * number * loosening) | (np.abs(points[:, 0]) < 12)
        yield np.flatnonzero(here) + 1, points[here]
        for _ in range(4):
            points = points + velocity(points) / 2


def measured(intervals=((0, 10),), **planted):
    measurement = Measurement(CONTAINER, intervals)
    for number, (ids, points) in enumerate(packings(**planted)):
        measurement.add(Snapshot(2.0 * number, ids, points, CONTAINER, None))
    return measurement


@pytest.fixture(scope="module")
def steady():
    return measured()


def test_velocities_fall_and_strain(steady):
    fields, u = steady.fields(0), SPEED * np.exp(-X**2 / (2 * WIDTH**2))
    bulk = slice(10, 50)
    inner = X < 20
    smeared = u * (1 + 1.5**2 / 2 * (X**2 / WIDTH**4 - 1 / WIDTH**2))  # by the Gaussian over which fields are taken
    assert fields.u[:, bulk].mean(axis=1)[inner] == pytest.approx(smeared[inner], rel=0.02)
    assert fields.profile[:, bulk].mean(axis=1)[inner] == pytest.approx(u[inner], rel=0.02)
    assert fields.v_x[:, bulk].mean(axis=1)[inner] == pytest.approx(inwards(X)[inner], rel=0.03, abs=1e-3)
    s = X / WIDTH**2
    assert fields.s[:, bulk].mean(axis=1)[2:20] == pytest.approx(s[2:20], rel=0.06)
    assert fields.s_x[5:15, bulk].mean() == pytest.approx(1 / WIDTH**2, rel=0.1)
    # over the middles of five steps grains have fallen and been sheared for 5 tau, and strain counts whole steps, 4 tau
    assert fields.fallen[:, bulk].mean(axis=1)[inner] == pytest.approx(5 * u[inner], rel=0.06)
    assert fields.strain[3:18, bulk].mean(axis=1) == pytest.approx((4 * s * u)[3:18], rel=0.1)
    assert steady.pairs(0) == 5
    assert steady.drained(0) == pytest.approx(5 * u.sum() * 2 * 60_000 / (50 * 70), rel=0.05)


def test_one_side_alone():
    """What only grains at x > 0 do is seen there only."""
    measurement, rng = Measurement(CONTAINER, [(0, 2)]), np.random.default_rng(3)
    points = rng.uniform((-25, -4, 0), (25, 4, 70), (30_000, 3))
    moved = points + np.where(points[:, :1] > 0, [[-0.2, 0, -0.4]], [[0.1, 0, -0.2]])
    for time, where in ((0.0, points), (2.0, moved)):
        measurement.add(Snapshot(time, np.arange(30_000), where, CONTAINER, None))
    for side, u, v_x in ((1, 0.2, -0.1), (-1, 0.1, -0.05), (0, 0.15, -0.075)):
        fields = measurement.fields(0, side)
        assert fields.u[5:20, 10:50].mean() == pytest.approx(u, rel=5e-3)
        assert fields.v_x[5:20, 10:50].mean() == pytest.approx(v_x, rel=5e-3)


def test_dilation_and_its_rate():
    fields = measured(loosening=LOOSENING).fields(0)
    bulk = slice(10, 50)
    # 5 tau of loss on average; grains that move inwards make up for a part, those of the steady flow as well
    calm = measured().fields(0)
    gained = (fields.dilation - calm.dilation)[16:21, bulk].mean()
    assert gained == pytest.approx(5 * LOOSENING, rel=0.05)
    assert (fields.dilation - calm.dilation)[:8, bulk].mean() == pytest.approx(0, abs=2e-3)
    expected = LOOSENING / (1 - 5 * LOOSENING)
    assert (fields.loss - calm.loss)[16:21, bulk].mean() == pytest.approx(expected, rel=0.1)
    assert fields.dilation_gradient[10:14, bulk].mean() > 5 * abs(fields.dilation_gradient[2:6, bulk].mean())


def test_what_cannot_be_measured():
    with pytest.raises(AnalysisError, match="without grains"):
        Measurement(CONTAINER, [(0, 2)]).add(Snapshot(0.0, np.empty(0, int), np.empty((0, 3)), CONTAINER, None))
    measurement, points = Measurement(CONTAINER, [(0, 2)]), np.random.default_rng(1).uniform(0, 20, (900, 3))
    measurement.add(Snapshot(0.0, np.arange(900), points, CONTAINER, None))
    measurement.add(Snapshot(2.0, np.arange(5, 905), points, CONTAINER, None))
    with pytest.raises(AnalysisError, match="came in"):
        measurement.add(Snapshot(4.0, np.arange(5, 905), points, CONTAINER, None))


def test_b_eff_of_planted_flow(steady):
    """u_x = -u x / WIDTH^2."""
    rows = flow_places.places(steady, wall=6)
    far = rows["x"] > 2
    assert far.sum() > 80
    assert np.median(np.abs(np.log(-rows["b"] * rows["u"] * rows["x"] / WIDTH**2 / inwards(rows["x"])))[far]) < 0.06
    assert np.median(rows["noise"][far]) < 0.1
    assert flow_law.collapse(flow_places.chosen(rows, far), "u").rank < -0.8


def planted_rows(b_0=2.0, s_1=0.4, kappa=0.3, towards=0.0):
    """Places whose v_x follows a law exactly, in which nothing else tells b."""
    rng = np.random.default_rng(5)
    s, u = rng.uniform(0.02, 0.5, 400), rng.uniform(0.05, 0.5, 400)
    rows = {"interval": np.arange(400) % 3, "shear_per_fall": s, "u": u, "u_x": -s * u, "shear_gradient": rng.uniform(0, 0.02, 400),
            "dilation": rng.uniform(0.02, 0.07, 400), "dilation_gradient": rng.uniform(-0.003, 0.003, 400),
            "height": rng.uniform(8, 68, 400)}
    rows["v_x"] = u * (flow_law.saturating(rows, b_0, s_1, kappa) - towards * rows["dilation_gradient"] / rows["dilation"])
    rows["b"] = rows["v_x"] / rows["u_x"]
    return rows


def test_collapse_on_what_decides():
    rows, other = planted_rows(kappa=0), planted_rows(b_0=2.0 * np.exp(0.2), kappa=0)
    decides, idle = (flow_law.collapse(rows, name, other) for name in ("shear_per_fall", "dilation"))
    assert decides.rank == pytest.approx(-1) and decides.scatter < 0.02
    assert decides.other_bias == pytest.approx(0.2, abs=0.01) and decides.other_scatter < 0.02
    assert abs(idle.rank) < 0.15 and idle.scatter > 0.2
    assert decides.bias == pytest.approx([0, 0, 0], abs=0.01)
    with pytest.raises(ValueError, match="too few"):
        flow_law.collapse(flow_places.chosen(rows, np.arange(400) < 19), "dilation")


def test_rank_across_sides_knows_no_common_noise():
    """b_eff and s of a side share a noise that is wrongly a correlation; across sides only what is planted is left."""
    rng = np.random.default_rng(8)
    noise = np.exp(rng.normal(0, 0.5, (2, 2000)))
    rows = {"b_left": 1 / noise[0], "s_left": noise[0], "b_right": 1 / noise[1], "s_right": noise[1]}
    assert abs(flow_law.rank_across(rows)) < 0.07  # four standard errors
    common = np.exp(rng.normal(0, 0.5, 2000))
    assert flow_law.rank_across({name: values * common**(-1 if name[0] == "b" else 1) for name, values in rows.items()}) < -0.3


def test_planted_laws_are_fitted():
    rows = planted_rows(kappa=0.3)
    found, error = flow_law.fit_saturating(rows, (1.5, 0.2, 0.0))
    assert found == pytest.approx([2.0, 0.4, 0.3], rel=1e-3) and np.all(error < 1e-3)
    assert flow_law.misfit(rows, flow_law.saturating(rows, *found)).rms < 1e-4
    rows = planted_rows(s_1=1e9, kappa=0, towards=0.9)  # b = 2.0, kappa = 0.45
    assert flow_law.fit_inclination(rows, ("fick", "target")) == pytest.approx([2.0, 0.9], rel=1e-3)
    one = flow_law.fit_inclination(rows, ("fick",))
    assert flow_law.misfit(rows, flow_law.inclination_terms(rows, ("fick",)) @ one).rms > 0.1


def fields_of(u, dilation=None, loss=0.0, half=40, top=60):
    """What ``widening`` needs of FlowFields: u (X, Z) or a function of x and z."""
    x, z = np.meshgrid(np.arange(half) + 0.5, np.arange(70) + 0.5, indexing="ij")
    return SimpleNamespace(u=u(x, z), dilation=np.zeros_like(x) if dilation is None else dilation(x, z), loss=loss + 0 * x, top=top)


def gaussian(x, z):
    return np.exp(-x**2 / 40)


def test_free_flow_widens_as_2_b_z():
    made = widening.march(fields_of(gaussian), b=1.3)
    assert list(made) == list(widening.HEIGHTS)
    for z, u in made.items():
        assert widening.widths(u) == pytest.approx([20 + 2 * 1.3 * (z - widening.START)] * 2, rel=0.02)
        assert u.sum() == pytest.approx(gaussian(np.arange(40) + 0.5, 0).sum())


def test_flow_towards_dilation_comes_to_rest_at_its_power():
    """J = 0 where u ~ c^kappa."""
    def dilation(x, z):
        return 0.02 + 0.03 * np.exp(-x**2 / 50) - widening.DILATION_FLOOR

    fields = fields_of(lambda x, z: (dilation(x, z) + widening.DILATION_FLOOR)**0.7, dilation)
    for u in widening.march(fields, b=1.5, kappa=0.7).values():
        assert u == pytest.approx(fields.u[:, 0], rel=1e-9)


def test_loss_is_taken_off():
    fields = fields_of(gaussian, loss=1e-4)
    with_loss, without = (widening.march(fields, b=1.0, with_loss=loss)[50] for loss in (True, False))
    assert without.sum() - with_loss.sum() == pytest.approx(1e-4 * 40 * 44, rel=0.35)  # less where nothing is left to take
    assert with_loss[:10].sum() == pytest.approx(without[:10].sum() - 1e-4 * 10 * 44, rel=0.02)


def test_law_is_fitted_to_the_widths_that_it_made():
    planted = {"b": 2.0, "shear": 0.4}
    fields = fields_of(gaussian)
    made = widening.march(fields, **planted)
    for z, u in made.items():
        fields.u[:, z - 1:z + 1] = u[:, None]
    assert np.abs(widening.errors(fields, **planted)).max() < 1e-9
    found, rms = widening.fit([fields], {"b": 1.4, "shear": 1.0})
    assert found == pytest.approx(planted, rel=0.01) and rms < 1e-3
    assert widening.fit([fields], {"b": 1.4})[1] > 0.02


def test_packing_fraction_law():
    s = np.linspace(0.005, 0.4, 60)
    fraction = 0.586 - 0.56 * s / (1 + s / 0.03) + np.random.default_rng(2).normal(0, 1e-4, 60)
    found, residual = fraction_law.fit(s, fraction, "saturating")
    assert found == pytest.approx([0.586, 0.56, 0.03], rel=0.02) and residual.std() < 2e-4
    assert fraction_law.fit(s, fraction, "line")[1].std() > 1e-3


def test_cells(steady):
    cells = fraction_law.cells(steady, 0)
    assert len(cells["s"]) > 60 and cells["x"].max() <= 22
    assert cells["s"] == pytest.approx(cells["x"] / WIDTH**2, rel=0.2)
    spread = INWARDS * np.abs(1 - 3 * (cells["x"] / 25)**2) / (SPEED * np.exp(-cells["x"]**2 / (2 * WIDTH**2)))
    inner = cells["x"] < 18
    assert cells["s_full"][inner] == pytest.approx(np.hypot(cells["s"], np.sqrt(2) * spread)[inner], rel=0.25)
    at_rest = 60_000 * np.pi / 6 / (50 * 8 * 70)
    assert cells["fraction"].mean() == pytest.approx(at_rest, rel=0.05)


@pytest.fixture(scope="module")
def dumps(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dumps")
    (folder / "scene.json").write_text(json.dumps({"diameter": 1.0, "gravity": 1.0, "timestep": 0.01, "half_width_x": 25.0,
                                                   "half_depth_y": 4.0, "orifice_radius": 4.0}))
    for number, (ids, points) in enumerate(packings(snapshots=4, grains=30_000)):
        write_text(folder / f"run.{200 * number}.dump.gz", frame_text(200 * number, ids, points))
    return folder


def test_command(dumps):
    done = script("flow_law.py", dumps, "--intervals", "0-6", "--other", dumps, "--other-intervals", "0-4")
    assert done.returncode == 0, done.stderr
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in done.stdout.splitlines() if line.startswith("| ")]
    named = {row[0]: row for row in rows}
    assert {*flow_places.CANDIDATES} <= {*named}
    assert float(named["share_of_axis"][2]) < float(named["height"][2])  # b goes as 1 / u
    widths = [row for row in rows if row[0] in ("run", "other") and row[1] in ("0-6", "0-4")]
    assert len(widths) == 2 and float(widths[0][3].split()[0]) == pytest.approx(93, rel=0.1)  # WIDTH^2, cut at the walls


@pytest.mark.parametrize("arguments, message", [
    (("--intervals", "40"), "is no interval"), (("--intervals", "9-4"), "must end after it starts"),
    (("--intervals", "40-90"), "no two snapshots"), (("--other", "nowhere"), "no such file")])
def test_bad_input(dumps, arguments, message):
    done = script("flow_law.py", dumps, *arguments)
    assert done.returncode != 0 and message in done.stderr and "Traceback" not in done.stderr
