# SPDX-License-Identifier: GPL-2.0-or-later
"""Every mistake ends in one error that names the offending word and says what is allowed."""

import shutil

import numpy as np
import pytest

from lammps_runs import (DISTRIBUTION, FIX, FRONT_END, LOAD_SPOT, OPENING, PLUGIN, RATES, WALLS, deck, error_of, lattice,
                         needs_distribution, needs_mpirun, on_ranks, programs, run, run_ok, write_data)

COMPLETE = {"walls": WALLS, "orifice": OPENING, "influence": "influence 1e-2", "speed": "speed 3.2",
            "injection": "injection 100"}


def fix(*more, **parts):
    """The complete command with parts replaced (None leaves one out), and more words after it."""
    return " ".join(["fix drain all spot", *filter(None, {**COMPLETE, **parts}.values()), *map(str, more)])


def has(error, *words):
    for word in words:
        assert word in error, error


@programs
def test_missing_walls(tmp_path, program):
    has(error_of(deck(fix(walls=None)), tmp_path, program=program), "keyword 'box' is missing", "cylinder x y radius", "region ID")


@pytest.mark.parametrize("keyword, named", [("orifice", "orifice"), ("speed", "speed"), ("injection", "outflow")])
def test_missing_keyword(tmp_path, keyword, named):
    has(error_of(deck(fix(**{keyword: None})), tmp_path), f"keyword '{named}' is missing")


