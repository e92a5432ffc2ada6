"""Constraints are looked for at every step, unless there can be none."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.diagnosis.rig import applied
from workbench.core import EffectKey
from workbench.effects import compile_plant, load_model
from workbench.models import Model

LEG = load_model("leg")
_LEFT_OUT = int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)

PENDULUM = """<mujoco><option integrator="RK4"/><worldbody>{ground}<body pos="0 0 1">
<joint name="a" axis="0 1 0" {joint}/><geom type="capsule" fromto="0 0 0 0 0 -.5" size=".02" mass="1" {geom}/>
</body></worldbody></mujoco>"""


def with_effect(name: str, **values: float) -> Model:
    return LEG.with_effect(applied(LEG, EffectKey(name, "knee"), **values))


def pendulum(folder: Path, ground: str = "", joint: str = "", geom: str = 'contype="0"') -> Model:
    file = folder / "pendulum.xml"
    file.write_text(PENDULUM.format(ground=ground, joint=joint, geom=geom))
    return load_model(file)


def test_the_leg_has_none() -> None:
    assert compile_plant(LEG).mujoco.opt.disableflags & _LEFT_OUT


@pytest.mark.parametrize(
    "model",
    [
        with_effect("coulomb_friction", torque=0.2),
        with_effect("load_dependent_friction", torque=0.0, ratio=0.1),
        with_effect("stribeck_friction", coulomb=0.1, static=0.2, speed=0.1),
    ],
    ids=lambda m: m.effects[0].key.effect,
)
def test_dry_friction_is_one(model: Model) -> None:
    assert not compile_plant(model).mujoco.opt.disableflags & _LEFT_OUT


@pytest.mark.parametrize(
    "parts, held",
    [
        ({}, False),
        ({"joint": 'range="-30 30" limited="true"'}, True),
        ({"joint": 'frictionloss="1"'}, True),
        ({"ground": '<geom type="plane" size="1 1 .1" pos="0 0 .8"/>', "geom": ""}, True),
    ],
    ids=["free", "limit", "friction", "ground"],
)
def test_what_an_mjcf_holds_is_held(tmp_path: Path, parts: dict[str, str], held: bool) -> None:
    plant = compile_plant(pendulum(tmp_path, **parts))
    assert bool(plant.mujoco.opt.disableflags & _LEFT_OUT) is not held
    data = mujoco.MjData(plant.mujoco)
    data.qpos[0], data.qvel[0] = 1.5, 0.0
    furthest = 0.0
    for _ in range(1500):
        mujoco.mj_step(plant.mujoco, data)
        furthest = max(furthest, -float(data.qpos[0]))
    assert np.isfinite(furthest) and (furthest < 1.3) is held
