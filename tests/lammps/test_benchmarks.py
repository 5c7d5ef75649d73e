# SPDX-License-Identifier: GPL-2.0-or-later
"""The deck of the benchmarks, run by the real lmp from rest, and gone on with from a restart file, as they do both."""

import sys

import pytest

from lammps_runs import FRONT_END, ROOT

sys.path.insert(0, str(ROOT / "benchmarks"))
import measuring  # noqa: E402  (beside this folder)


@pytest.fixture(scope="module")
def from_rest(tmp_path_factory):
    folder = tmp_path_factory.mktemp("from-rest")
    deck = measuring.spot_deck() + f"write_restart {folder / 'state'}\n"
    return measuring.run_spot("from rest", FRONT_END, folder, deck, warm_up=2, measure=4)


def test_only_what_is_between_snapshots_is_timed(from_rest):
    assert [last.step - first.step for first, last in from_rest.pairs] == [3, 3]
    assert from_rest.interval == pytest.approx((2, 6))
    assert from_rest.rate("moves") > 0 and from_rest.spots() > 0
    assert len(list(from_rest.folder.glob("spot.*.dump"))) == 3


def test_going_on_from_a_restart_file(from_rest, tmp_path):
    deck = measuring.spot_deck(restart=from_rest.folder / "state")
    again = measuring.run_spot("going on", FRONT_END, tmp_path, deck, warm_up=0, measure=2)
    assert again.interval == pytest.approx((6, 8))
    assert again.spots() > from_rest.spots()
