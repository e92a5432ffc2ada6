"""What files may look like: SDF or URDF, loops named or declared, a base fixed or free."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Mechanism
from workbench.core.paths import closed_chain_file
from workbench.mechanism import ClosedChain

from .chains import chain, simulate_discrete

TEXT = closed_chain_file("leg").read_text()
LEG = Mechanism(closed_chain_file("leg"))
BALL = """<drake:ball_constraint>
  <drake:ball_constraint_body_A>coupler</drake:ball_constraint_body_A>
  <drake:ball_constraint_body_B>shank</drake:ball_constraint_body_B>
  <drake:ball_constraint_p_AP>0 0 -0.175</drake:ball_constraint_p_AP>
  <drake:ball_constraint_p_BQ>0 0 0.06</drake:ball_constraint_p_BQ>
</drake:ball_constraint>"""
BALL_URDF = """<drake:ball_constraint>
  <drake:ball_constraint_body_A name="coupler"/><drake:ball_constraint_body_B name="shank"/>
  <drake:ball_constraint_p_AP value="0 0 -0.175"/><drake:ball_constraint_p_BQ value="0 0 0.06"/>
</drake:ball_constraint>"""
LINK = """<link name="{}"><inertial><origin xyz="0 0 {}"/><mass value="{}"/>
  <inertia ixx="{i}" iyy="{i}" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{}" type="continuous"><parent link="{}"/><child link="{}"/>
  <origin xyz="0 0 {}"/><axis xyz="0 -1 0"/></joint>"""
URDF = "\n".join([
    '<robot name="leg" xmlns:drake="http://drake.mit.edu"><link name="base"/>',
    LINK.format("thigh", -0.08, 1.8, i=0.0126558335),
    LINK.format("shank", -0.14100621118012422, 0.23, i=0.00238196713398403),
    LINK.format("crank", 0.03, 0.05, i=0.0003),
    LINK.format("coupler", -0.0875, 0.05, i=0.000127604),
    JOINT.format("hip", "base", "thigh", 0),
    JOINT.format("crank_pin", "base", "crank", 0),
    JOINT.format("knee", "thigh", "shank", -0.175),
    JOINT.format("coupler_pin", "crank", "coupler", 0.06),
    BALL_URDF,
    "</robot>",
])  # fmt: skip
Q, V = np.array([-0.4, 0.7]), np.array([2.0, -3.0])


def same_dynamics(found: ClosedChain) -> None:
    expected, reduced = chain("leg").reduced_dynamics(Q, V), found.reduced_dynamics(Q, V)
    np.testing.assert_allclose(reduced.mass, expected.mass, atol=1e-14)
    np.testing.assert_allclose(reduced.bias, expected.bias, atol=1e-13)
    np.testing.assert_allclose(reduced.gravity, expected.gravity, atol=1e-13)


@pytest.mark.parametrize("head", ['<sdf version="1.9" xmlns:drake="drake.mit.edu">', '<sdf version="1.9">'])
@pytest.mark.parametrize("loops", [(), LEG.loops])
def test_a_loop_that_the_file_declares(head: str, loops: tuple[tuple[str, str], ...], tmp_path: Path) -> None:
    """Named as well it is one equation twice, which does no harm."""
    file = tmp_path / "own.sdf"
    file.write_text(TEXT.replace('<sdf version="1.9">', head).replace("</model>", f"{BALL}</model>"))
    same_dynamics(ClosedChain(replace(LEG, file=file, loops=loops)))
    motion = simulate_discrete(
        replace(LEG, file=file, loops=loops), [0.0162] * 2, [0.1] * 2, [V] * 20, 1e-3, Q
    )
    expected = simulate_discrete(LEG, [0.0162] * 2, [0.1] * 2, [V] * 20, 1e-3, Q)
    np.testing.assert_allclose(motion.position, expected.position, atol=1e-6)


def test_a_urdf_with_a_base_that_floats_is_held(tmp_path: Path) -> None:
    file = tmp_path / "own.urdf"
    file.write_text(URDF)
    same_dynamics(ClosedChain(Mechanism(file, loops=(), foot=None)))


def test_a_payload_weighs_on_the_foot_wherever_that_is() -> None:
    bare, loaded = chain("leg"), ClosedChain(replace(LEG, foot="rear_arm_end"), payload=0.5)
    change = loaded.reduced_dynamics(Q, V).gravity - bare.reduced_dynamics(Q, V).gravity
    np.testing.assert_allclose(change, 0.5 * 9.81 * np.array([-0.175, 0.06]) * np.sin(Q), atol=1e-12)
