# SPDX-License-Identifier: GPL-2.0-or-later
"""Collisions in LIGGGHTS against the printed contact law of 2006, integrated here without any of the decks' derived constants.

The law for two grains is F_n = sqrt(delta/d) (k_n delta - m gamma_n v/2) with k_n = 2e5 m g/d and gamma_n = 50 sqrt(g/d). On a wall
LIGGGHTS' R_eff = d/2 and m_eff = m make it sqrt(2) stiffer and 2 sqrt(2) more damped.
"""

import re
import shutil
import subprocess

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from liggghts_runs import DIAMETER, GRAVITY, MASS, TAU, read_dump, run_ok

K_N = 2e5 * MASS * GRAVITY / DIAMETER
K_T = 2 / 7 * K_N
GAMMA = 50 * np.sqrt(GRAVITY / DIAMETER)
MU = 0.5
UNIT_SPEED = np.sqrt(GRAVITY * DIAMETER)

# partner: deck, stiffness and damping relative to the printed law, reduced mass
PARTNERS = {
    "bead": ("in.bead_bead", 1.0, 1.0, MASS / 2),
    "wall": ("in.bead_wall", np.sqrt(2), 2 * np.sqrt(2), MASS),
}


def head_on(stiffer, damped, reduced_mass, speed):
    """Contact duration, restitution, largest force and largest overlap of a head-on collision."""
    def force(overlap, approach):
        return np.sqrt(max(overlap, 0) / DIAMETER) * (stiffer * K_N * overlap + damped * MASS * GAMMA * approach / 2)

    def parted(_, state):
        return state[0]
    parted.terminal, parted.direction = True, -1

    contact = solve_ivp(lambda _, s: (s[1], -force(*s) / reduced_mass), (0, TAU), (0, speed), events=parted,
                        rtol=1e-9, atol=1e-14, max_step=1e-4 * TAU)
    forces = [force(*s) for s in contact.y.T]
    return contact.t[-1], -contact.y[1, -1] / speed, max(forces), max(contact.y[0])


def trace_of(partner, out, **variables):
    """Bead 1's columns of the trace, one value a step, with its overlap and its velocity relative to what it hits."""
    run_ok("collision", PARTNERS[partner][0], out=out, **variables)
    frames = read_dump(out / "trace.dump")
    bead = {name: np.array([frame[name][0] for _, frame in frames]) for name in frames[0][1]}
    if partner == "bead":
        other = {name: np.array([frame[name][1] for _, frame in frames]) for name in ("x", "z", "vx", "vz")}
        separation = np.hypot(bead["x"] - other["x"], bead["z"] - other["z"])
        bead["overlap"] = DIAMETER - separation
        bead["relative_vx"], bead["relative_vz"] = bead["vx"] - other["vx"], bead["vz"] - other["vz"]
    else:
        bead["overlap"] = DIAMETER / 2 - bead["z"]
        bead["relative_vx"], bead["relative_vz"] = bead["vx"], bead["vz"]
    return bead


@pytest.mark.parametrize("partner", PARTNERS)
@pytest.mark.parametrize("speed", [0.1, 1, 10])
def test_head_on(partner, speed, tmp_path):
    _, stiffer, damped, reduced_mass = PARTNERS[partner]
    duration, restitution, force, overlap = head_on(stiffer, damped, reduced_mass, speed * UNIT_SPEED)

    trace = trace_of(partner, tmp_path, normal=speed * UNIT_SPEED, duration=0.04)
    step = 1e-4 * TAU
    in_contact = trace["overlap"][1:] > 0
    parted = 1 + np.argmin(in_contact)
    assert not in_contact[parted:].any() and in_contact[:parted - 1].all()

    assert trace["overlap"].max() == pytest.approx(overlap, rel=1e-3)
    assert trace["fz"].max() == pytest.approx(force, rel=1e-3)
    assert trace["relative_vz"][-1] / (speed * UNIT_SPEED) == pytest.approx(restitution, abs=1e-3)
    assert parted * step == pytest.approx(duration, abs=1.5 * step)


@pytest.mark.parametrize("partner", PARTNERS)
def test_force_follows_the_law_at_each_step(partner, tmp_path):
    _, stiffer, damped, _ = PARTNERS[partner]
    trace = trace_of(partner, tmp_path, normal=UNIT_SPEED)
    overlap = np.maximum(trace["overlap"], 0)
    law = np.sqrt(overlap / DIAMETER) * (stiffer * K_N * overlap - damped * MASS * GAMMA * trace["relative_vz"] / 2)
    # The force of a step is made with the velocity half a step back, which matters to the damping only.
    assert np.abs(trace["fz"] - law).max() < 1e-3 * law.max()


