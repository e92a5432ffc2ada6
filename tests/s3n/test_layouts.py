"""From a robot of any collection to one plain MJCF and back: nothing is lost, what cannot be done is said."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.cli.here import run
from tests.s3n.layouts import LAYOUTS, REFUSED, lay_out

_COUNTS = """nbody njnt ngeom nsite nmesh ntex nhfield nkey ncam nlight neq nexclude nmocap ntendon"""
_NUMBERS = """jnt_range jnt_limited jnt_actfrcrange jnt_actfrclimited jnt_stiffness jnt_user qpos0
qpos_spring dof_damping dof_armature dof_frictionloss body_mass body_gravcomp geom_size geom_pos geom_contype
geom_conaffinity geom_friction geom_rgba site_pos key_qpos key_qvel tendon_stiffness numeric_data mesh_vert
cam_pos"""


def _same(own: mujoco.MjModel, new: mujoco.MjModel) -> None:
    """The new tree has all that the user's had, and moves alike without its motors."""
    for name in _COUNTS.split():
        assert getattr(new, name) == getattr(own, name), name
    for name in _NUMBERS.split():
        np.testing.assert_allclose(getattr(new, name), getattr(own, name), atol=1e-9, err_msg=name)
    assert new.opt.timestep == own.opt.timestep and new.opt.disableflags == own.opt.disableflags
    np.testing.assert_allclose(new.opt.gravity, own.opt.gravity)
    generator = np.random.default_rng(1)
    for _ in range(3):
        q, v, a = own.qpos0 + generator.uniform(-0.3, 0.3, own.nq), *generator.uniform(-2, 2, (2, own.nv))
        torques = []
        for m in (own, new):
            m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
            m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
            data = mujoco.MjData(m)
            data.qpos[:], data.qvel[:], data.qacc[:] = q, v, a
            mujoco.mj_inverse(m, data)
            torques.append(data.qfrc_inverse.copy())
        np.testing.assert_allclose(torques[1], torques[0], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", LAYOUTS)
def test_a_layout_comes_back_whole(name: str, tmp_path: Path) -> None:
    file = lay_out(tmp_path / "robot", LAYOUTS[name])
    for place in ("robot/n.xml", "elsewhere/n.xml"):
        done = run("normalize", file, "-o", place, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert "-> 0" not in done.stdout and str(tmp_path) not in (tmp_path / place).read_text()
        _same(*(mujoco.MjModel.from_xml_path(str(path)) for path in (file, tmp_path / place)))
    # a folder that is handed on has all that its file names
    (tmp_path / "elsewhere").rename(tmp_path / "handed on")
    checked = run("check", "handed on/n.xml", "--samples", 3, cwd=tmp_path)
    assert checked.returncode == 0, checked.stderr + checked.stdout
    again = run("normalize", "handed on/n.xml", "-o", "again.xml", cwd=tmp_path)
    assert again.returncode == 0, again.stderr


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_normalised_is_named_in_one_line(name: str, tmp_path: Path) -> None:
    text, says = REFUSED[name]
    done = run("normalize", lay_out(tmp_path, text), "-o", tmp_path / "n.xml", cwd=tmp_path)
    assert done.returncode == 2 and not (tmp_path / "n.xml").exists()
    assert says in done.stderr and done.stderr.count("\n") == 1


def test_limits_of_the_files_actuators_are_said_to_be_left_out(tmp_path: Path) -> None:
    done = run("normalize", lay_out(tmp_path, LAYOUTS["actuators of all kinds"]), "-o", "n.xml", cwd=tmp_path)
    said = " ".join(done.stdout.split())
    assert "torque limit" not in said
    assert "limits of the MJCF's actuators on hip, knee are left out" in said


def test_a_copied_mesh_is_not_overwritten_unasked(tmp_path: Path) -> None:
    file = lay_out(tmp_path / "robot", LAYOUTS["meshdir"])
    assert run("normalize", file, "-o", "out/n.xml", cwd=tmp_path).returncode == 0
    (copy,) = (tmp_path / "out").rglob("*.obj")
    copy.write_text("mine")
    (tmp_path / "out" / "n.xml").unlink()
    done = run("normalize", file, "-o", "out/n.xml", cwd=tmp_path)
    assert done.returncode == 2 and "shell.obj" in done.stderr
    assert copy.read_text() == "mine" and not (tmp_path / "out" / "n.xml").exists()
