# SPDX-License-Identifier: GPL-2.0-or-later
"""The last snapshots of small scenes are what they have always been, bit for bit, on one and three ranks."""

import hashlib
import pathlib

import numpy as np
import pytest

from lammps_runs import BOX, FIX, OPENING, RATES, LOAD_SPOT, deck, lattice, needs_mpirun, on_ranks, run_ok, run_text, write_data
from test_come_and_go import CHANGES

CHECKSUMS = pathlib.Path(__file__).with_name("dumps.sha256")  # record_checksums.py writes it
STEPS = 30
# The fix as the example of a silo has it, at the small one's rates.
ALL = FIX + " profile parabolic volume 77 dilation 0.03 persistence 0.3"
REGION = ("region floor block -5 5 -4 4 0 19\nregion pipe cylinder z 0 0 3 -4 1e-3\n"
          "region silo union 2 floor pipe")


def one_run(folder, ranks, points=None, **parts):
    write_data(folder / "packing.data", lattice() if points is None else points, box=BOX[:5] + (60.0,))
    run_ok(deck(**{"run": f"run {STEPS}", **parts}), folder, launcher=on_ranks(ranks))


def cylinder(folder, ranks):
    one_run(folder, ranks, lattice(lambda x, y, z: np.hypot(x, y) <= 3.5),
            fix=f"fix drain all spot cylinder 0 0 4 {OPENING} {RATES} seed 1")


def region(folder, ranks):
    one_run(folder, ranks, before=REGION, fix=f"fix drain all spot region silo {OPENING} {RATES} seed 1")


def restarts(folder, ranks):
    """So many ranks, then 4 less than that, then so many again; each goes on from the restart file before it."""
    one_run(folder, ranks, fix=ALL, run="run 7\nwrite_restart a.restart")
    for before, after, end, on in ("a", "b", 13, 4 - ranks), ("b", "c", STEPS, ranks):
        text = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart {before}.restart\n"
        run_ok(text + run_text(ALL, f"run {end} upto\nwrite_restart {after}.restart"), folder, launcher=on_ranks(on))


def come_and_go(folder, ranks):
    between = "\nrun 5\n".join(CHANGES[name] for name in ("create_atoms", "displace_atoms", "delete_atoms"))
    one_run(folder, ranks, fix=ALL, run=f"run 10\n{between}\nrun {STEPS - 20}")


# With what spots leave behind: spots climb to where they do so in the silo's 10 d.
# The lattice is looser than any set point, but too low for spots of this radius to tell.
INGREDIENTS = ALL + " profile uniform radius 2.5 volume 72 critical 0.56 1 dilatancy 0.1 full_strain 0.8 persistence 0 spread 0.6 0.7 nonaffine 0.1 0.5 closing 4e-3 0.1"


def two_sizes(folder, ranks):
    points = lattice()
    write_data(folder / "packing.data", points, box=BOX[:5] + (60.0,), diameters=np.where(np.arange(len(points)) % 5, 0.6, 1.0))
    run_ok(deck(fix=ALL + " nonaffine 0.1 0.5 closing 4e-3 0.1", run=f"run {STEPS}"), folder, launcher=on_ranks(ranks))


# By name: what leaves grains.dump in the folder.
SCENES = {
    "box": lambda folder, ranks: one_run(folder, ranks),
    "box-all": lambda folder, ranks: one_run(folder, ranks, fix=ALL),
    "box-ingredients": lambda folder, ranks: one_run(folder, ranks, fix=INGREDIENTS),
    "box-fast": lambda folder, ranks: one_run(folder, ranks, fix=FIX + " accuracy fast"),
    "box-exact": lambda folder, ranks: one_run(folder, ranks, fix=FIX + " accuracy exact"),
    "cylinder": cylinder,
    "region": region,
    "restarts": restarts,
    "come-and-go": come_and_go,
    "two-sizes": two_sizes,
}


def checksum(scene, folder, ranks):
    """SHA-256 of the text of the last snapshot."""
    SCENES[scene](folder, ranks)
    last = (folder / "grains.dump").read_bytes().split(b"ITEM: TIMESTEP\n")[-1]
    assert last.startswith(b"%d\n" % STEPS)
    return hashlib.sha256(last).hexdigest()


def recorded():
    return {name: digest for digest, name in (line.split() for line in CHECKSUMS.read_text().splitlines())}


@needs_mpirun
@pytest.mark.parametrize("scene, ranks", [(scene, ranks) for scene in SCENES for ranks in (1, 3) if (scene, ranks) != ("box-exact", 3)])
def test_checksum(scene, ranks, tmp_path):
    assert checksum(scene, tmp_path, ranks) == recorded()[scene]


def test_restarts_change_nothing():
    assert recorded()["restarts"] == recorded()["box-all"]
    assert recorded().keys() == SCENES.keys()
    assert len(set(recorded().values())) == len(SCENES) - 1