@pytest.mark.parametrize("words, said", [
    ("inflence 1e-2", ["unknown keyword 'inflence'", "influence injection"]),
    ("7", ["2 rates but there is 1 outlet: give one"]),
    ("schedule 1 0 0", ["'schedule 1' is 0 from time 0 on", "must be positive"]),
    ("injection 1e6", ["'injection' has 1000000 births of spots per time", "at most 347.", "fit into the simulation box"]),
    ("seed 1 7", ["unknown keyword '7'"]),
    ("dz", ["'dz' ends before its value"]),
    ("buffer 1", ["'buffer' ends before its value", "base"]),
    ("radius 2.6d", ["'2.6d' is not a finite number", "'radius'"]),
    ("speed nan", ["'nan' is not a finite number", "'speed'"]),
    ("injection inf", ["'inf' is not a finite number", "'injection'"]),
    ("injection 0", ["'injection' is 0", "must be positive"]),
    ("speed -3.2", ["'speed' is -3.2", "must be positive"]),
    ("radius -1", ["'radius' is -1", "must be positive"]),
    ("influence 0", ["'influence' is 0", "must be positive"]),
    ("influence 1.5", ["influence is 1.5", "below 1"]),
    ("diffusion -1", ["'diffusion' is -1", "must be positive"]),
    ("dz 0", ["'dz' is 0", "must be positive"]),
    ("seed 1.5", ["'1.5' after keyword 'seed'", "whole number, 1 or more"]),
    ("seed -1", ["'-1' after keyword 'seed'", "whole number, 1 or more"]),
    ("buffer -1 1", ["'buffer' is -1", "zero or positive"]),
    ("shell -1", ["'shell' is -1", "zero or positive"]),
    ("alpha 2", ["alpha is 2", "below 2"]),
    ("overlap 0", ["'overlap' is 0", "must be positive"]),
    ("average 0", ["'0' after keyword 'average'", "1 or more"]),
    ("relax often", ["'relax often' is not known", "'relax tol delta'", "'relax never'", "'chance'"]),
    ("relax chance", ["'relax' ends before its value"]),
    ("relax spot 0", ["'0' after keyword 'relax'", "1 or more"]),
    ("relax tol -1", ["'relax' is -1", "must be positive"]),
    ("accuracy high", ["'accuracy high' is not known", "'exact' or 'fast' or 'normal'"]),
    ("persistence 1", ["persistence is 1 ", "below 1"]),
    ("dilation 1", ["dilation is 1 ", "from 0 (off) to below 1"]),
    ("dilation 0.5 steps together", ["dilation is 0.5 ", "must be 0 for spots that step together"]),
    ("volume 77 critical 0.58", ["'critical' ends before its value"]),
    ("volume 77 critical -0.58 1", ["'critical' is -0.58", "zero or positive"]),
    ("volume 77 critical 0.58 0", ["'critical' is 0", "must be positive"]),
    ("volume 77 critical 0.3 1", ["critical packing fraction is 0.3 ", "0 (off) or from 0.5 to 0.7"]),
    ("volume 77 critical 0.58 1e-3 dz 0.4", ["exchange length is 0.001 ", "at least 0.1 of the spots' step height, 0.4"]),
    ("critical 0.58 1", ["critical packing fraction is 0.58 ", "spots carry no fixed volume"]),
    ("nonaffine 0.6 1", ["non-affine motion is 0.6 ", "from 0 (off) to 0.5"]),
    ("dilatancy -1", ["'dilatancy' is -1", "zero or positive"]),
    ("full_strain -1", ["'full_strain' is -1", "zero or positive"]),
    ("volume 77 full_strain 0.2", ["strain of full exchange is 0.2 ", "needs a critical packing fraction"]),
    ("volume 77 critical 0.5 1 full_strain 2", ["strain of full exchange is 2 ", "at most 0.849858357, three over the spot radius"]),
    ("volume 77 dilatancy 0.1", ["dilatancy is 0.1 ", "needs a critical packing fraction"]),
    ("spread -1 0.7", ["'spread' is -1", "zero or positive"]),
    ("spread 0.6 0.7", ["spread is 0.6 ", "no fixed volume"]),
    ("volume 77 spread 2.1 0.7", ["spread is 2.1 ", "from 0 (off) to 2"]),
    ("volume 77 spread 0.6 5", ["shear by walls is 5 ", "from 0 to 4"]),
    ("volume 77 spread 0.6 0.7 persistence 0.2", ["spread is 0.6 ", "persistence, 0.2"]),
    ("volume 77 critical 0.5 1 dilatancy 1.2", ["dilatancy is 1.2 ", "at most a third of the spot radius"]),
    ("steps apart", ["'steps apart' is not known", "'poisson' or 'together'"]),
    ("momentum -1", ["'momentum' is -1", "zero or positive"]),
    ("contact -1", ["'contact' is -1", "zero or positive"]),
    ("contact 0.1", ["overlap in contact is 0.1 ", "from 0 to 0.05"]),
    ("closing 0.06 0.1", ["gap that is closed is 0.06 ", "from 0 (off) to 0.05"]),
    ("closing 0.004 1.5", ["share by which gaps are closed is 1.5 ", "from 0 (off) to 1"]),
    ("closing -0.004 0.1", ["'closing' is -0.004", "zero or positive"]),
    ("momentum 1", ["momentum is 1 ", "below 1"]),
    ("volume -1", ["'volume' is -1", "zero or positive"]),
    ("threads 0", ["'0' after keyword 'threads'", "1 or more"]),
    ("threads 257", ["number of threads is 257 ", "from 1 to 256"]),
    ("relax every 0", ["'0' after keyword 'relax'", "1 or more"]),
    ("strength 0.5", ["'strength 0.5' is not known", "'half'", "'full'"]),
    ("window 0", ["'window' is 0", "must be positive"]),
    ("window 0.03", ["timestep 0.1", "whole number of windows of 0.03"]),
    ("window 0.2", ["timestep 0.1", "whole number of windows of 0.2"]),
    ("window 1e-300", ["timestep 0.1", "whole number of windows"]),
    ("cylinder 0 0 4", ["only one of 'box', 'cylinder', 'region' and 'walls'"]),
    ("region silo", ["only one of 'box', 'cylinder', 'region' and 'walls'"]),
    ("outlet 0.5", ["outlet is at z = 0.5", "not above the orifice, 0"]),
    ("outlet -5.3", ["outlet is at z = -5.3", "simulation box begins at -4"]),
    ("radius 1.2 dz 0.1 outlet -2.5", ["outlet is at z = -2.5", "must be above -2.35", "reach of newborn spots"]),
    ("profile round", ["'profile round' is not known", "'parabolic' or 'uniform'"]),
    ("profile uniform radius 3.1", ["orifice radius is 3 ", "at least the spot radius, 3.1"]),
    ("radius 4.2", ["orifice radius is 3 ", "at least the spot radius, 3.09"]),
    ("buffer 5 1", ["walls along y are 8 apart", "at least 10"]),
], ids=lambda value: value if isinstance(value, str) else "")
def test_value(tmp_path, words, said):
    has(error_of(deck(fix(words), run="run 1"), tmp_path), "fix spot", *said)


