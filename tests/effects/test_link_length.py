"""Where a link ends, in trees that branch."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from tests import floating_robot
from tests.simulation.make import having
from workbench.core import EffectKey, InputError
from workbench.effects import check_effect, compile_plant, load_model, places


def test_in_a_tree_with_branches_only_what_hangs_there_moves(tmp_path) -> None:
    floating_robot.write_robot(tmp_path)
    robot = load_model(tmp_path / "robot.toml")
    key = EffectKey("link_length_error", "fl_hip")
    # brackets end where they begin, shanks at feet that are no payload site
    assert {k.axis for k in places(robot) if k.effect == key.effect} == {
        f"{leg}_hip" for leg in floating_robot.LEGS
    }
    at = []
    for model in (robot, having(robot, key, length=0.02)):
        m = compile_plant(model).mujoco
        data = mujoco.MjData(m)
        mujoco.mj_forward(m, data)
        at.append({m.body(b).name: data.xpos[b].copy() for b in range(m.nbody)})
    moved = {name for name, place in at[0].items() if not np.allclose(place, at[1][name])}
    assert moved == {"fl_shank"}
    np.testing.assert_allclose(at[1]["fl_shank"] - at[0]["fl_shank"], [0.0, 0.0, -0.02], atol=1e-12)


def test_where_it_does_not_apply_the_line_says_what_it_needs(tmp_path) -> None:
    floating_robot.write_robot(tmp_path)
    robot = load_model(tmp_path / "robot.toml")
    given = having(load_model("leg"), EffectKey("link_length_error", "hip"), length=0.02).effects[-1]
    needs = "it needs a link that ends at one further joint, or at the payload site"
    with pytest.raises(InputError, match=needs):
        check_effect(robot, replace(given, key=EffectKey("link_length_error", "fl_roll")))
