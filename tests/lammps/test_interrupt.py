# SPDX-License-Identifier: GPL-2.0-or-later
"""Ctrl-C ends lmp, though load_spot.lmp starts LAMMPS' Python, which has its own idea of that."""

import os
import signal
import subprocess

import pytest

from lammps_runs import LOAD_SPOT, PLUGIN, deck, lattice, needs_distribution, programs, write_data

# A program of the Python that the distribution's LAMMPS is linked with; it runs LAMMPS in its only thread or in another.
DRIVER = """
import ctypes, signal, sys, threading
library = ctypes.CDLL("liblammps.so.0", mode=ctypes.RTLD_GLOBAL)
library.lammps_open_no_mpi.restype = ctypes.c_void_p
library.lammps_file.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
def load():
    arguments = (ctypes.c_char_p * 5)(b"lmp", b"-log", b"none", b"-screen", b"none")
    library.lammps_file(library.lammps_open_no_mpi(5, arguments, None), sys.argv[2].encode())
worker = threading.Thread(target=load)
if sys.argv[1] == "another":
    worker.start(); worker.join()
else:
    load()
print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


@pytest.fixture
def start(tmp_path):
    """Starts a program on a run of hours, with Ctrl-C heeded or ignored; the process, when the run has begun."""
    processes = []

    def start_with(program, handler):
        write_data(tmp_path / "packing.data", lattice())
        (tmp_path / "in.deck").write_text(deck(run="run 2000000000", after="thermo 1\nthermo_modify flush yes\nundump grains"))
        processes.append(subprocess.Popen([program, "-in", "in.deck", "-log", "none", "-nocite"], cwd=tmp_path, stdout=subprocess.PIPE,
                                          text=True, env={**os.environ, "SPOT_PLUGIN": PLUGIN},
                                          preexec_fn=lambda: signal.signal(signal.SIGINT, handler)))
        wait_for_steps(processes[-1], 3)
        return processes[-1]

    yield start_with
    for process in processes:
        process.kill()
        process.wait()
        process.stdout.close()


def wait_for_steps(process, number):
    """Read on for so many lines of thermo output."""
    for line in process.stdout:
        words = line.split()
        number -= len(words) > 3 and words[0].isdigit() and words[1].isdigit()
        if number == 0:
            return
    raise AssertionError("the run ended")


@programs
def test_interrupt_ends_lmp(start, program):
    process = start(program, signal.SIG_DFL)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == -signal.SIGINT


@programs
def test_ignored_interrupt_stays_ignored(start, program):
    """As a shell has it for what it starts with `&` in a script."""
    process = start(program, signal.SIG_IGN)
    process.send_signal(signal.SIGINT)
    wait_for_steps(process, 2000)  # more than a pipe holds, so most are of later
    assert process.poll() is None


@needs_distribution
@pytest.mark.parametrize("thread", ["only", "another"])
def test_python_program_keeps_its_handler(thread):
    """KeyboardInterrupt stays what a program gets that runs LAMMPS itself; only its main thread may set a handler."""
    done = subprocess.run(["/usr/bin/python3", "-c", DRIVER, thread, LOAD_SPOT], env={**os.environ, "SPOT_PLUGIN": PLUGIN},
                          preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL), capture_output=True, text=True, timeout=120)
    assert done.returncode == 0 and done.stdout == "True\n", done.stdout + done.stderr