@pytest.mark.parametrize("parts, said", [
    ({"walls": "box 5 -5 -4 4"}, ["walls along x", "increasing order"]),
    ({"walls": "box -6 6 -4 4"}, ["walls along x, at -6 and 6", "simulation box, from -5 to 5"]),
    ({"walls": "cylinder 0 0 4.5"}, ["walls along y, at -4.5 and 4.5", "simulation box"]),
    ({"walls": "cylinder 0 0 0"}, ["cylinder's radius must be positive"]),
    ({"walls": "cylinder 0 0 2.8"}, ["wider than the base of radius 2.8"]),
    ({"orifice": "orifice 0 0 0 4.5"}, ["orifice of radius 4.5", "wider than the base", "y from -4 to 4"]),
    ({"orifice": "orifice 3 0 0 3"}, ["wider than the base", "x from -5 to 5"]),
    ({"orifice": "orifice 0 0 0 2"}, ["orifice radius is 2 ", "at least the spot radius, 2.6"]),
    ({"orifice": "orifice 0 0 3"}, ["'influence' is not a finite number", "'orifice'"]),
    ({"walls": "region silo"}, ["region 'silo' does not exist"]),
    ({"walls": "walls add block -5 5 -4 4 0 19 buffer 3 2"},
     ["buffer of spots from side walls is 3 ", "must be below 3,", "orifice of radius 3"]),
    ({"walls": "walls add block -5 5 -4 4 0 19 walls cut block -5 5 -4 4 0 19"}, ["does not open", "walls leave no inside"]),
    ({"walls": "walls add mesh silo.stl"}, ["'walls add mesh'", "no walls of triangles", "'cone'"]),
    ({"injection": "outflow 1e7"}, ["'outflow' has 10000000 grains per time", "at most", "fit into the simulation box"]),
], ids=lambda value: " ".join(value.values()) if isinstance(value, dict) else "")
def test_geometry(tmp_path, parts, said):
    has(error_of(deck(fix(**parts), run="run 1"), tmp_path), "fix spot", *said)


BLOCK = "region silo block -5 5 -4 4 0 19 open 5"


def test_buffer_as_wide_as_the_orifice_in_a_region(tmp_path):
    error = error_of(deck(fix("buffer 3.5 2", walls="region silo"), before=BLOCK), tmp_path)
    has(error, "buffer of spots from side walls is 3.5 ", "must be below 3,", "orifice of radius 3")


def test_region_deleted_between_runs(tmp_path):
    error = error_of(deck(fix(walls="region silo"), before=BLOCK, run="run 2\nregion silo delete\nrun 2"), tmp_path)
    has(error, "region 'silo' does not exist")


def test_region_that_moves(tmp_path):
    moving = "variable push equal 0.1*elapsed\n" + BLOCK + " move v_push NULL NULL"
    has(error_of(deck(fix(walls="region silo"), before=moving), tmp_path), "region 'silo' moves", "not supported")


def test_region_without_the_orifice(tmp_path):
    has(error_of(deck(fix(walls="region silo"), before="region silo block -5 5 -4 4 1 19 open 5"), tmp_path),
        "the orifice of radius 3 at (0, 0, 0)", "outside region 'silo'")