def oblique(stiffer, damped, partner, normal, tangential, step):
    """Velocities (x, z) and angular velocity (y) of the bead after an oblique collision, with LIGGGHTS' rule for friction:
    the elastic part is capped at mu F_n, damping acts while sticking."""
    radius, inertia = DIAMETER / 2, 0.1 * MASS * DIAMETER**2
    share = 0.5 if partner == "bead" else 1.0  # of the relative motion that is bead 1's; the other bead mirrors it
    position, velocity, spin, stretch = np.array([0.0, radius]), share * np.array([tangential, -normal]), 0.0, 0.0
    for _ in range(int(0.03 * TAU / step)):
        position = position + step * velocity / 2
        # Normal from the partner's contact point to the bead, and the tangent along +x.
        distance = np.hypot(*position) if partner == "bead" else position[1]
        n = position / distance if partner == "bead" else np.array([0.0, 1.0])
        t = np.array([n[1], -n[0]])
        overlap = (radius - distance) / share
        if overlap > 0:
            lever = radius - overlap / 2  # on a wall too
            approach = -(velocity @ n) / share
            slip = (velocity @ t - lever * spin) / share
            root = np.sqrt(overlap / DIAMETER)
            f_n = root * (stiffer * K_N * overlap + damped * MASS * GAMMA * approach / 2)
            stretch += slip * step
            f_t = -root * stiffer * K_T * stretch
            if abs(f_t) > MU * abs(f_n):
                f_t = np.copysign(MU * abs(f_n), f_t)
                stretch = -f_t / (root * stiffer * K_T)
            else:
                f_t -= root * damped * MASS * GAMMA * slip / 2
            velocity = velocity + step * (f_n * n + f_t * t) / MASS
            spin -= step * lever * f_t / inertia
        position = position + step * velocity / 2
    return velocity, spin


@pytest.mark.parametrize("partner", PARTNERS)
@pytest.mark.parametrize("tangential", [0.3, 3])  # sticks; slides
def test_oblique(partner, tangential, tmp_path):
    _, stiffer, damped, _ = PARTNERS[partner]
    velocity, spin = oblique(stiffer, damped, partner, UNIT_SPEED, tangential * UNIT_SPEED, 2e-6 * TAU)
    trace = trace_of(partner, tmp_path, normal=UNIT_SPEED, tangential=tangential * UNIT_SPEED, step=0.2)
    assert trace["vx"][-1] == pytest.approx(velocity[0], abs=3e-3 * UNIT_SPEED)
    assert trace["vz"][-1] == pytest.approx(velocity[1], abs=3e-3 * UNIT_SPEED)
    assert trace["omegay"][-1] == pytest.approx(spin, abs=3e-3 * UNIT_SPEED / DIAMETER)


LAMMPS_COLLISION = """
units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
atom_modify map array
region box block -0.006 0.006 -0.006 0.006 -0.006 0.006
create_box 1 box
create_atoms 1 single 0 0 {radius}
create_atoms 1 single 0 0 -{radius}
set group all diameter {diameter} density 2500
set atom 1 vx {half_t} vz -{half_n}
set atom 2 vx -{half_t} vz {half_n}
pair_style gran/hertz/history {kn} NULL {gamman} NULL 0.5 1
pair_coeff * *
neighbor 6e-4 bin
fix integrate all nve/sphere
timestep {dt}
run 1500
variable vx equal vx[1]
variable vz equal vz[1]
print "velocity ${{vx}} ${{vz}}"
"""


@pytest.mark.skipif(not shutil.which("lmp"), reason="no LAMMPS on the PATH")
@pytest.mark.parametrize("tangential", [0, 0.3, 3])
def test_same_collision_in_lammps(tangential, tmp_path):
    """gran/hertz/history takes the same constants. It caps the whole tangential force, LIGGGHTS the elastic part of it."""
    deck = LAMMPS_COLLISION.format(radius=DIAMETER / 2, diameter=DIAMETER, half_n=UNIT_SPEED / 2, half_t=tangential * UNIT_SPEED / 2,
                                   kn=2 * K_N / DIAMETER, gamman=2 * GAMMA / DIAMETER, dt=2e-5 * TAU)
    (tmp_path / "in.collision").write_text(deck)
    done = subprocess.run(["lmp", "-in", "in.collision", "-log", "none"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    vx, vz = map(float, re.search(r"^velocity (\S+) (\S+)", done.stdout, re.MULTILINE).groups())
    trace = trace_of("bead", tmp_path, normal=UNIT_SPEED, tangential=tangential * UNIT_SPEED, step=0.2)
    assert trace["vx"][-1] == pytest.approx(vx, abs=5e-3 * UNIT_SPEED)
    assert trace["vz"][-1] == pytest.approx(vz, abs=5e-3 * UNIT_SPEED)
