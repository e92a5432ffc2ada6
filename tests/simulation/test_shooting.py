"""Windows on the ground: the contact's law in N/m, one long run in pieces, and small changes."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from tests.simulation.make import having
from workbench.core import EffectKey
from workbench.effects import compile_plant, load_model
from workbench.models import Model
from workbench.simulation import Tangents, Windows, shoot

MODEL = load_model("leg_on_plate")
SOFT = EffectKey("contact_compliance", None)
STEP = 0.001


def standing(depth: float, forward: float = 0.02) -> np.ndarray:
    """Angles (2,) of the drives with the foot so deep in the plate."""
    l1, l2, x, z = 0.175, 0.24, forward, -0.32 - depth
    knee = np.arccos((x * x + z * z - l1**2 - l2**2) / (2 * l1 * l2))
    hip = np.arctan2(x, -z) - np.arctan2(l2 * np.sin(knee), l1 + l2 * np.cos(knee))
    return np.array([hip, hip + knee])


def windows(starts: list[int], position: np.ndarray, velocity: np.ndarray, torque: np.ndarray) -> Windows:
    return Windows(np.array(starts), position, velocity, torque, STEP, 1)


def long_run(model: Model = MODEL, rows: int = 120) -> tuple[Windows, np.ndarray, np.ndarray, np.ndarray]:
    """The leg falls on the plate, under a torque that presses and slides it."""
    t = np.arange(rows) * STEP
    torque = np.stack([2.0 + 2.0 * np.sin(60.0 * t), -1.5 + np.cos(45.0 * t)], axis=1)
    position = np.tile(standing(-0.002), (rows, 1))
    plan = windows([0], position, np.zeros_like(position), torque)
    shots = shoot(compile_plant(model, STEP, grounded=True), plan)
    return plan, shots.position, shots.velocity, shots.force


@pytest.mark.parametrize("forward", [-0.08, 0.0, 0.1])
@pytest.mark.parametrize(("stiffness", "damping"), [(5e3, 20.0), (2e4, 100.0), (3e5, 0.0)])
def test_a_contact_is_a_spring_and_a_damper_in_si_units(
    forward: float, stiffness: float, damping: float
) -> None:
    """Whatever the posture; but for a thousandth of the foot's mass times its acceleration."""
    model = having(MODEL, SOFT, stiffness=stiffness, damping=damping)
    plant = compile_plant(model, STEP, grounded=True)
    data = mujoco.MjData(plant.mujoco)
    depth, rate = 60.0 / stiffness, np.array([0.3, -0.2])
    shots = shoot(plant, windows([0], standing(depth, forward)[None], rate[None], np.zeros((1, 2))))
    data.qpos[:], data.qvel[:] = standing(depth, forward) @ [[1, -1], [0, 1]], rate @ [[1, -1], [0, 1]]
    mujoco.mj_forward(plant.mujoco, data)
    up = np.zeros((3, 2))
    mujoco.mj_jac(plant.mujoco, data, up, None, data.contact[0].pos, 2)
    law = stiffness * depth - damping * (up @ data.qvel)[2]
    assert shots.force[0, 2] == pytest.approx(law, rel=3e-3)


def test_a_foot_at_rest_carries_what_presses_and_pulls_it() -> None:
    depth = 50.0 / 1e5
    plant = compile_plant(MODEL, STEP, grounded=True)
    data = mujoco.MjData(plant.mujoco)
    data.qpos[:] = standing(depth) @ [[1, -1], [0, 1]]
    mujoco.mj_forward(plant.mujoco, data)
    jacobian = np.zeros((3, 2))
    mujoco.mj_jac(plant.mujoco, data, jacobian, None, data.contact[0].pos, 2)
    wanted = np.array([20.0, 0.0, 50.0])  # below Coulomb's limit of 40 N
    torque = (data.qfrc_bias - jacobian.T @ wanted) @ np.linalg.inv(MODEL.transmission)
    shots = shoot(
        plant,
        windows([0], *np.zeros((2, 800, 2)) + standing(depth) * [[[1]], [[0]]], np.tile(torque, (800, 1))),
    )
    np.testing.assert_allclose(shots.force[-1], wanted, atol=0.5)
    assert np.abs(shots.velocity[-1]).max() < 2e-3
    slippery = having(MODEL, EffectKey("ground_friction", None), coefficient=0.2)
    slides = shoot(
        compile_plant(slippery, STEP, grounded=True),
        windows([0], *np.zeros((2, 30, 2)) + standing(depth) * [[[1]], [[0]]], np.tile(torque, (30, 1))),
    )
    force = slides.force[5:25]
    np.testing.assert_allclose(np.abs(force[:, 0]) / force[:, 2], 0.2, rtol=1e-3)


def test_pieces_from_its_own_states_are_the_long_run() -> None:
    plan, position, velocity, force = long_run()
    again = shoot(
        compile_plant(MODEL, STEP, grounded=True),
        replace(plan, starts=np.array([0, 7, 40, 77]), position=position, velocity=velocity),
    )
    assert force[:, 2].max() > 20.0 and (force[:5] == 0.0).all()
    np.testing.assert_allclose(again.position, position, atol=1e-9)
    np.testing.assert_allclose(again.force, force, atol=1e-3)


def test_small_changes_are_those_of_two_runs() -> None:
    plan, position, velocity, _ = long_run()
    plan = replace(plan, starts=np.array([10, 45, 80]), position=position, velocity=velocity)
    plant = compile_plant(MODEL, STEP, grounded=True)
    size = 1e-5
    t = np.arange(len(position)) * STEP
    push = np.stack([np.sin(30.0 * t), np.cos(50.0 * t)], axis=1)
    shift = np.stack([np.tile([0.1, -0.05], (len(t), 1)), np.zeros((len(t), 2))])
    zero = np.zeros_like(push)
    moved, felt = Tangents(plant, plan).travel(
        np.stack([push, zero]), np.stack([np.zeros_like(shift), shift])
    )
    base = shoot(plant, plan)
    pushed = shoot(plant, replace(plan, torque=plan.torque + size * push))
    shifted = shoot(plant, replace(plan, position=plan.position - size * shift[0]))
    rows = slice(10, None)
    for k, run in enumerate((pushed, shifted)):
        read = size * shift[0] if k else 0.0
        change = ((run.position - base.position + read) / size)[rows]
        np.testing.assert_allclose(moved[rows, :, k], change, atol=0.02 * np.abs(change).max())
        change = ((run.force - base.force) / size)[rows]
        away = np.abs(felt[rows, :, k] - change)
        assert np.mean(away > 0.05 * np.abs(change).max()) < 0.02  # but where a foot is just touching
    assert not moved[:10].any()
