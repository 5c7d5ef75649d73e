# SPDX-License-Identifier: GPL-2.0-or-later
"""run.sh around its programs, which are played by short scripts: what it removes, when it stops, what it checks."""

import os
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from lammps_runs import ROOT

sys.path.insert(0, str(ROOT / "tests" / "analysis"))
from synthetic import binary_frame  # noqa: E402  (beside this folder)

TAU = (0.003 / 9.81)**0.5
# Plays lmp: writes the files that the test has laid ready to the folder after `out`.
LMP = """#!/bin/sh
while [ "$1" != out ]; do shift; done
mkdir -p "$2" && cp ../../ready/* "$2"
"""


@pytest.fixture
def checkout(tmp_path):
    """run.sh and what it calls; results of an earlier run."""
    for name in ("run.sh", "scripts/check_snapshots.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    script(tmp_path / "scripts" / "install-packages.sh", "#!/bin/sh\n")
    script(tmp_path / "scripts" / "build.sh", "#!/bin/sh\n")
    script(tmp_path / "scripts" / "python.sh", f"#!/bin/sh\necho {sys.executable}\n")
    script(tmp_path / "build" / "bin" / "lmp", LMP)
    (tmp_path / "examples" / "silo").mkdir(parents=True)
    (tmp_path / "analysis").mkdir()
    (tmp_path / "analysis" / "compare.py").write_text("print('compared')\n")
    (tmp_path / "analysis" / "spot_analysis").symlink_to(ROOT / "analysis" / "spot_analysis")
    (tmp_path / "ready").mkdir()
    for old in ("report.html", "comparison.json", "log.lammps", "dumps/drain.88.dump.bin"):
        (tmp_path / "results" / "silo" / old).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "results" / "silo" / old).write_text("old")
    return tmp_path


def script(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)


def snapshot():
    ids = np.arange(1.0, 21.0)
    return binary_frame(0, {"id": ids, "x": 0 * ids, "y": 0 * ids, "z": ids})


def lay_ready(checkout, snapshots):
    for k, data in enumerate(snapshots):
        (checkout / "ready" / f"drain.{4 * k}.dump.bin").write_bytes(data)


def run_script(checkout, time):
    return subprocess.run([checkout / "run.sh", "--time", f"{time:.9g}"], capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize("time, snapshots", [(4 * TAU, 3), (4.1 * TAU, 4), (0.1, 4), (0.06, 3), (1.57, 46)])
def test_whole_run(checkout, time, snapshots):
    """Snapshots of the start and of every 2 tau, up to the time or beyond; nothing is left of an earlier run."""
    lay_ready(checkout, snapshots * [snapshot()])
    done = run_script(checkout, time)
    assert done.returncode == 0 and done.stdout.endswith("compared\n"), done.stdout + done.stderr
    left = sorted(str(path.relative_to(checkout / "results")) for path in (checkout / "results").rglob("*.*"))
    assert left == sorted(f"silo/dumps/drain.{4 * k}.dump.bin" for k in range(snapshots))


def cut_last_byte(path):
    path.write_bytes(path.read_bytes()[:-1])


def cut_header(path):
    path.write_bytes(path.read_bytes()[:30])


def empty(path):
    path.write_bytes(b"")


def damage(path):
    path.write_bytes(b"no dump" + path.read_bytes())


def remove(path):
    path.unlink()


@pytest.mark.parametrize("spoil", [cut_last_byte, cut_header, empty, damage, remove], ids=lambda f: f.__name__)
def test_snapshot_that_is_not_whole(checkout, spoil):
    """As on a full disk, where LAMMPS ends as if all were well."""
    lay_ready(checkout, 3 * [snapshot()])
    spoil(checkout / "ready" / "drain.8.dump.bin")
    done = run_script(checkout, 4 * TAU)
    assert done.returncode == 1 and "compared" not in done.stdout
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ") and ("2 snapshots instead of 3" if spoil is remove else "drain.8.dump.bin") in line
    assert line.endswith("is the disk full?")


# A shell goes on if what it waits for ends well when the signal comes: so none waits when "started" is there, or has a trap.
@pytest.mark.parametrize("program", [": >started\nexec sleep 60\n",
                                     "trap 'exit 0' INT\n: >started\nfor k in {1..600}; do sleep 0.1; done\n"],
                         ids=["ends by it", "ends well after it"])
def test_interrupt(checkout, program):
    """Ctrl-C, which all processes of the terminal get, ends the script, too, whatever the program makes of it."""
    script(checkout / "build" / "bin" / "lmp", f"#!/bin/bash\n{program}")
    process = subprocess.Popen([checkout / "run.sh"], stdout=subprocess.PIPE, text=True, start_new_session=True,
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
    started = checkout / "examples" / "silo" / "started"
    deadline = time.monotonic() + 60
    while not started.exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    said, _ = process.communicate(timeout=50)
    assert process.returncode == -signal.SIGINT and "compared" not in said and "Comparing" not in said
