"""What is concluded of an effect is what its equation and its MuJoCo model show."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from tests.effects.cases import CASES, ON_A_PLATE, VALUES, Case, reference
from tests.effects.test_effects import midway
from tests.simulation.make import having
from workbench.core import EffectKey
from workbench.effects import EFFECTS, SignalStage, compile_plant, effect_named, kinds, load_model, places
from workbench.models import Model, Placement

FRICTION = [c for c in CASES if c.effect.stage is SignalStage.FRICTION and c.whole and c.model == "leg"]


@pytest.mark.parametrize("case", [c for c in FRICTION if not c.effect.search.hidden_state], ids=str)
def test_dry_is_what_holds_at_the_slowest_speed(case: Case) -> None:
    _, motion = midway(case, reference(case.model))
    creeping = replace(motion, velocity=np.full_like(motion.velocity, 1e-9) * [1.0, 3.0])
    shape = case.effect.parameters.to_coefficients(dict(case.values))[1]
    model = load_model(case.model)
    columns = case.effect.response(creeping, model, Placement.of(model, case.key), shape).columns
    assert kinds.is_dry(case.effect) == bool(np.abs(columns).max() > 0.01)


def foot(model: Model) -> np.ndarray:
    """Where the foot is with all joints at zero, (3,)."""
    m = compile_plant(model).mujoco
    data = mujoco.MjData(m)
    mujoco.mj_kinematics(m, data)
    return data.site(model.payload_site).xpos.copy()


def test_only_a_length_of_a_link_moves_a_foot() -> None:
    model = load_model(ON_A_PLATE)
    for key in places(model):
        moved = np.linalg.norm(foot(having(model, key, **VALUES[key.effect])) - foot(model))
        assert kinds.changes_foot_position(effect_named(key.effect)) == (moved > 1e-6), key


def test_delays_of_the_machine_are_alike_without_torque() -> None:
    alike = {e.name: kinds.late_alike(e, EFFECTS) for e in EFFECTS}
    assert alike.pop("command_delay") == ("sensor_delay",)
    assert alike.pop("sensor_delay") == ("command_delay",)
    assert not any(alike.values())


def test_what_identification_gave_is_not_free_until_it_is_used() -> None:
    bare, gravity = load_model("leg_kin_only"), effect_named("linkage_gravity")
    assert bare.linkage is not None
    measured = replace(bare, linkage=replace(bare.linkage, identified=True))
    assert kinds.free_parameters(gravity, measured) == 0
    used = having(measured, EffectKey("linkage_gravity", None), **VALUES["linkage_gravity"])
    assert kinds.free_parameters(gravity, used) == 2
