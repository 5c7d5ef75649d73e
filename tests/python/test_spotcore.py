# SPDX-License-Identifier: GPL-2.0-or-later
"""spotcore, the Python module. Lengths are in grain diameters, times in sqrt(diameter / gravity), unless a test says so."""

import ast
import doctest
import inspect
import os
import pathlib
import re
import signal
import subprocess
import threading
import time

import numpy as np
import pytest

import spotcore
from spotcore import Drainage, Outlet, Packing, Parameters, Shape, Walls, drain, lattice

ROOT = pathlib.Path(__file__).resolve().parents[2]
BOX = Walls.box((-8, 8), (-5, 5))
POSITIONS = lattice((-8, -5, 0), (8, 5, 9), 1.0)
PACKING = Packing(POSITIONS, 0.5)


def opening(outflow=40.0, **rest):
    return [Outlet.round((0, 0, 0), 4.0, outflow=outflow, **rest)]


def beads(**changes):
    return Parameters.glass_beads(1.0, 1.0, **changes)


def state(drainage):
    """All that has come out, as bytes."""
    arrays = [drainage.packing.positions, drainage.packing.ids, drainage.drained.positions, drainage.drained.ids,
              drainage.drained.times, drainage.spots.positions, drainage.spots.volumes]
    return [array.tobytes() for array in arrays] + [drainage.counters.moves, drainage.counters.sweeps]


def test_examples_in_docstrings_run():
    results = doctest.testmod(spotcore)
    assert results.failed == 0 and results.attempted >= 20


def test_stub_names_all_there_is_and_nothing_else():
    tree = ast.parse((pathlib.Path(spotcore.__file__).parent / "__init__.pyi").read_text())
    stub = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            stub[node.name] = {m.name if isinstance(m, ast.FunctionDef) else m.target.id for m in node.body
                               if isinstance(m, (ast.FunctionDef, ast.AnnAssign))}
        elif isinstance(node, ast.FunctionDef):
            stub[node.name] = inspect.signature  # any mark of a function
    assert set(stub) | {"__version__"} == set(spotcore.__all__)
    for name in set(stub) - {"drain", "lattice", "CollapsedPacking"}:
        public = {m for m in vars(getattr(spotcore, name)) if not m.startswith("_")}
        assert {m for m in stub[name] if not m.startswith("_")} == public, name
    assert (pathlib.Path(spotcore.__file__).parent / "py.typed").exists()


def test_everything_public_has_a_docstring():
    for name in set(spotcore.__all__) - {"__version__"}:
        thing = getattr(spotcore, name)
        members = [m for m in vars(thing) if not m.startswith("_")] if inspect.isclass(thing) else []
        for one in [thing] + [getattr(thing, m) for m in members if name != "CollapsedPacking" or m not in dir(RuntimeError)]:
            assert one.__doc__ and one.__doc__.strip(), (name, one)


# The same bits as fix spot.

LOAD_SPOT = ROOT / "lammps-package" / "load_spot.lmp"
needs_lmp = pytest.mark.skipif("SPOT_LMP" not in os.environ, reason="needs lmp: SPOT_LMP")
MODEL = ("speed 6 volume 77 influence 1.5e-3 diffusion 1.47 critical 0.62 0.75 dilatancy 0.15 full_strain 0.2 "
         "spread 0.6 0.7 surface 2 nonaffine 0.15 0.5 closing 0.004 0.15")


