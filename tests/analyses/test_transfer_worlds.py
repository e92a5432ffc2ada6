"""Hardware and simulations of the study sink, are pushed and are loaded alike."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from transfer_robot import Robot, RobotPlant
from transfer_worlds import EVALUATION, ContactLaw, IdentifiedLaw, Push, loaded, world_of

from tests.training.make import machine
from workbench.core import EffectKey, Estimate, InputError
from workbench.effects import load_model
from workbench.models import AppliedEffect
from workbench.training.machine import LEGS
from workbench.training.plants import TrainedPlant
from workbench.training.rollout import run

from .test_transfer_robot import Still


def test_the_evaluation_s_law_is_laid_in_a_copy() -> None:
    m = machine("quadruped").mujoco
    feet = [f"{leg}_sphere" for leg in LEGS]
    made = EVALUATION.applied(m, feet)
    assert made.opt.timestep == 0.0005 and made.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
    assert m.opt.timestep == 0.003 and m.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
    assert "0.5 ms" in str(EVALUATION)


def standing(stiffness: float, hardware: bool, push: Push | None = None, seconds: float = 0.6):
    made = machine("quadruped")
    plant = (
        RobotPlant(made, Robot(ground_stiffness=stiffness, ground_damping=150.0))
        if hardware
        else TrainedPlant(made, world_of(made, IdentifiedLaw(stiffness, 150.0, 0.8), 0.0))
    )
    return run(Still(), made, plant, seconds, 0, command=np.zeros((1, 1)), push=push and push.at)


def test_a_ground_gives_way_on_hardware_as_in_the_simulation() -> None:
    """By more than the weight over the stiffness, 3.5 mm: what sinks also leans, and legs give way."""
    sunk = [
        np.subtract(*(np.array(standing(k, hardware).rows["base_pose"])[-1, 2] for k in (1e5, 1e4)))
        for hardware in (True, False)
    ]
    assert 0.0035 < sunk[0] < 0.007 and sunk[1] == pytest.approx(sunk[0], rel=0.15)


def test_a_law_is_read_from_the_effects_of_a_model() -> None:
    found = (
        AppliedEffect(
            EffectKey("contact_compliance", None),
            {"stiffness": Estimate(9e4, 1e3, "N/m"), "damping": Estimate(160.0, 20.0, "N*s/m")},
        ),
        AppliedEffect(EffectKey("ground_friction", None), {"coefficient": Estimate(0.79, 0.01, "")}),
    )
    leg = load_model("leg")
    law = IdentifiedLaw.of(replace(leg, effects=(*leg.effects, *found)))
    assert law == IdentifiedLaw(9e4, 160.0, 0.79) and "90 kN/m" in str(law)
    with pytest.raises(InputError, match="no ground_friction"):
        IdentifiedLaw.of(replace(leg, effects=(*leg.effects, found[0])))


@pytest.mark.parametrize("hardware", [True, False], ids=["hardware", "simulation"])
def test_a_push_moves_the_trunk_to_its_side_and_back(hardware: bool) -> None:
    push = Push(force=60.0, lasts_s=0.06, first_s=0.15, every_s=0.15)
    speed = np.array(standing(1e5, hardware, push, 0.4).rows["base_velocity"])[:, 1]
    first, second = 120 + 50, 120 + 100
    assert speed[first] == pytest.approx(0.0, abs=0.02)
    assert 0.12 < speed[first + 20] < 0.3  # less than the impulse over the whole mass, 3.6 N s: feet hold
    assert speed[second + 20] - speed[second] < -0.12


def test_pushes_go_along_the_trunk_s_own_side() -> None:
    push, turned = Push(force=10.0), np.array([0.0, 0.0, 0.3, np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    assert push.at(1.5, turned) == pytest.approx([-10.0, 0.0, 0.0])
    assert push.at(1.5 + 1.13, turned) == pytest.approx([10.0, 0.0, 0.0])
    assert not push.at(1.4, turned).any() and not push.at(1.6, turned).any()


@pytest.mark.parametrize("hardware", [True, False], ids=["hardware", "simulation"])
def test_a_payload_weighs_on_the_feet(hardware: bool) -> None:
    made, soft = machine("quadruped"), ContactLaw(0.02, 0.003, elliptic=False)
    weights = []
    for payload in (0.0, 4.0):
        plant = (
            RobotPlant(made, Robot(payload=payload))
            if hardware
            else TrainedPlant(made, world_of(made, soft, payload))
        )
        log = run(Still(), made, plant, 1.6, 0, command=np.zeros((1, 1)))
        weights.append(np.array(log.rows["ground_force"])[-60:, 2::3].sum(axis=1).mean())
    assert weights[1] - weights[0] == pytest.approx(4.0 * 9.81, rel=0.08)


def test_a_mass_off_the_trunk_s_centre_keeps_the_laws_of_bodies() -> None:
    m = machine("quadruped").mujoco
    made = loaded(m, 4.0)
    trunk = int(m.jnt_bodyid[0])
    assert made.body_mass[trunk] == pytest.approx(m.body_mass[trunk] + 4.0)
    assert made.body_inertia[trunk].sum() == pytest.approx(m.body_inertia[trunk].sum())  # at its own centre
