"""An MJCF whose loop is closed by an equality becomes the same mechanism with its loop cut open."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.cli.here import run
from workbench.core import InputError, Mechanism
from workbench.importing import Drives, contents_of, import_model
from workbench.importing.from_mjcf import convert
from workbench.mechanism import ClosedChain
from workbench.models import read_model
from workbench.verification import verify

_LOOPS = {
    "bodies": '<connect name="loop" body1="rod" body2="shank" anchor="0 0 -0.2"/>',
    "sites": '<connect name="loop" site1="rod_end" site2="heel"/>',
}
_LEG = """<mujoco><compiler angle="degree"/><default><joint axis="0 -1 0"/><default class="motor">
<joint armature="0.012" damping="0.05"/></default></default><worldbody>
<body name="thigh" pos="0 0 0.6" euler="0 -10 0"><joint name="hip" class="motor" range="-60 60" ref="10"/>
<inertial pos="0.01 0 -0.1" mass="1.1" fullinertia="0.004 0.0042 0.0008 0 0.0001 0"/>
<body name="shank" pos="0 0 -0.2" euler="0 -50 0"><joint name="knee" range="20 130" ref="50" damping="0.001"/>
<inertial pos="0 0 -0.08" mass="0.3" diaginertia="0.002 0.002 0.0002"/><site name="toe" pos="0 0 -0.25"/>
<site name="heel" pos="0 0 0.05"/></body></body>
<body name="lever" pos="0 0 0.6" euler="0 -60 0"><joint name="crank" class="motor" ref="60"/>
<inertial pos="0 0 0.02" mass="0.08" diaginertia="0.0001 0.0001 0.00001"/>
<body name="rod" pos="0 0 0.05" euler="0 50 0"><joint name="pin" ref="-50"/>
<inertial pos="0 0 -0.1" mass="0.06" diaginertia="0.0002 0.0002 0.00002"/>
<site name="rod_end" pos="0 0 -0.2"/></body></body></worldbody><equality>{loop}</equality>
<actuator><motor joint="hip" gear="2" ctrlrange="-10 10"/>
<motor joint="crank" forcerange="-15 15"/></actuator>
</mujoco>"""
_NAMED = Mechanism(Path(), ("hip", "crank"), ("hip", "knee"), (), "toe", limits=((-1.0, 1.0), (0.4, 2.0)))
_DRIVES = Drives((1.0, 1.0), (0.012, 0.012), (0.05, 0.05), (20.0, 15.0))


def _file(folder: Path, loop: str) -> Path:
    file = folder / "machine.xml"
    file.write_text(_LEG.format(loop=_LOOPS[loop]))
    return file


@pytest.mark.parametrize("loop", _LOOPS)
def test_the_mechanism_is_mujocos(tmp_path: Path, loop: str) -> None:
    file = _file(tmp_path, loop)
    import_model(_with(file), _DRIVES, tmp_path / "own.toml")
    model = read_model(tmp_path / "own.toml")
    assert model.closed_chain is not None and model.linkage is not None
    np.testing.assert_allclose(model.transmission, [[1, 0], [1, 1]], atol=1e-9)
    assert verify(model, samples=5).passed
    chain, spec = ClosedChain(model.closed_chain), mujoco.MjSpec.from_file(str(file))
    for joint in spec.joints:
        joint.armature = 0.0
    m = spec.compile()
    data, mass = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    order = [m.joint(name).qposadr[0] for name in chain.coordinates]
    for q in ([0.2, 1.1], [-0.3, 0.9]):
        theta = chain.tree_position(np.array(q))
        data.qpos[order] = theta
        mujoco.mj_forward(m, data)
        # angles are the MJCF's, its loop is closed there, and what the drives feel is what its links weigh
        gap = data.site("rod_end").xpos - data.site("heel").xpos
        np.testing.assert_allclose(gap, 0.0, atol=1e-9)
        ways = [chain.tree_position(np.array(q) + step) - theta for step in 1e-6 * np.eye(2)]
        slope = np.zeros((m.nv, 2))
        slope[order] = np.array(ways).T / 1e-6
        mujoco.mj_fullM(m, data, mass)
        found = chain.reduced_dynamics(np.array(q), np.zeros(2))
        np.testing.assert_allclose(slope.T @ mass @ slope, found.mass, atol=1e-7)
        np.testing.assert_allclose(-slope.T @ data.qfrc_bias, found.gravity, atol=1e-4)


def _with(file: Path) -> Mechanism:
    return replace(_NAMED, file=file)


def test_drives_have_what_the_mjcf_says_of_their_joints(tmp_path: Path) -> None:
    file = _file(tmp_path, "bodies")
    more = 'frictionloss="0.02" stiffness="3" range="20 130"'
    file.write_text(file.read_text().replace('range="20 130"', more))
    assert contents_of(file).loops == 1
    refused = run("check", file)
    assert refused.returncode == 2 and "workbench import" in refused.stderr
    words = ["--drive", "hip", "--drive", "crank", "--joint", "hip", "--joint", "knee", "--foot", "toe"]
    done = run("import", file, *words, "--gear", 3, "-o", tmp_path / "own.toml")
    assert done.returncode == 0, done.stderr
    assert "own.xml and own.sdf" in done.stdout and "knee 0.001" in done.stdout
    assert "friction of joints without a drive: knee 0.02 N m" in done.stdout
    assert "springs at knee" in done.stdout
    model = read_model(tmp_path / "own.toml")
    assert model.actuators.inertia == pytest.approx((0.012, 0.012))
    assert model.actuators.damping == pytest.approx((0.05, 0.05))
    assert model.actuators.torque_limit == pytest.approx((20.0, 15.0))


def test_a_weld_holds_an_angle_too(tmp_path: Path) -> None:
    """A lever welded to a link that another joint turns: one freedom is left of two."""
    file = tmp_path / "machine.xml"
    file.write_text(
        """<mujoco><worldbody><body name="one"><joint name="one" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.02"/><site name="tip" pos="0.2 0 0"/></body>
