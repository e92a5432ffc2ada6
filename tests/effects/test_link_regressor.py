"""The torque of a link is linear in its ten numbers: with those of the file it is what MuJoCo needs."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.bench_arm import AXES, FAST, bench_arm, logged
from workbench.comparison import replay_of
from workbench.effects import compile_plant, link_regressor, load_model

_WITHOUT = {f"{axis}_{number}": 0.0 for axis in AXES for number in ("armature", "damping")}


def ten_numbers(file: Path, body: str) -> np.ndarray:
    """Mass, first moment and inertia about the body's origin, as MuJoCo compiles them, (10,)."""
    m = mujoco.MjModel.from_xml_path(str(file))
    b, turned = m.body(body), np.zeros(9)
    mujoco.mju_quat2Mat(turned, b.iquat)
    turn, mass, centre = turned.reshape(3, 3), float(b.mass[0]), np.array(b.ipos)
    inertia = turn @ np.diag(b.inertia) @ turn.T
    inertia += mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return np.array([mass, *(mass * centre), *inertia[np.triu_indices(3)]])


@pytest.mark.parametrize("axis_of_turret", [(0.0, 0.0, 1.0), (0.0, 1.0, 0.0)])
def test_with_the_numbers_of_the_file(tmp_path: Path, axis_of_turret: tuple[float, float, float]) -> None:
    turned = dict(zip(("yaw_x", "yaw_y", "yaw_z"), axis_of_turret, strict=True))
    file = bench_arm(tmp_path, fore_across=0.03, turret_mass=4.0, **turned)
    model, log = load_model(file), logged(file, FAST, seconds=3.0)
    replay = replay_of(model, [log])
    motion = replay.motion(compile_plant(model), 0, replay.run([model])[0][0])
    bare = bench_arm(tmp_path, "bare", fore_across=0.03, turret_mass=4.0, **turned, **_WITHOUT)
    needed = motion.required(load_model(bare))
    torque = sum(
        np.tensordot(ten_numbers(file, body), link_regressor(motion, k), axes=1)
        for k, body in enumerate(("turret", "upper", "fore"))
    )
    np.testing.assert_allclose(torque[20:-20], needed[20:-20], atol=2e-3 * np.abs(needed).max())
