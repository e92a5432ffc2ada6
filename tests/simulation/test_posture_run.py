"""Runs of a mechanism whose transmission changes, with dry friction at its drives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench import frf
from workbench.core import Controller, EffectKey, Estimate, InputError
from workbench.importing import own_rig
from workbench.models import AppliedEffect, Model, read_model
from workbench.rigs.own_rig import OwnExperiment
from workbench.rigs.virtual_leg import PERFECT
from workbench.simulation import PosturePlant, as_recording, held_posture, run_posture
from workbench.simulation.posture_step import with_friction

FRICTION = 0.3
LOOP = Controller("pd", "joint", kp=(50.0, 50.0), kd=(1.5, 1.5), period_s=0.002)


@pytest.fixture(scope="module")
def rubbed() -> Model:
    model = replace(read_model("four_bar"), controller=LOOP)
    for axis in model.axes:
        torque = {"torque": Estimate(FRICTION, 0.0, "N*m")}
        model = model.with_effect(AppliedEffect(EffectKey("coulomb_friction", axis), torque))
    return model


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_friction_holds_up_to_its_torque_and_no_further(rubbed: Model, share: float) -> None:
    plant = PosturePlant(rubbed)
    q, v = plant.chain.box.mean(axis=1)[None].copy(), np.zeros((1, 2))
    at, start = plant.chain.at(q), plant.map.drives(q)
    hold = -np.linalg.solve(at.jacobian[0].T, at.gravity[0])
    torques = np.tile(hold + np.array([share * FRICTION, 0.0]), (400, 1, 1))
    plant.advance(q, v, np.zeros((1, 2)), torques, 0.0005)
    moved, crept = np.abs(plant.map.drives(q) - start).max(), rubbed.sliding_speed * 400 * 0.0005
    assert moved < crept if share < 1.0 else moved > 20.0 * crept


def test_runs_are_those_of_virtual_hardware_with_stiction(rubbed: Model) -> None:
    design = frf.multisine(
        rubbed.axes, name="m", period_s=0.5, rms=1.0, f_min_hz=2.0, f_max_hz=10.0, rate_hz=1000.0,
        hold=held_posture(rubbed, {}), mixing="orthogonal", periods=1, transient_periods=0, realisations=1,
        phases="schroeder", driven="torque_feedforward", seed=1,
    )  # fmt: skip
    _, signals = design.play(0)
    rest = np.tile(np.array(design.hold), (500, 1))
    played = OwnExperiment("m", rest, signals["torque_feedforward"], design.excitation(0))
    hardware = own_rig(rubbed, sensors=PERFECT).run(played).position
    asked = as_recording(rubbed, design, 0)
    run, free = (
        run_posture(PosturePlant(each), asked, [None])[0].position
        for each in (rubbed, replace(rubbed, effects=()))
    )
    error, without = (np.std(x - hardware) / np.std(hardware - hardware[0]) for x in (run, free))
    assert error < 0.005 and without > 0.1


def test_three_drives_that_load_each_other_slide_or_creep() -> None:
    """Whatever they do fits the friction of the speeds that they then have."""
    generator, h, slow = np.random.default_rng(0), 0.0005, 5e-4
    for _ in range(300):
        half, jacobian = generator.normal(size=(2, 3, 3))
        mass, dry = 0.01 * half @ half.T + 1e-4 * np.eye(3), generator.uniform(0.0, 0.3, 3)
        pull, speed = generator.normal(size=3), generator.normal(size=3) * generator.choice([0.0, 0.01])
        drives = np.array([np.zeros(3), np.zeros(3), dry, np.full(3, slow)])
        found = with_friction(mass, pull, jacobian, speed, drives, h)
        after = speed + h * jacobian @ found
        held = jacobian.T @ (dry * np.clip(after / slow, -1.0, 1.0))
        np.testing.assert_allclose(mass @ found, pull - held, atol=1e-8)


def test_effects_that_these_runs_lack_are_refused(rubbed: Model) -> None:
    bias = AppliedEffect(EffectKey("torque_bias", rubbed.axes[0]), {"torque": Estimate(0.1, 0.0, "N*m")})
    with pytest.raises(InputError, match="not simulated with torque_bias"):
        PosturePlant(rubbed.with_effect(bias))
