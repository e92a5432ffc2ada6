"""A payload whose centre is off its site: its torques are those of MuJoCo, and it is found with its size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.comparison import replay_of
from workbench.core import EffectKey, Estimate, Recording
from workbench.diagnosis import diagnose
from workbench.effects import Motion, compile_plant, effect_named, load_model
from workbench.models import AppliedEffect, Model

_SITE = '<site name="tip" pos="0.3 0 0"/>'
_PAYLOAD = effect_named("payload_mass")


def _turned(folder: Path) -> Model:
    """The arm with a site that is turned in its body."""
    file = bench_arm(folder)
    file.write_text(file.read_text().replace(_SITE, '<site name="tip" pos="0.3 0 0" euler="0.3 -0.4 0.5"/>'))
    return load_model(file)


def _moving(model: Model, seconds: float = 3.0) -> Motion:
    log = logged(model.serial, FAST, seconds=seconds)
    replay = replay_of(model, [log])
    return replay.motion(compile_plant(model), 0, replay.run([model])[0][0])


def _needed(motion: Motion, model: Model, **values: float) -> np.ndarray:
    parameters = {name: Estimate(value, 0.0, "") for name, value in values.items()}
    return motion.required(model.with_effect(AppliedEffect(EffectKey("payload_mass", None), parameters)))


def test_columns_are_what_mass_and_moment_change(tmp_path: Path) -> None:
    """Of a kilogram with moments either way the inertia is the same: their difference is the moment alone."""
    model = _turned(tmp_path)
    motion = _moving(model)
    point, off = _PAYLOAD.parameters.shapes([motion], model, None)
    columns = _PAYLOAD.response(motion, model, None, off).columns
    slopes = [(_needed(motion, model, mass=1e-3) - motion.required(model)) / 1e-3]
    for name in ("moment_x", "moment_y", "moment_z"):
        pair = [_needed(motion, model, mass=1.0, **{name: h}) for h in (1e-3, -1e-3)]
        slopes.append((pair[0] - pair[1]) / 2e-3)
    pair = [_needed(motion, model, mass=1.0, inertia=i) for i in (0.02, 0.01)]
    slopes.append((pair[0] - pair[1]) / 0.01)
    assert len(columns) == len(slopes)
    for column, slope in zip(columns, slopes, strict=True):
        np.testing.assert_allclose(-column[20:-20], slope[20:-20], atol=2e-3 * np.abs(slope).max())
    np.testing.assert_array_equal(_PAYLOAD.response(motion, model, None, point).columns, columns[:1])


def test_values_and_coefficients_are_each_others_inverse(tmp_path: Path) -> None:
    model = _turned(tmp_path)
    for shape in _PAYLOAD.parameters.shapes([_moving(model, 1.0)], model, None):
        count = len(_PAYLOAD.parameters.linear_of(shape))
        values = _PAYLOAD.parameters.to_values(np.arange(1.0, count + 1.0), shape)
        coefficients, back = _PAYLOAD.parameters.to_coefficients(values)
        assert (coefficients.tolist(), back) == (list(range(1, count + 1)), dict(shape))


_FLAT = """<mujoco><worldbody><body><joint name="swing" axis="0 1 0"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
<body pos="0.3 0 0"><joint name="knee" axis="0 1 0"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><site name="tip" pos="0.2 0 0"/></body>
</body></worldbody></mujoco>"""


def test_a_moment_that_no_motion_shows_is_not_asked(tmp_path: Path) -> None:
    """Nothing moves a planar arm sideways."""
    file = tmp_path / "flat.xml"
    file.write_text(_FLAT)
    model, t = load_model(file), 0.002 * np.arange(1500)
    q = np.stack([0.6 * np.sin(5.0 * t), 0.5 * np.cos(7.0 * t)], axis=1)
    log = Recording(
        "log", ("swing", "knee"), "joint", t, {"position": q, "torque_measured": 0.1 * q}, ("rad",) * 2
    )
    replay = replay_of(model, [log])
    motion = replay.motion(compile_plant(model), 0, replay.run([model])[0][0])
    point, off = _PAYLOAD.parameters.shapes([motion], model, None)
    names = [u.name for u in _PAYLOAD.parameters.linear_of(off)]
    assert (dict(point), names) == ({}, ["mass", "moment_x", "moment_z", "inertia"])


@pytest.mark.parametrize(("x", "z", "own"), [(0.0, 0.0, 0.0), (0.06, 0.09, 4e-4)])
def test_what_hangs_on_the_tip_is_found_with_its_centre(
    tmp_path: Path, x: float, z: float, own: float
) -> None:
    machine, ball = bench_arm(tmp_path, "machine"), " ".join(3 * [str(own or 1e-9)])
    hung = f'<body pos="0.3 0 0"><inertial pos="{x} 0 {z}" mass="0.8" diaginertia="{ball}"/></body>'
    machine.write_text(machine.read_text().replace(_SITE, hung + _SITE))
    logs = [logged(machine, tones, seconds=6.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    result = diagnose(load_model(bench_arm(tmp_path)), logs)
    (found,) = result.findings
    assert (result.verdict, found.key) == ("missing_effect", EffectKey("payload_mass", None))
    truth = {"mass": 0.8, "moment_x": 0.8 * x, "moment_z": 0.8 * z, "inertia": own}
    for name, value in found.parameters.items():
        assert value.value == pytest.approx(truth.get(name, 0.0), abs=3.0 * value.std)
    assert set(found.parameters) == ({*truth, "moment_y"} if own else {"mass"})
