"""The SDF reader and the tree it grows in MuJoCo are what Drake makes of the same file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from workbench.core import InputError, Mechanism
from workbench.core.paths import closed_chain_file
from workbench.effects import load_model
from workbench.mechanism import ClosedChain
from workbench.s3n.loop import close_loops, loop_spec, tree_projection
from workbench.s3n.sdf import read_sdf

#: Two links with poses and axes given in every way: relative to links, joints and frames, turned, skewed.
CROOKED = """
<sdf version="1.9"><model name="crooked">
  <frame name="stand"><pose>0.1 0 0.5 0 0.3 0</pose></frame>
  <link name="upper"><pose relative_to="stand">0.05 0 0 0.1 0 0.2</pose>
    <inertial><pose>0.02 0.01 -0.1 0.3 0.2 0.1</pose><mass>1.2</mass>
      <inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.025</izz><ixy>0.001</ixy><ixz>0</ixz><iyz>0</iyz></inertia>
    </inertial></link>
  <joint name="one" type="revolute"><pose relative_to="stand"/><parent>world</parent><child>upper</child>
    <axis><xyz expressed_in="__model__">0 -1 0.2</xyz></axis></joint>
  <link name="lower"><pose relative_to="two">0 0 -0.02 0 0 0</pose>
    <inertial><mass>0.4</mass>
      <inertia><ixx>0.002</ixx><iyy>0.003</iyy><izz>0.0025</izz></inertia></inertial></link>
  <joint name="two" type="prismatic"><pose relative_to="elbow" degrees="true">0 0 0 0 30 0</pose>
    <parent>upper</parent><child>lower</child><axis><xyz>0 0 1</xyz></axis></joint>
  <frame name="elbow" attached_to="upper"><pose>0 0 -0.3 0 0 0</pose></frame>
  <frame name="tip" attached_to="lower"><pose>0 0 -0.2 0 0 0</pose></frame>
  <frame name="further" attached_to="tip"><pose>0.1 0 0 0 0 0</pose></frame>
</model></sdf>
"""


def crooked(folder: Path, text: str = CROOKED) -> Path:
    (folder / "crooked.sdf").write_text(text)
    return folder / "crooked.sdf"


def test_the_tree_is_drakes_tree(tmp_path: Path) -> None:
    file = crooked(tmp_path)
    mechanism = Mechanism(file, drives=("one", "two"), joints=("one", "two"), loops=(), foot="further")
    leg = load_model("leg_kin_only")
    model = replace(leg, closed_chain=mechanism, actuators=replace(leg.actuators, inertia=(0, 0)))
    m = loop_spec(model).compile()
    drake = _drake(file)
    data, full = mujoco.MjData(m), np.zeros((2, 2))
    generator = np.random.default_rng(0)
    for _ in range(5):
        q, v = generator.uniform(-1, 1, 2), generator.normal(size=2)
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(m, data)
        mujoco.mj_fullM(m, data, full)
        mass, torque, foot = drake(q, v)
        np.testing.assert_allclose(full, mass, atol=1e-12)
        np.testing.assert_allclose(data.qfrc_bias, torque, atol=1e-12)
        np.testing.assert_allclose(data.site("further").xpos, foot, atol=1e-12)


def _drake(file: Path) -> Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, ...]]:
    """Mass matrix, torque that a state needs, and the foot, by Drake."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant: Any = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(file))
    plant.Finalize()
    context = plant.CreateDefaultContext()

    def at(q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, ...]:
        plant.SetPositions(context, q)
        plant.SetVelocities(context, v)
        torque = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
        frame = plant.GetFrameByName("further")
        foot = plant.CalcPointsPositions(context, frame, np.zeros(3), plant.world_frame())
        return plant.CalcMassMatrix(context), torque, foot[:, 0]

    return at


def test_the_leg_closed_by_hand_is_the_closed_chain() -> None:
    model = load_model("leg_kin_only")
    m, chain = loop_spec(model).compile(), ClosedChain(closed_chain_file("leg"))
    data, full = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    for q in np.array([[-0.55, 1.0], [0.9, 2.2], [0.1, 0.4]]):
        theta, _ = close_loops(m, model, q, np.zeros(2))
        data.qpos[:] = theta
        mujoco.mj_forward(m, data)
        mujoco.mj_fullM(m, data, full)
        along = tree_projection(m, model, theta) @ np.linalg.inv(model.transmission)
        links = chain.reduced_dynamics(model.transmission @ q, np.zeros(2))
        expected = links.mass + np.diag(model.actuators.inertia)
        np.testing.assert_allclose(along.T @ full @ along, expected, atol=1e-9)
        np.testing.assert_allclose(-along.T @ data.qfrc_bias, links.gravity, atol=1e-8)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("</sdf>", "", "not an SDF file"),
        ('type="prismatic"', 'type="screw"', "joint 'two' is of type 'screw'"),
        ('relative_to="elbow"', 'relative_to="knee"', "nothing is called 'knee'"),
        ("<pose>0.1 0 0 0 0 0</pose>", "<pose>0.1 0 0</pose>", "x y z roll pitch yaw"),
        ("<mass>0.4</mass>", "<mass>much</mass>", "cannot be read"),
    ],
)
def test_bad_files_end_in_one_line(old: str, new: str, says: str, tmp_path: Path) -> None:
    file = crooked(tmp_path, CROOKED.replace(old, new))
    with pytest.raises(InputError, match=says) as caught:
        read_sdf(file)
    assert str(file) in str(caught.value) and "\n" not in str(caught.value)


def test_names_that_the_file_has_not(tmp_path: Path) -> None:
    tree = read_sdf(crooked(tmp_path))
    assert tree.mass == pytest.approx(1.6)
    assert tree.frame("upper").link == "upper"
    with pytest.raises(InputError, match="no frame is called 'toe'; frames are stand, elbow, tip, further"):
        tree.frame("toe")
    with pytest.raises(InputError, match="not an SDF file"):
        read_sdf(tmp_path / "nothing.sdf")
