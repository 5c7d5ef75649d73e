# SPDX-License-Identifier: GPL-2.0-or-later
"""Damaged packing files on their way through LAMMPS into fix spot: a run that ends well, or an error in a line of its own
and an exit status that says so; never a crash. Seeds are fixed; SPOT_PACKINGS=n tries n random ones."""

import os

import numpy as np
import pytest

from lammps_runs import deck, lattice, run, write_data

PACKINGS = int(os.environ.get("SPOT_PACKINGS", 16))
DECK = deck(run="run 2")


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    path = tmp_path_factory.mktemp("packing") / "packing.data"
    write_data(path, lattice())
    return path.read_text()


def outcome(folder, data):
    """'ran' or the error that LAMMPS printed; anything else is a failure."""
    (folder / "packing.data").write_bytes(data)
    done = run(DECK, folder)
    said = done.stdout + done.stderr
    assert done.returncode >= 0, f"killed by signal {-done.returncode}\n{said[-2000:]}"
    assert done.returncode < 128, said[-2000:]  # a signal, as a shell or mpirun reports it
    errors = [line for line in said.splitlines() if line.startswith("ERROR")]
    if done.returncode == 0:
        assert not errors
        return "ran"
    assert len(set(errors)) == 1 and len(errors[0]) > len("ERROR: "), said[-2000:]
    return errors[0]


def lines_of(text):
    return text.splitlines(True)


def replaced(text, row, column, word):
    """The word of a grain; rows count from 0."""
    lines = lines_of(text)
    first = next(k for k, line in enumerate(lines) if line.startswith("Atoms")) + 2
    words = lines[first + row].split()
    words[column] = word
    lines[first + row] = " ".join(words) + "\n"
    return "".join(lines)


def without(text, part):
    return "".join(line for line in lines_of(text) if part not in line)


ID, TYPE, DIAMETER, DENSITY, X, Y, Z = range(7)
# What must not run; the words are some of the error's.
REFUSED = {
    "nothing": (lambda t: "", ""),
    "title alone": (lambda t: lines_of(t)[0], ""),
    "no count": (lambda t: without(t, " atoms"), ""),
    "no bounds": (lambda t: without(t, "zlo"), ""),
    "no section": (lambda t: t[:t.index("Atoms")], ""),
    "cut in a row": (lambda t: t[:len(t) * 2 // 3], ""),
    "doubled id": (lambda t: replaced(t, 5, ID, "1"), ""),
    "id 0": (lambda t: replaced(t, 5, ID, "0"), ""),
    "negative id": (lambda t: replaced(t, 5, ID, "-3"), ""),
    "id no number": (lambda t: replaced(t, 5, ID, "six"), ""),
    "x nan": (lambda t: replaced(t, 5, X, "nan"), ""),
    "y inf": (lambda t: replaced(t, 5, Y, "inf"), ""),
    "z no number": (lambda t: replaced(t, 5, Z, "1.0.0"), ""),
    "z 1e308": (lambda t: replaced(t, 5, Z, "1e308"), ""),
    "diameter 0": (lambda t: replaced(t, 5, DIAMETER, "0"), ""),
    "diameter nan": (lambda t: replaced(t, 5, DIAMETER, "nan"), ""),
    "diameter another": (lambda t: replaced(t, 5, DIAMETER, "0.49"), "grains may have diameters from 0.5 to 1"),
    "negative diameter": (lambda t: replaced(t, 5, DIAMETER, "-1"), ""),
    "density 0": (lambda t: replaced(t, 5, DENSITY, "0"), ""),
    "type 2": (lambda t: replaced(t, 5, TYPE, "2"), ""),
    "on another": (lambda t: replaced(replaced(replaced(t, 5, X, "0.1"), 5, Y, "0.05"), 5, Z, "1.518"), "overlap by"),
    "in the wall": (lambda t: replaced(t, 5, X, "5.0"), ""),
    "below the base": (lambda t: replaced(t, 5, Z, "-3.9"), "outside the container"),
    "fewer grains than said": (lambda t: "".join(lines_of(t)[:-3]), ""),
    "no grains": (lambda t: t[:t.index("Atoms")].replace("629 atoms", "0 atoms"), ""),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused(tmp_path, text, case):
    damage, said = REFUSED[case]
    damaged = damage(text)
    assert damaged != text
    error = outcome(tmp_path, damaged.encode())
    assert error != "ran" and said in error, error


def test_undamaged(tmp_path, text):
    assert outcome(tmp_path, text.encode()) == "ran"


def test_lines_after_the_last_grain_are_not_read(tmp_path, text):
    assert outcome(tmp_path, (text + "9999 1 1 1 0 0 15\n").encode()) == "ran"


def damaged_at_random(text, rng):
    data = bytearray(text.encode())
    how = rng.integers(4)
    if how == 0:
        return bytes(data[:rng.integers(len(data))])
    if how == 1:
        for at in rng.integers(len(data), size=3):
            data[at] = rng.integers(256)
        return bytes(data)
    lines = lines_of(text)
    one, other = rng.integers(len(lines), size=2)
    if how == 2:
        del lines[one]
    else:
        lines[one], lines[other] = lines[other], lines[one]
    return "".join(lines).encode()


def test_damaged_at_random(tmp_path, text):
    rng = np.random.default_rng(2006)
    outcomes = [outcome(tmp_path, damaged_at_random(text, rng)) for _ in range(PACKINGS)]
    assert sum(one != "ran" for one in outcomes) > PACKINGS / 4
