"""A robot as MJCF with `connect` and the same robot as URDF with its loop named give the same S3N."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.cli.here import run
from tests.importing.leg_urdf import urdf_of_a_leg
from workbench.models import Model, read_model
from workbench.s3n import NormalisedTree, PostureDependent, compiled_dynamics, normalise
from workbench.s3n.posture_fitted import fit_native

#: Of each link: mass [kg], height of its centre [m], inertia across and along [kg m^2].
_LINKS = {
    "thigh": (1.1, -0.1, 4e-3, 4e-4), "shank": (0.3, -0.08, 2e-3, 2e-4),
    "crank": (0.08, 0.02, 1e-4, 1e-5), "rod": (0.06, -0.1, 2e-4, 2e-5),
}  # fmt: skip
_RANGES = {"hip": (-0.8, 0.8), "motor": (-2.0, 3.0), "knee": (0.7, 1.9), "rod_pin": (-4.0, 4.0)}
_ROTOR, _DRAG, _DRY, _LIMIT = 0.016, 0.05, 0.2, 20.0


def _mjcf(rod: float) -> str:
    def inertial(name: str) -> str:
        m, z, i, k = _LINKS[name]
        return f'<inertial pos="0 0 {z}" mass="{m}" diaginertia="{i} {i} {k}"/>'

    drive = f'axis="0 -1 0" armature="{_ROTOR}" damping="{_DRAG}" frictionloss="{_DRY}"'
    return f"""<mujoco model="own"><compiler angle="radian"/><worldbody>
<body name="thigh"><joint name="hip" {drive} range="-0.8 0.8"/>{inertial("thigh")}
<body name="shank" pos="0 0 -0.2"><joint name="knee" axis="0 -1 0" range="0.7 1.9"/>{inertial("shank")}
<site name="arm_end" pos="0 0 0.05"/><body name="toe" pos="0 0 -0.25"/></body></body>
<body name="crank"><joint name="motor" {drive} range="-2 3"/>{inertial("crank")}
<body name="rod" pos="0 0 0.05"><joint name="pin" axis="0 -1 0" range="-4 4"/>{inertial("rod")}
<site name="rod_end" pos="0 0 -{rod}"/></body></body>
</worldbody><equality><connect site1="rod_end" site2="arm_end"/></equality><actuator>
<motor joint="hip" ctrlrange="-{_LIMIT} {_LIMIT}"/><motor joint="motor" ctrlrange="-{_LIMIT} {_LIMIT}"/>
</actuator></mujoco>"""


def _imported(folder: Path, rod: float) -> list[Model]:
    words = ["--drive", "hip", "--drive", "motor", "--joint", "hip", "--joint", "knee", "--foot", "toe"]
    drives = ["--rotor-inertia", str(_ROTOR), "--torque-limit", str(_LIMIT)]  # all that a URDF cannot say
    dynamics = f'<dynamics damping="{_DRAG}" friction="{_DRY}"/>'
    own = {
        "one.urdf": (urdf_of_a_leg(rod, _RANGES, dynamics), ["--loop", "rod_end:arm_end", *drives]),
        "other.xml": (_mjcf(rod), []),
    }
    found = []
    for name, (text, more) in own.items():
        file = folder / name
        file.write_text(text)
        model = folder / f"{file.stem}_model.toml"
        done = run("import", file, *words, *more, "--start", "knee=1.0", "-o", model, "--quiet")
        assert done.returncode == 0, done.stderr
        found.append(read_model(model))
    return found


def _postures(model: Model) -> np.ndarray:
    assert model.closed_chain is not None
    low, high = np.array(model.closed_chain.limits).T
    return np.random.default_rng(3).uniform(low, high, (20, 2))


def _dynamics(tree: NormalisedTree, q: np.ndarray) -> dict[str, np.ndarray]:
    v = np.random.default_rng(4).normal(size=q.shape)
    return vars(compiled_dynamics(mujoco.MjModel.from_xml_string(tree.xml), tree.model.joints, q, v))


def test_where_j_is_constant(tmp_path: Path) -> None:
    one, other = _imported(tmp_path, 0.2)
    assert not one.posture_dependent and not other.posture_dependent
    assert other.transmission == pytest.approx(one.transmission)
    for each in (one, other):
        assert each.actuators.damping == pytest.approx((_DRAG, _DRAG))
        assert [(e.key.axis, e.values) for e in each.effects] == [(a, {"torque": _DRY}) for a in each.axes]
    q = _postures(one)
    first, second = (_dynamics(normalise(each, "s3n_full"), q) for each in (one, other))
    for key, value in first.items():
        np.testing.assert_allclose(second[key], value, atol=1e-7, rtol=1e-7, err_msg=key)


def test_where_j_changes_with_the_posture(tmp_path: Path) -> None:
    one, other = _imported(tmp_path, 0.203)
    assert one.posture_dependent and other.posture_dependent
    q = _postures(one)
    exact, again = (vars(PostureDependent(each).at(q)) for each in (one, other))
    for key, value in exact.items():
        np.testing.assert_allclose(again[key], value, atol=1e-7, err_msg=key)
    # what is written as plain MJCF is a fit, which does not depend on how a file rounds
    first, second = fit_native(one), fit_native(other)
    inertia = np.linalg.eigvals(np.linalg.solve(_dynamics(first, q)["mass"], _dynamics(second, q)["mass"]))
    assert np.abs(inertia - 1.0).max() < 1e-4