<body name="two" euler="0 30 0"><joint name="two" axis="0 1 0"/><geom type="box" size="0.1 0.02 0.02"/></body>
</worldbody><equality><weld body1="one" body2="two"/></equality></mujoco>"""
    )
    mechanism = Mechanism(file, ("two",), ("one",), (), "tip")
    model = import_model(mechanism, Drives((1.0,), (0.0,), (0.0,), (np.inf,)), tmp_path / "own.toml")
    assert model.closed_chain is not None
    np.testing.assert_allclose(model.transmission, [[1.0]], atol=1e-9)
    np.testing.assert_allclose(ClosedChain(model.closed_chain).tree_position(np.array([0.3])), 0.3, atol=1e-9)


def test_without_a_keyframe_assembly_begins_inside_ranges(tmp_path: Path) -> None:
    file = tmp_path / "robot.xml"
    joints = {"at_zero": 'range="-1 1"', "beyond": 'range="0.5 1.5"', "turned": 'ref="0.4" range="-1 1"'}
    bodies = "".join(
        f'<body><joint name="{name}" axis="0 1 0" {more}/><geom size="0.1"/></body>'
        for name, more in joints.items()
    )
    bonds = '<equality><joint joint1="at_zero" joint2="turned"/></equality>'
    angle = '<compiler angle="radian" autolimits="true"/>'
    file.write_text(f"<mujoco>{angle}<worldbody>{bodies}</worldbody>{bonds}</mujoco>")
    assert convert(file).start == {"beyond": 1.0, "turned": 0.4}


@pytest.mark.parametrize(
    "change, says",
    [
        ((' name="pin"', ""), "a joint has no name"),
        (("<worldbody>", '<option gravity="0 0 -1.6"/><worldbody>'), "gravity"),
        (
            (
                "<equality>",
                '<tendon><fixed name="t"><joint joint="hip" coef="1"/></fixed></tendon>'
                '<equality><tendon name="j" tendon1="t"/>',
            ),
            "'j' (tendon)",
        ),
        ((' body2="shank"', ""), "degrees of freedom"),
    ],
)
def test_what_is_no_mechanism_is_said_of_the_users_file(
    tmp_path: Path, change: tuple[str, str], says: str
) -> None:
    file = _file(tmp_path, "bodies")
    file.write_text(file.read_text().replace(*change))
    with pytest.raises(InputError) as refusal:
        import_model(_with(file), _DRIVES, tmp_path / "own.toml")
    assert says in str(refusal.value) and "machine.xml" in str(refusal.value)
    assert list(tmp_path.iterdir()) == [file]


def test_the_machine_itself_is_never_written_over(tmp_path: Path) -> None:
    file = _file(tmp_path, "bodies")
    with pytest.raises(InputError, match="overwrite it"):
        import_model(_with(file), _DRIVES, tmp_path / "machine.toml", force=True)
    assert file.read_text() == _LEG.format(loop=_LOOPS["bodies"])


def test_gravity_as_some_files_round_it_is_said_and_taken(tmp_path: Path) -> None:
    file = _file(tmp_path, "bodies")
    file.write_text(file.read_text().replace("<worldbody>", '<option gravity="0 0 -9.806"/><worldbody>'))
    assert "gravity of 9.806 m/s^2 is taken as 9.81" in contents_of(file).bonds
    import_model(_with(file), _DRIVES, tmp_path / "own.toml")