def test_grain_outside_a_region_with_an_open_face(tmp_path):
    """LAMMPS says that everything is inside such a region."""
    has(error_of(deck(fix(walls="region silo"), before="region silo block -4 4 -4 4 0 19 open 5"), tmp_path),
        "grain ", "is outside the container")


def test_two_fixes(tmp_path):
    has(error_of(deck(fix() + "\n" + fix().replace("drain", "again", 1)), tmp_path), "only one fix spot")


def test_atom_style_without_radius(tmp_path):
    text = f"units lj\ninclude {LOAD_SPOT}\nboundary f f f\nregion all block -5 5 -4 4 -4 20\ncreate_box 1 all\n{fix()}\n"
    has(error_of(text, tmp_path), "needs grains with a radius", "atom_style sphere")


def test_grains_without_ids(tmp_path):
    text = (f"atom_style sphere\natom_modify id no\nboundary f f f\ninclude {LOAD_SPOT}\nregion all block -5 5 -4 4 -4 10\n"
            f"create_box 1 all\ncreate_atoms 1 single 0 0 1\nset type 1 diameter 1\n{fix()}\nrun 1\n")
    has(error_of(text, tmp_path), "needs grains with IDs", "atom_modify id no")


@pytest.mark.parametrize("grain", [-3, 0])
def test_ids_are_positive(tmp_path, grain):
    """LAMMPS itself asks for that."""
    points = lattice()
    write_data(tmp_path / "packing.data", points, ids=[grain, *range(2, len(points) + 1)])
    has(error_of(deck(fix()), tmp_path), "Invalid atom ID")


def test_before_the_box(tmp_path):
    has(error_of(f"atom_style sphere\ninclude {LOAD_SPOT}\n{fix()}\n", tmp_path), "before simulation box is defined")


@pytest.mark.parametrize("before, said", [
    ("set atom 17 diameter 2.1", ["diameters from 1.05 to 2.1, the largest", "grain ", " has 1"]),
    ("set atom 17 diameter 0.49", ["diameters from 0.5 to 1, the largest", "grain 17 has 0.49"]),
    ("set group all diameter 0", ["no diameter"]),
    ("variable none atom (1e300*1e300)-(1e300*1e300)\nset atom 17 x v_none", ["position of grain 17 is not finite"]),
    ("set atom 17 z -1.5", ["grain 17 at (", "-1.5) is outside the container"]),
    ("delete_atoms group all", ["there are no grains"]),
    ("change_box all triclinic", ["triclinic box"]),
], ids=lambda value: value.splitlines()[-1] if isinstance(value, str) else "")
def test_grains(tmp_path, before, said):
    has(error_of(deck(fix(), before=before, run="run 1"), tmp_path), *said)


def overlapping(folder):
    points = lattice()
    points[40] = points[39] + (0, 0, 0.9)  # to 1e-7: positions are multiples of the quantum
    write_data(folder / "packing.data", points[[*range(40), 40]])


def test_overlap_at_the_start(tmp_path):
    overlapping(tmp_path)
    has(error_of(deck(fix()), tmp_path), "grains 40 and 41 overlap by 0.09999", "diameters", "at most 0.03 is allowed")


def test_overlap_at_the_start_is_settable(tmp_path):
    overlapping(tmp_path)
    run_ok(deck(fix("overlap 0.11"), run="run 1"), tmp_path)
    has(error_of(deck(fix("overlap 0.09"), run="run 1"), tmp_path), "at most 0.09 is allowed")


def test_grain_at_the_wall(tmp_path):
    write_data(tmp_path / "packing.data", [(4.75, 0, 3)], box=(-6, 6, -5, 5, -4, 20))
    has(error_of(deck(fix(walls="box -4.5 4.5 -4 4")), tmp_path), "grain 1 at (4.75, 0, 3) is outside the container")


