"""The integrator keeps energy, sticks exactly and treats both directions alike."""

from collections.abc import Sequence

import numpy as np
import pytest

from workbench.core.paths import closed_chain_file
from workbench.rigs import ClosedChain, LegStructure, leg_structure
from workbench.rigs.events import State
from workbench.rigs.friction import Friction
from workbench.rigs.integrate import Integrator
from workbench.rigs.machine import Machine

FREE = (0.0, 0.0)
ALONE = LegStructure(m11=0.05, m12=0.0, m22=0.02, g1=0.0, g2=0.0)  # two uncoupled flywheels


def leg_of(
    structure: LegStructure, damping: tuple[float, float] = FREE, frictions: Sequence[Friction] = ()
) -> Integrator:
    """An integrator of a leg with this inertia and gravity, rotors included."""
    increment = structure.minus(leg_structure())
    return Integrator(
        Machine(increment=increment, rotor=[0.0, 0.0], damping=list(damping), frictions=list(frictions))
    )


def at(q1: float, q2: float, v1: float = 0.0, v2: float = 0.0) -> State:
    return [q1, q2], [v1, v2]


def coulomb(torque: float, direction: tuple[float, float] = (1.0, 0.0)) -> Friction:
    return Friction(direction, lambda speed, position, load: torque)


def stribeck(kinetic: float, static: float) -> Friction:
    return Friction((1.0, 0.0), lambda speed, position, load: kinetic if abs(speed) > 1e-3 else static)


def test_without_damping_drakes_energy_is_kept() -> None:
    chain, leg = ClosedChain(closed_chain_file("leg")), leg_of(leg_structure())
    state = at(-0.4, 0.9, 3.0, -2.0)
    before = chain.energy(*map(np.array, state))
    for _ in range(2000):
        state = leg.advance(state, 0.0, 0.0, 1e-3)
    after = chain.energy(*map(np.array, state))
    assert after == pytest.approx(before, abs=1e-9)
    assert abs(state[0][0] + 0.4) > 0.1  # it did move


def test_work_of_a_constant_torque_becomes_energy() -> None:
    chain, leg = ClosedChain(closed_chain_file("leg")), leg_of(leg_structure())
    state, torque = at(-0.4, 0.9), np.array([0.6, -0.2])
    start = np.array(state[0])
    gained = -chain.energy(start, np.zeros(2))
    for _ in range(150):
        state = leg.advance(state, *torque, 1e-3)
    gained += chain.energy(*map(np.array, state))
    assert gained == pytest.approx(torque @ (np.array(state[0]) - start), abs=1e-10)


def test_a_sliding_flywheel_stops_where_the_formula_says() -> None:
    leg = leg_of(ALONE, frictions=[coulomb(0.2)])
    state = at(0.0, 0.0, 1.0, 0.0)
    for _ in range(400):
        state = leg.advance(state, 0.0, 0.0, 1e-3)
    assert state[0][0] == pytest.approx(0.5 * 0.05 * 1.0**2 / 0.2, rel=1e-9)
    assert state[1][0] == 0.0


def test_it_breaks_away_just_above_the_static_limit() -> None:
    for torque, moves in ((0.29, False), (-0.29, False), (0.31, True), (-0.31, True)):
        leg = leg_of(ALONE, frictions=[stribeck(0.2, 0.3)])
        state = leg.advance(at(0.0, 0.0), torque, 0.0, 0.1)
        assert (state[1][0] != 0.0) == moves
        if moves:
            assert state[1][0] == pytest.approx(np.sign(torque) * (0.31 - 0.2) / 0.05 * 0.1, rel=0.05)


def test_a_stuck_drive_leaves_the_other_free_as_if_clamped() -> None:
    """With motor 1 held, shank and motor 2 swing as a single pendulum."""
    structure = leg_structure().plus(m11=0.0162, m22=0.0162)
    leg = leg_of(structure, frictions=[coulomb(5.0)])
    pendulum = leg_of(LegStructure(1.0, 0.0, structure.m22, 0.0, structure.g2))
    state = at(-0.5, 0.8, 0.0, 0.0)
    alone = at(0.0, 0.8, 0.0, 0.0)
    for _ in range(300):
        state, alone = leg.advance(state, 0.0, 0.0, 1e-3), pendulum.advance(alone, 0.0, 0.0, 1e-3)
    assert state[0][0] == -0.5
    assert state[0][1] == pytest.approx(alone[0][1], abs=1e-9)


def test_a_stuck_knee_joint_makes_one_body() -> None:
    structure = leg_structure().plus(m11=0.0162, m22=0.0162)
    leg = leg_of(structure, frictions=[coulomb(5.0, (-1.0, 1.0))])
    state = at(-0.5, 0.8, 1.0, 1.0)
    for _ in range(300):
        state = leg.advance(state, 0.1, 0.0, 1e-3)
    assert state[0][1] - state[0][0] == pytest.approx(1.3, abs=1e-12)
    assert state[1][0] == pytest.approx(state[1][1], abs=1e-12)


def test_friction_only_takes_energy() -> None:
    chain = ClosedChain(closed_chain_file("leg"))
    leg = leg_of(leg_structure(), frictions=[coulomb(0.05), coulomb(0.02, (-1.0, 1.0))])
    state, energies = at(-0.4, 0.9, 3.0, -2.0), []
    for _ in range(600):
        energies.append(chain.energy(*map(np.array, state)))
        state = leg.advance(state, 0.0, 0.0, 1e-3)
    assert np.all(np.diff(energies) < 1e-12)


def test_mirrored_starts_make_mirrored_motion() -> None:
    states = []
    for sign in (1.0, -1.0):
        leg = leg_of(leg_structure(), (0.01, 0.01), [stribeck(0.05, 0.1), coulomb(0.02, (-1.0, 1.0))])
        state = at(0.4 * sign, -0.9 * sign, 3.0 * sign, 0.0)
        for _ in range(500):
            state = leg.advance(state, 0.1 * sign, 0.0, 1e-3)
        states.append(sign * np.array(state))
    np.testing.assert_array_equal(*states)


def test_halving_the_step_changes_nothing_that_shows() -> None:
    ends = []
    for pieces in (1, 2):
        leg = leg_of(leg_structure(), (0.1, 0.1), frictions=[coulomb(0.1), coulomb(0.05, (0.0, 1.0))])
        state = at(-0.5, 0.5, 0.0, 0.0)
        for row in range(500):
            torque = 0.8 * np.sin(2 * np.pi * 5 * row * 1e-3)
            for _ in range(4 * pieces):
                state = leg.advance(state, torque, 0.3 * torque, 0.25e-3 / pieces)
        ends.append(state)
    np.testing.assert_allclose(*ends, atol=1e-6)
