"""The file of a tree as MuJoCo reads it, and what is put into it afterwards."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from workbench.core import EffectKey, Estimate
from workbench.effects import compile_plant, load_model
from workbench.models import AppliedEffect, load_tree

FROM_GEOMS = """<mujoco><compiler inertiafromgeom="true"/><worldbody><body name="upper">
<joint name="lift" axis="0 1 0"/><inertial pos="0 0 9" mass="9" diaginertia="9 9 9"/>
<geom type="box" size="0.02 0.03 0.1" pos="0 0 -0.1" euler="20 0 0" mass="2"/>
<body name="fore" pos="0 0 -0.2"><joint name="bend" axis="0 1 0"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.001"/><site name="tool" pos="0 0 -0.2"/>
</body></body>
</worldbody></mujoco>"""


def test_inertia_from_geoms_is_that_of_the_files_bodies(tmp_path: Path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(FROM_GEOMS)
    alone, read = mujoco.MjModel.from_xml_path(str(file)), load_tree(file).compile()
    for name in ("body_mass", "body_ipos", "body_inertia", "body_iquat"):
        assert getattr(read, name) == pytest.approx(getattr(alone, name), abs=1e-12)
    model = load_model(file)
    key = EffectKey("first_moment_error", "lift")
    moment = AppliedEffect(key, {n: Estimate(v, 0.0, "") for n, v in (("along", 0.1), ("across", 0.0))})
    changed = compile_plant(model.with_effect(moment)).mujoco
    assert np.abs(changed.body_ipos[1] - alone.body_ipos[1]).max() == pytest.approx(0.05)
    load = AppliedEffect(EffectKey("payload_mass", None), {"mass": Estimate(0.5, 0.0, "")})
    assert compile_plant(model.with_effect(load)).mujoco.body_mass.sum() == pytest.approx(3.5)
