"""What becomes of the user's own file when its tree is normalised, and what is said of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.dry_arm import LOSS, dry_arm
from tests.models.make import machine_file
from tests.simulation.make import having
from workbench.core import EffectKey, InputError
from workbench.effects import load_model
from workbench.s3n import normalise, write_normalised

from .dynamics import same_dynamics


def test_the_users_own_elements_stay(tmp_path: Path) -> None:
    model = load_model(machine_file(tmp_path))
    tree = normalise(model, integrator=None)
    m = tree.mujoco
    before = mujoco.MjModel.from_xml_path(str(model.serial))
    for kind, count in (("body", before.nbody), ("geom", before.ngeom), ("site", before.nsite)):
        names = [getattr(m, kind)(i).name for i in range(count)]
        assert names == [getattr(before, kind)(i).name for i in range(count)]
    assert m.tendon_frictionloss[m.tendon("cable").id] == 0.05
    assert m.opt.timestep == 0.004 and m.opt.integrator == before.opt.integrator
    np.testing.assert_array_equal(m.key("home").qpos, [0.5, 0.2, 0.1])
    assert m.nsensor == 1  # the other one measured an actuator that drives replace
    assert any("m_boom" in line for line in tree.removed) and any("sensor" in line for line in tree.removed)
    same_dynamics(model, m)


@pytest.mark.parametrize("where", ["joint", "fixed"])
def test_dry_friction_of_the_users_own_is_written_rigid(tmp_path: Path, where: str) -> None:
    """As the same friction is that was added to a file without it; asked for, it stays as it was."""
    own = load_model(dry_arm(tmp_path, where))
    tree = normalise(own)
    m, soft = tree.mujoco, normalise(replace(own, friction_as_in_mjcf=True)).mujoco
    added = load_model(dry_arm(tmp_path, "none", name="plain"))
    for axis, loss in LOSS.items():
        added = having(added, EffectKey("coulomb_friction", axis), torque=loss)
    like, given = normalise(added).mujoco, mujoco.MjModel.from_xml_path(str(own.serial))
    for name, loss in LOSS.items():
        found = [_friction(x, name, where) for x in (m, given, soft)]
        assert all(f[0] == loss for f in found)
        np.testing.assert_allclose(found[0][1:], _friction(like, name, "joint")[1:])
        np.testing.assert_allclose(found[2], found[1])
    early = [a for a in tree.added if a.quantity == "friction turns early by"]
    assert len(early) == 2
    assert all(a.before == pytest.approx(0.0095) and a.after < 0.002 for a in early)


def _friction(m: mujoco.MjModel, name: str, where: str) -> list[float]:
    """Bound, reference damping and impedance of a joint's friction, or its tendon's."""
    if where == "joint":
        k = m.joint(name).dofadr[0]
        return [m.dof_frictionloss[k], *m.dof_solref[k], *m.dof_solimp[k]]
    k = m.tendon(f"seal_{name}").id
    return [m.tendon_frictionloss[k], *m.tendon_solref_fri[k], *m.tendon_solimp_fri[k]]


def test_meshes_are_found_from_anywhere(tmp_path: Path) -> None:
    (tmp_path / "robot" / "assets").mkdir(parents=True)
    corners = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "robot" / "assets" / "link.obj").write_text(corners)
    (tmp_path / "robot" / "arm.xml").write_text(
        '<mujoco><compiler meshdir="assets" inertiafromgeom="true"/>'
        '<asset><mesh name="link" file="link.obj"/></asset>'
        '<worldbody><body><joint name="j" axis="0 1 0"/><geom type="mesh" mesh="link" mass="0.3333333333"/>'
        "</body></worldbody></mujoco>"
    )
    model = load_model(tmp_path / "robot" / "arm.xml")
    file = write_normalised(normalise(model), tmp_path / "elsewhere" / "arm.xml")
    m = mujoco.MjModel.from_xml_path(str(file))
    assert m.nmesh == 1
    same_dynamics(model, m)


def test_additions_say_what_and_how_much() -> None:
    added = {(a.element, a.quantity): a for a in normalise(load_model("leg"), "s3n_act").added}
    assert added["tendon knee", "armature"].after == 0.0162
    assert added["tendon knee", "armature"].before is None
    assert added["joint hip", "damping"].before == 0.0 and added["joint hip", "damping"].after == 0.0972
    assert added["motor knee", "torque limit"].after == 24.0
    assert not any(element.startswith("body") for element, _ in added)
    full = {(a.element, a.quantity): a for a in normalise(load_model("leg"), "s3n_full").added}
    assert full["body shank", "mass"].before == 0.16


def test_nothing_is_overwritten_and_nothing_half_written(tmp_path: Path) -> None:
    tree = normalise(load_model("leg"))
    file = write_normalised(tree, tmp_path / "leg.xml")
    with pytest.raises(InputError, match="--force"):
        write_normalised(tree, file)
    write_normalised(tree, file, force=True)
    assert list(tmp_path.iterdir()) == [file]
