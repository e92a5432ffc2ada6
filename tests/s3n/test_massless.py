"""Links that have no mass: frames between the axes of a joint, which MuJoCo will not move as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.importing.test_import import urdf_of_a_leg
from workbench.core import Mechanism
from workbench.importing import Drives, import_model
from workbench.s3n import PostureChain


def test_a_link_without_mass_between_two_axes_moves(tmp_path: Path) -> None:
    """As URDF files split a ball into three joints: the rod has a second axis, which it does not use."""
    text = urdf_of_a_leg().replace(
        '<parent link="crank"/><child link="rod"/>', '<parent link="crank"/><child link="axle"/>'
    )
    held = (
        '<link name="axle"><inertial><mass value="0"/>'
        '<inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/>'
        '</inertial></link><joint name="axle" type="revolute"><parent link="axle"/><child link="rod"/>'
        '<axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
    )  # fmt: skip
    (tmp_path / "own.urdf").write_text(text.replace("</robot>", held))
    mechanism = Mechanism(
        tmp_path / "own.urdf", ("hip", "motor"), ("hip", "knee"), (("rod_end", "arm_end"),), "toe",
        limits=((-1.0, 1.0), (0.4, 1.4)),
    )  # fmt: skip
    drives = Drives((1.0, 1.0), (0.01, 0.01), (0.0, 0.0), (np.inf, np.inf))
    made = import_model(mechanism, drives, tmp_path / "own.toml")
    assert np.isfinite(PostureChain(made).dynamics(np.array([[0.1, 0.8]])).mass).all()
