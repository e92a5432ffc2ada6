"""Inertia that an MJCF states too high or too low, and springs behind the rotors that it states."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from workbench.core import Controller, EffectKey, Estimate, Recording
from workbench.effects import compile_plant, effect_named, link_inertia, load_model
from workbench.models import AppliedEffect, Model, Placement
from workbench.simulation import Track, motion_of

_ARM = """<mujoco><option gravity="0 0 0"/><worldbody><body><joint name="a" axis="0 -1 0" armature="0.02"/>
<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.03 0.03"/></body></worldbody></mujoco>"""


@pytest.fixture
def arm(tmp_path: Path) -> Model:
    (tmp_path / "arm.xml").write_text(_ARM)
    return load_model(str(tmp_path / "arm.xml"))


def with_effect(model: Model, effect: str, **values: float) -> Model:
    estimates = {name: Estimate(value, 0.0, "") for name, value in values.items()}
    return model.with_effect(AppliedEffect(EffectKey(effect, "a"), estimates))


def inertia(model: Model) -> np.ndarray:
    m = compile_plant(model).mujoco
    data, full = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, full)
    return full


@pytest.mark.parametrize("more", [-0.015, 0.004])
def test_inertia_goes_either_way(arm: Model, more: float) -> None:
    assert inertia(with_effect(arm, "reflected_inertia", inertia=more))[0, 0] == pytest.approx(0.05 + more)


def test_no_more_than_the_rotor_can_be_missing(arm: Model) -> None:
    lower, _ = effect_named("reflected_inertia").parameters.bounds(arm, Placement.of(arm, EffectKey("", "a")))
    assert lower == pytest.approx([-0.018])
    less = with_effect(arm, "reflected_inertia", inertia=-0.015)
    again, _ = effect_named("reflected_inertia").parameters.bounds(
        less, Placement.of(arm, EffectKey("", "a"))
    )
    assert again == pytest.approx([-0.003]), "what was taken off already counts"


@pytest.mark.parametrize("more", [-0.018, 0.0, 0.004])
def test_the_link_behind_a_rotor_does_not_hang_on_the_rotor(arm: Model, more: float) -> None:
    found = with_effect(arm, "reflected_inertia", inertia=more)
    time = 0.01 * np.arange(50)
    still = {"position": np.zeros((50, 1)), "torque_command": np.zeros((50, 1))}
    recording = Recording("still", ("a",), "joint", time, still, ("rad",), controller=Controller("none"))
    track = Track(still["position"], still["position"], still["position"])
    motion = motion_of(track, recording, compile_plant(found), np.eye(1))
    own, column = link_inertia(motion, found, Placement.of(arm, EffectKey("", "a")))
    assert own == pytest.approx(0.03) and column == pytest.approx(np.full((50, 1), 0.03))
    assert motion.rotor[0] == pytest.approx([0.02 + more])


def test_a_spring_has_a_rotor_on_one_side_a_link_on_the_other(arm: Model) -> None:
    """Two inertias on a spring ring at sqrt(k (1/J1 + 1/J2))."""
    for more in (0.0, -0.01, 0.01):
        soft = with_effect(arm, "reflected_inertia", inertia=more) if more else arm
        soft = with_effect(soft, "joint_compliance", stiffness=200.0, damping=0.0)
        plant = compile_plant(soft)
        both = np.sort(np.diag(inertia(soft)))
        assert both == pytest.approx(sorted([0.02 + more, 0.03]), rel=1e-5)
        data = mujoco.MjData(plant.mujoco)
        data.qpos[:] = [1e-3, 0.0]
        mujoco.mj_forward(plant.mujoco, data)
        twist = data.qacc @ [1.0, -1.0] / (data.qpos @ [1.0, -1.0])
        assert -twist == pytest.approx(200.0 * (1 / (0.02 + more) + 1 / 0.03), rel=1e-3)