@pytest.mark.parametrize("boundary, said", [
    ("f f p", ["lower boundary in z is periodic", "boundary f f f"]),
    ("s f f", ["lower boundary in x is shrink-wrapped"]),
    ("f f s", ["lower boundary in z is shrink-wrapped", "boundary f f f"]),
    ("f f fm", ["upper boundary in z is shrink-wrapped"]),
])
def test_boundary(tmp_path, boundary, said):
    has(error_of(deck(fix(), boundary=boundary), tmp_path), *said)


def test_two_dimensions(tmp_path):
    text = (f"dimension 2\natom_style sphere\ninclude {LOAD_SPOT}\nregion all block -5 5 -4 4 -0.5 0.5\n"
            f"create_box 1 all\n{fix()}\n")
    has(error_of(text, tmp_path), "3 dimensions")


def test_respa(tmp_path):
    has(error_of(deck(fix(), after="run_style respa 2 2"), tmp_path), "run_style respa")


def test_minimize(tmp_path):
    text = deck(fix(), after="pair_style zero 1.0\npair_coeff * *", run="minimize 0 0 1 1")
    has(error_of(text, tmp_path), "does not work with minimize")


@needs_mpirun
@programs
def test_order_of_time_on_two_ranks(tmp_path, program):
    has(error_of(deck(fix("accuracy exact")), tmp_path, program=program, launcher=on_ranks(2)),
        "1 MPI rank, not on 2", "relax tol")


@needs_mpirun
def test_error_on_one_rank_ends_all(tmp_path):
    """A grain outside the walls is known to the rank that owns its layer only."""
    write_data(tmp_path / "packing.data", np.append(lattice(), [[4.0, 3.0, -0.3]], axis=0))
    said = run(deck(fix()), tmp_path, launcher=on_ranks(3))
    assert said.returncode != 0
    has(said.stdout + said.stderr, "is outside the container")


@needs_distribution
def test_plugin_that_is_not_there(tmp_path):
    done = run(deck(), tmp_path, program=DISTRIBUTION, SPOT_PLUGIN="/nowhere/spotplugin.so")
    assert done.returncode != 0
    has(done.stderr, "ERROR: cannot load /nowhere/spotplugin.so", "set SPOT_PLUGIN")


@needs_distribution
def test_plugin_not_loaded(tmp_path):
    has(error_of(deck().replace("include", "#"), tmp_path, program=DISTRIBUTION), "Unrecognized fix style 'spot'")


@needs_distribution
def test_plugin_of_another_name_and_relative_path(tmp_path):
    """The variable names any file, also relative to where lmp is started."""
    shutil.copy(PLUGIN, tmp_path / "other.so")
    done = run(deck(run="run 1"), tmp_path, program=DISTRIBUTION, SPOT_PLUGIN="other.so")
    assert done.returncode == 0, done.stdout + done.stderr


def test_option_that_lmp_does_not_know(tmp_path):
    has(error_of(deck(), tmp_path, launcher=[FRONT_END, "-nonsense"]), "Invalid command-line argument")


@pytest.mark.parametrize("words, said", [
    ("threads 0", ["for fix spot: '0' after keyword 'threads'", "1 or more"]),
    ("threads", ["'threads' ends before its value"]),
    ("seed 2", ["unknown keyword 'seed'; only 'threads' can be changed"]),
    ("bodyforces late", ["unknown keyword 'bodyforces'"]),
    ("threads 2 speed 3", ["unknown keyword 'speed'"]),
    ("energy yes", ["fix_modify"]),
    ("virial yes", ["fix_modify"]),
    ("respa 1", ["fix_modify"]),
    ("", ["Illegal fix_modify command"])])
def test_fix_modify(tmp_path, words, said):
    has(error_of(deck(fix(), after=f"fix_modify drain {words}"), tmp_path), *said)


def test_fix_modify_threads_beyond_the_most(tmp_path):
    for when in ({"after": "fix_modify drain threads 257"}, {"run": "run 1\nfix_modify drain threads 257\nrun 1"}):
        has(error_of(deck(fix(), **when), tmp_path), "number of threads is 257 ", "from 1 to 256")