def run_lmp(folder, walls_and_outlets, positions, steps, window, box="-12 12 -12 12 -4 30", boundary="f f f", model=MODEL):
    """Positions and ids after so many steps of a window by fix spot, in increasing order of ids."""
    low_high = box.split()
    text = ["grains", "", f"{len(positions)} atoms", "1 atom types", ""]
    text += [f"{low_high[2 * k]} {low_high[2 * k + 1]} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
    text += ["", "Atoms # sphere", ""] + [f"{i + 1} 1 1 1 {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(positions.tolist())]
    (folder / "packing.data").write_text("\n".join(text) + "\n")
    (folder / "in.deck").write_text(f"""
units lj
atom_style sphere
boundary {boundary}
include {LOAD_SPOT}
read_data packing.data
fix drain all spot {walls_and_outlets} {model} window {window!r}
timestep {window!r}
dump grains all custom {steps} out.*.dump id x y z
dump_modify grains sort id format float %.17g
run {steps}
""")
    done = subprocess.run([os.environ["SPOT_LMP"], "-in", "in.deck", "-log", "none", "-nocite"], cwd=folder,
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    rows = np.loadtxt(folder / f"out.{steps}.dump", skiprows=9)
    return rows[:, 1:], rows[:, 0].astype(int)


HOPPER = Shape.cone((0, 0, 0), 4.0, (0, 0, 8), 9.0) | Shape.cylinder((0, 0, 8), (0, 0, 20), 9.0)
SCENES = {
    "box": ("box -8 8 -5 5 orifice 0 0 0 4 injection 300 schedule 1 3 0.5", BOX,
            [Outlet.round((0, 0, 0), 4.0, births=300.0, schedule=[(3.0, 0.5)])], {}),
    "slot": ("box -8 8 -5 5 slot 0 0 0 6 8 beverloo 1.0", BOX, [Outlet.slot((0, 0, 0), (6, 8), gravity=1.0)], {}),
    "two outlets": ("box -8 8 -5 5 orifice -4.5 0 0 3 orifice 4 1 0 3.5 injection 100 200", BOX,
                    [Outlet.round((-4.5, 0, 0), 3.0, births=100.0), Outlet.round((4, 1, 0), 3.5, births=200.0)], {}),
    "periodic": ("box -8 8 NULL NULL orifice 0 0 0 3 injection 300", Walls.box((-8, 8), (-6, 6), periodic="y"),
                 [Outlet.round((0, 0, 0), 3.0, births=300.0)],
                 {"box": "-12 12 -6 6 -4 30", "boundary": "f p f"}),
    "cylinder": ("cylinder 0 0 8 orifice 0 0 0 4 injection 300", Walls.cylinder(0, 0, 8),
                 [Outlet.round((0, 0, 0), 4.0, births=300.0)], {}),
    "shapes": ("walls add cone z 0 0 4 9 0 8 walls add cylinder z 0 0 9 8 20 walls cut sphere 5 0 7 1 "
               "orifice 0 0 0 4 injection 300", Walls.inside(HOPPER - Shape.sphere((5, 0, 7), 1.0)),
               [Outlet.round((0, 0, 0), 4.0, births=300.0)], {}),
}


def packing_of(scene):
    if scene == "periodic":
        return lattice((-8, -6, 0), (8, 6, 9), 1.0)
    if scene == "cylinder":
        positions = lattice((-8, -8, 0), (8, 8, 9), 1.0)
        return positions[np.hypot(*positions.T[:2]) <= 7.5]
    if scene == "shapes":
        positions = lattice((-9, -9, 0), (9, 9, 12), 1.0)
        radius = 4.0 + np.minimum(positions[:, 2], 8.0) * 5 / 8 - 0.6
        beside_sphere = np.linalg.norm(positions - (5, 0, 7), axis=1) >= 1.5
        return positions[(np.hypot(*positions.T[:2]) <= radius) & beside_sphere]
    return POSITIONS


@needs_lmp
@pytest.mark.parametrize("scene", SCENES)
def test_same_bits_as_fix_spot(scene, tmp_path):
    deck, walls, outlets, options = SCENES[scene]
    positions = packing_of(scene)
    parameters = beads(critical_fraction=0.55)
    window, steps = 0.04, 150
    there, ids = run_lmp(tmp_path, deck, positions, steps, window, model=MODEL.replace("critical 0.62", "critical 0.55"), **options)
    drainage = drain(Packing(positions, 0.5), walls, outlets, parameters, steps * window, window=window)
    assert drainage.time == steps * window
    here = drainage.packing
    assert 0 < len(drainage.drained) < len(positions) / 2
    assert here.ids.tolist() == ids.tolist()
    assert here.positions.tobytes() == there.tobytes()


def test_parameters_of_glass_beads_are_those_of_the_deck():
    text = (ROOT / "examples" / "own-hopper" / "in.own").read_text()
    assert "/glass-beads.lmp" in text and " ${beads} " in text  # the next test is of that file
    p = Parameters.glass_beads(0.003, 0.0175)
    assert p.speed == pytest.approx(6 * 0.003 / 0.0175)
    assert [p.dilation, p.volume, p.influence, p.critical_fraction, p.spread, p.wall_shear, p.surface_exponent, p.nonaffine,
            p.closing_gap, p.closing_share] == [0, 77, 1.5e-3, 0.62, 0.6, 0.7, 2, 0.15, 0.004, 0.15]
    assert [p.diffusion_length, p.exchange_length, p.dilatancy, p.full_strain, p.nonaffine_length] == pytest.approx(
        [1.47 * 0.003, 0.75 * 0.003, 0.15 * 0.003, 0.2 / 0.003, 0.5 * 0.003])


def test_parameters_of_glass_beads_are_those_that_decks_include():
    text = (ROOT / "lammps-package" / "glass-beads.lmp").read_text()
    deck = dict(re.findall(r"^variable\s+(\w+)\s+index (\S+)", text, re.MULTILINE))
    for name, value in deck.items():  # lengths, speeds and strains are of the form $(1.47*v_d), $(2.5*v_d/v_tau), $(0.2/v_d)
        deck[name] = re.sub(r"^\$\(([0-9.]+)(?:\*v_d(?:/v_tau)?|/v_d)\)$", r"\1", value)
    p = Parameters.glass_beads(1.0, 1.0)
    same = {"radius": p.radius, "influence": p.influence, "volume": p.volume, "diffusion": p.diffusion_length, "dilation": p.dilation,
            "speed": p.speed, "critical": p.critical_fraction, "exchange": p.exchange_length, "dilatancy": p.dilatancy, "full_strain": p.full_strain,
            "spread": p.spread,
            "wall_shear": p.wall_shear, "surface": p.surface_exponent, "nonaffine": p.nonaffine, "own_way": p.nonaffine_length,
            "closing_gap": p.closing_gap, "closing_share": p.closing_share}
    assert set(deck) - set(same) == {"profile"}
    for name, value in same.items():
        assert float(deck[name]) == pytest.approx(value, rel=1e-12), name


# What threads, pieces of time and callbacks change: nothing.

@pytest.fixture(scope="module")
def one_thread():
    return drain(PACKING, BOX, opening(), beads(), 6.0)


@pytest.mark.parametrize("threads", [2, 3])
def test_threads_change_nothing(one_thread, threads):
    assert state(drain(PACKING, BOX, opening(), beads(), 6.0, threads=threads)) == state(one_thread)


def test_another_seed_changes_all(one_thread):
    assert state(drain(PACKING, BOX, opening(), beads(seed=2), 6.0)) != state(one_thread)


def test_pieces_and_callbacks_change_nothing(one_thread):
    drainage = Drainage(PACKING, BOX, opening(), beads())
    seen = []
    for until in (0.7, 0.7, 3.1, 6.0):
        assert drainage.advance_to(until, seen.append, every=0.3)
        drainage.set_threads(2)
    assert state(drainage) == state(one_thread)
    assert [p.time for p in seen] == sorted(p.time for p in seen) and seen[-1].time == drainage.time
    assert all(p.grains + p.drained == len(PACKING) for p in seen)
    assert seen[-1].drained == len(drainage.drained) and seen[-1].spots == len(drainage.spots)
    assert seen[0].until == 0.7 and 17 <= len(seen) <= 24


def test_sums_and_counters(one_thread):
    d = one_thread
    assert d.counters.drained == len(d.drained) == d.drained_through.sum() > 50
    assert sorted([*d.packing.ids, *d.drained.ids]) == list(range(1, len(PACKING) + 1))
    assert d.packing.positions.shape == (len(d.packing), 3) and d.drained.positions.shape == (len(d.drained), 3)
    assert (np.diff(d.packing.ids) > 0).all() and (d.packing.positions[:, 2] >= 0).all()
    assert (d.drained.positions[:, 2] < 0).all()
    assert (np.diff(d.drained.times) >= 0).all() and 0 < d.drained.times[0] <= d.drained.times[-1] <= d.time <= 6.0
    assert np.allclose(d.drained.times / d.window, np.round(d.drained.times / d.window))
    assert 0 < d.largest_overlap < 0.3 and d.counters.moves > 0 and d.counters.grains_per_move > 10
    assert d.spots.positions.shape == (len(d.spots), 3) and (np.diff(d.spots.ids) > 0).all()
    assert (d.spots.volumes > 0).all() and d.spots.steps.sum() <= d.counters.moves


def test_counts_of_each_outlet_are_the_grains_that_left_there():
    outlets = [Outlet.round((-4.5, 0, 0), 3.0, births=100.0), Outlet.round((4, 1, 0), 3.5, births=200.0)]
    d = drain(PACKING, BOX, outlets, beads(), 6.0)
    left = d.drained.positions[:, 0] < 0
    assert d.drained_through.tolist() == [left.sum(), (~left).sum()] and left.sum() > 20
    assert (d.drained.outlets == np.where(left, 0, 1)).all()


def test_a_closed_outlet_lets_nothing_out():
    d = drain(PACKING, BOX, opening(schedule=[(0.0, 0.0), (4.0, 1.0)]), beads(), 6.0)
    assert len(d.drained) > 0 and d.drained.times[0] > 4.0


def test_a_factor_is_a_step_of_the_schedule():
    """To the last bit, between calls and in a callback."""
    later = Drainage(PACKING, BOX, opening(), beads())
    later.advance_to(3.0)
    at = later.time
    later.set_factor(0, 0.5)
    later.advance_to(6.0)
    called = Drainage(PACKING, BOX, opening(), beads())
    called.advance_to(6.0, callback=lambda progress: called.set_factor(0, 1.0 if progress.time < at else 0.5), every=called.window)
    scheduled = drain(PACKING, BOX, opening(schedule=[(at, 0.5)]), beads(), 6.0)
    full = drain(PACKING, BOX, opening(), beads(), 6.0)
    assert np.array_equal(later.packing.positions, scheduled.packing.positions)
    assert np.array_equal(called.packing.positions, scheduled.packing.positions)
    assert scheduled.counters.moves < full.counters.moves


def test_factors_out_of_range_are_refused():
    d = Drainage(PACKING, BOX, opening(), beads())
    for outlet, factor, text in [(1, 1.0, "outlet is 1 but must be from 0 to 0"), (-1, 1.0, "outlet is -1"),
                                 (0, -0.5, "factor is -0.5"), (0, float("nan"), "factor is nan"), (0, 1e300, "")]:
        with pytest.raises(ValueError, match=text):
            d.set_factor(outlet, factor)


def test_outflow_is_what_was_asked_for():
    """At 40 grains per time; births are Poisson, of 346 a time: 3 standard errors of their number in 6 times are 7 %,
    and the first spots bring what they enclose in the outlet later: hence 20 %."""
    d = Drainage(Packing(lattice((-8, -5, 0), (8, 5, 20), 1.0), 0.5), BOX, opening(), beads())
    d.advance_to(4.0)
    before = len(d.drained)
    d.advance_to(10.0)
    assert len(d.drained) - before == pytest.approx(40.0 * 6.0, rel=0.2)


def test_beverloo_is_the_formula():
    """Beverloo et al. (1961): 0.58 n sqrt(g) (D - 1.4 d)^(5/2), with n of a packing fraction of 0.58."""
    outflow = 0.58 * 0.58 / (np.pi / 6) * np.sqrt(9.81) * (8.0 - 1.4) ** 2.5
    by_law = drain(PACKING, BOX, [Outlet.round((0, 0, 0), 4.0, gravity=9.81)], beads(speed=10.0), 0.5)
    given = drain(PACKING, BOX, opening(outflow), beads(speed=10.0), 0.5)
    assert by_law.counters.moves == given.counters.moves and len(by_law.spots) == len(given.spots)
    with pytest.warns(UserWarning, match="may clog"):
        Drainage(PACKING, BOX, [Outlet.round((0, 0, 0), 2.9, gravity=9.81)], beads(speed=10.0))


def test_unequal_and_held_grains():
    radii = np.full(len(PACKING), 0.5)
    radii[::3] = 0.45
    held = np.zeros(len(PACKING), bool)
    held[np.argmin(np.linalg.norm(POSITIONS - (-6, 3, 5), axis=1))] = True
    ids = np.arange(len(PACKING)) * 10
    d = drain(Packing(POSITIONS, radii, ids=ids, held=held), BOX, opening(), beads(critical_fraction=0.0, dilatancy=0.0, full_strain=0.0), 6.0)
    left = d.packing
    assert (left.radii == radii[left.ids // 10]).all() and (left.held == held[left.ids // 10]).all()
    assert left.held.sum() == 1 and np.abs(left.positions[left.held] - POSITIONS[held]).max() < 1e-7  # but for the quantum
    assert len(d.drained) > 0


def test_a_packing_goes_on_from_where_another_ended(one_thread):
    again = Packing(one_thread.packing.positions, one_thread.packing.radii, ids=one_thread.packing.ids)
    d = Drainage(again, BOX, opening(), beads(largest_overlap=0.1, critical_fraction=0.0, dilatancy=0.0, full_strain=0.0))
    assert (d.packing.positions == one_thread.packing.positions).all()  # not a bit is lost


# How it stops.

def test_callback_stops():
    calls = []

    def callback(progress):
        calls.append(progress.time)
        return len(calls) < 3

    d = Drainage(PACKING, BOX, opening(), beads())
    assert d.advance_to(6.0, callback, every=0.5) is False
    assert len(calls) == 3 and d.time == calls[-1] < 2.0
    assert d.advance_to(6.0) is True


def test_what_cannot_be_called_is_no_callback():
    with pytest.raises(TypeError, match="callback cannot be called"):
        Drainage(PACKING, BOX, opening(), beads()).advance_to(1.0, callback=3)


def test_what_a_callback_raises_comes_out_and_the_drainage_goes_on(one_thread):
    d = Drainage(PACKING, BOX, opening(), beads())

    def callback(progress):
        with pytest.raises(RuntimeError, match="advancing already"):
            d.advance_to(9.0)
        len(d.packing)  # may be looked at
        raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        d.advance_to(6.0, callback)
    d.advance_to(6.0)
    assert state(d) == state(one_thread)


def test_ctrl_c_stops_at_a_whole_window():
    d = Drainage(Packing(lattice((-8, -5, 0), (8, 5, 60), 1.0), 0.5), BOX, opening(), beads())
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        d.advance_to(1e6)
    assert 0 < d.time < 1e6 and d.time / d.window == pytest.approx(round(d.time / d.window))
    assert d.advance_to(d.time + d.window * 2)


def test_other_threads_go_on_and_may_not_interfere():
    d = Drainage(PACKING, BOX, opening(), beads())
    stop, refused = threading.Event(), []

    def look():
        while not stop.is_set():
            try:
                assert len(d.packing) > 0
            except RuntimeError as error:
                refused.append(str(error))
            time.sleep(0.0005)

    thread = threading.Thread(target=look)
    thread.start()
    try:
        while not refused and d.time < 60.0:
            d.advance_to(d.time + 1.0)
    finally:
        stop.set()
        thread.join()
    assert set(refused) == {"the drainage is running in another thread"}


def test_a_collapse_has_a_class_of_its_own_and_ends_the_drainage():
    d = Drainage(PACKING, BOX, opening(), beads(tolerance=1e3, influence=0.02, critical_fraction=0.0, dilatancy=0.0, full_strain=0.0))
    with pytest.raises(spotcore.CollapsedPacking, match="overlap by|left through the base"):
        d.advance_to(30.0)
    with pytest.raises(RuntimeError, match="has failed"):
        d.advance_to(31.0)


# What is refused.

@pytest.mark.parametrize("arguments, text", [
    ((POSITIONS[:, :2], 0.5), r"positions has shape \(\d+, 2\) but must have shape \(N, 3\)"),
    ((POSITIONS.ravel(), 0.5), r"positions has shape \(\d+,\) but must have shape \(N, 3\)"),
    ((POSITIONS.astype(complex), 0.5), "positions is an array of complex128"),
    ((POSITIONS.astype(str), 0.5), "positions is an array of <U"),
    ((POSITIONS.astype(object), 0.5), "positions is an array of object"),
    ((POSITIONS, [0.5, 0.5]), r"radius has shape \(2,\) but must have shape \(\d+,\)"),
    ((POSITIONS, [[0.5], [0.5, 0.5]]), "radius cannot be made an array"),
    (([[0.0, 0.0], [0.0]], 0.5), "positions cannot be made an array"),
    ((POSITIONS, "thick"), "radius is an array of <U5"),
    ((POSITIONS, None), "radius is an array of object"),
    ((POSITIONS, -0.5), "radius of grain 1 is -0.5"),
    ((POSITIONS, np.nan), "radius of grain 1 is nan"),
    ((POSITIONS, 0.5, np.ones(len(POSITIONS))), "ids is an array of float64 but must be one of integers"),
    ((POSITIONS, 0.5, [1, 2]), r"ids has shape \(2,\)"),
    ((POSITIONS, 0.5, None, np.zeros(len(POSITIONS))), "held is an array of float64 but must be one of booleans"),
])
def test_arrays_of_another_shape_or_kind_are_refused(arguments, text):
    with pytest.raises(ValueError, match=text):
        Packing(*arguments)


@pytest.mark.parametrize("radius", [1, np.float32(0.5), np.full((), 0.5), len(POSITIONS) * [0.5]])
def test_a_radius_is_any_number_or_one_for_each_grain(radius):
    packing = Packing(POSITIONS, radius)
    assert packing.radii.shape == (len(POSITIONS),) and (packing.radii == np.ravel(radius)[0]).all()


def test_arrays_are_copied_and_then_nobody_writes_them():
    mine = np.asfortranarray(POSITIONS.astype(np.float32))
    packing = Packing(mine, 0.5)
    mine[0] = 99.0
    assert packing.positions[0, 0] != 99.0 and packing.positions.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        packing.positions[0] = 0.0
    own = POSITIONS.copy()
    Packing(own, 0.5)
    own[0] = 1.0  # the caller's stays writable


def with_nan(positions):
    positions = positions.copy()
    positions[3, 1] = np.nan
    return positions


def one_thread_until(time):
    return drain(PACKING, BOX, opening(), beads(), time)


@pytest.mark.parametrize("make, text", [
    (lambda: Drainage(Packing(np.zeros((0, 3)), 0.5), BOX, opening(), beads()), "no grains"),
    (lambda: Drainage(Packing(with_nan(POSITIONS), 0.5), BOX, opening(), beads()), "grain 4"),
    (lambda: Drainage(Packing(POSITIONS + (1.0, 0, 0), 0.5), BOX, opening(), beads()), "overlaps a wall by|outside the container"),
    (lambda: Drainage(Packing(0.9 * POSITIONS + (0, 0, 1), 0.5), BOX, opening(), beads()), "overlap by 0"),
    (lambda: Drainage(Packing(POSITIONS, 0.5, ids=np.ones(len(POSITIONS), int)), BOX, opening(), beads()), "1"),
    (lambda: Drainage(PACKING, BOX, [], beads()), "outlet"),
    (lambda: Drainage(PACKING, BOX, opening() + opening(), beads()), "overlap"),
    (lambda: Drainage(PACKING, BOX, [Outlet.round((0, 0, 0), 2.0, outflow=1.0)], beads()), "orifice radius is 2 "),
    (lambda: Drainage(PACKING, BOX, [Outlet.round((6, 0, 0), 4.0, outflow=1.0)], beads()), "beyond|wider"),
    (lambda: Drainage(PACKING, BOX, opening(0.0), beads()), "births|injection|rate"),
    (lambda: Drainage(PACKING, BOX, opening(), beads(influence=-1.0)), "-1"),
    (lambda: Drainage(PACKING, BOX, opening(), beads(alpha=np.nan)), "nan"),
    (lambda: Drainage(PACKING, BOX, opening(), beads(), threads=0), "threads.* 0 "),
    (lambda: Drainage(PACKING, BOX, opening(), beads(), window=-0.1), "window .*-0.1"),
    (lambda: Drainage(PACKING, BOX, opening(), beads(), outlet_height=np.nan), "nan"),
    (lambda: Drainage(PACKING, BOX, opening(), Parameters.glass_beads(0.003, 1.0)), "diameter 0.003 but"),
    (lambda: Drainage(PACKING, BOX, opening(), beads()).advance_to(np.inf), "time is inf"),
    (lambda: Drainage(PACKING, BOX, opening(), beads()).advance_to(1.0, every=0.0), "every is 0"),
    (lambda: one_thread_until(1.0).advance_to(0.5), "time is 0.5 but it is 1 already"),
    (lambda: beads(seed=-1), "seed cannot be -1"),
    (lambda: beads(speed="fast"), "speed cannot be 'fast'"),
    (lambda: Parameters.glass_beads(0.0, 1.0), "diameter is 0"),
    (lambda: Parameters.glass_beads(1.0, -1.0), "tau is -1"),
    (lambda: beads(friction=0.5), "no parameter 'friction'"),
    (lambda: beads(profile="square"), "profile is 'square' but must be one of"),
    (lambda: Outlet.round((0, 0, 0), 4.0), "one of 'outflow', 'births' and 'gravity'"),
    (lambda: Outlet.round((0, 0, 0), 4.0, outflow=1.0, births=2.0), "one of 'outflow'"),
    (lambda: Drainage(PACKING, BOX, [Outlet.round((-4, 0, 0), 2.0, outflow=1.0), Outlet.round((4, 0, 0), 2.0, births=2.0)],
                      beads()), "'births' for all outlets or for none"),
    (lambda: Outlet.round((0, 0, 0), 4.0, outflow=-3.0), "outflow is -3"),
    (lambda: Outlet.round((0, 0, 0), -4.0, outflow=3.0), "-4"),
    (lambda: Outlet.slot((0, 0, 0), (4.0, 0.0), outflow=3.0), " 0 "),
    (lambda: opening(schedule=[(2.0, 1.0), (1.0, 1.0)]), "time 1 but"),
    (lambda: Walls.box((-8, 8), (-5, 5), periodic="z"), "periodic is 'z'"),
    (lambda: Drainage(PACKING, Walls.box((8, -8), (-5, 5)), opening(), beads()), "8 and -8"),
    (lambda: Shape.block((0, 0, 0), (1, -1, 1)), "-1"),
    (lambda: Shape.cone((0, 0, 0), 2.0, (0, 0, 1), 2.0), "2"),
    (lambda: Shape.half_space((0, 0, 0), (0, 0, 0)), "0"),
    (lambda: lattice((0, 0, 0), (1, 1, 1), 0.0), "diameter is 0"),
])
def test_bad_input_is_refused_by_name(make, text):
    with pytest.raises(ValueError, match=text):
        make()


def test_a_lattice_touches_nothing():
    from scipy.spatial import cKDTree
    for high in ((3.0, 4.5, 7.7), (1.0, 1.0, 1.0), (2.1599, 6.3, 1.58)):
        points = lattice((0, 0, 0), high, 1.0)
        assert (points >= 0.5 - 1e-12).all() and (points <= np.array(high) - 0.5 + 1e-12).all()
        assert len(points) == 1 or cKDTree(points).query(points, 2)[0][:, 1].min() >= 1.0
    assert len(lattice((0, 0, 0), (0.9, 2, 2), 1.0)) == 0
