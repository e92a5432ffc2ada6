"""How dry friction gives way at rest is a matter of simulators, and no fault of a model; its size is one."""

from __future__ import annotations

from math import cos, tanh
from pathlib import Path

import numpy as np
import pytest

from workbench.comparison import compare
from workbench.core import Controller, Recording
from workbench.effects import load_model

_XML = """<mujoco><compiler angle="radian"/><option integrator="implicitfast"/><worldbody><body pos="0 0 1">
<joint name="lift" axis="0 -1 0" damping="0.3" armature="0.05" frictionloss="{}"/>
<inertial pos="0.1 0 0" mass="2" diaginertia="0.004 0.01 0.01"/></body></worldbody></mujoco>"""
_INERTIA, _WEIGHT, _FRICTION, _DAMPING = 0.05 + 0.01 + 2 * 0.1**2, 2 * 9.81 * 0.1, 0.6, 0.3
_KP, _KD, _PERIOD, _STEP = 80.0, 4.0, 0.002, 1e-4
_COUNT = 2 * np.pi / 2**17  # rad


def logged(onset: float) -> Recording:
    """A lever that goes from place to place and rests there, its friction f tanh(w / onset) (RK4)."""
    generator, t = np.random.default_rng(0), np.arange(0.0, 8.0, _PERIOD)
    places = np.array([0.0, 0.5, -0.3, 0.4, 0.1, -0.4, 0.2, 0.6, 0.0])
    part, k = np.modf(t / 1.0)
    u = np.clip(part / 0.6, 0.0, 1.0)
    smooth = u**3 * (10 - 15 * u + 6 * u * u)
    reference = places[k.astype(int)] + np.diff(places)[k.astype(int)] * smooth

    def push(q: float, w: float, torque: float) -> float:
        drag = _FRICTION * tanh(w / onset) + _DAMPING * w
        return (torque - _WEIGHT * cos(q) - drag) / _INERTIA

    q, w, rows = 0.0, 0.0, []
    for wanted in reference:
        seen, speed = round(q / _COUNT) * _COUNT, w + generator.normal(0.0, 2e-3)
        torque = _KP * (wanted - seen) - _KD * speed
        rows.append((seen, speed, torque, torque + generator.normal(0.0, 0.02)))
        for _ in range(round(_PERIOD / _STEP)):
            h, a1 = _STEP, push(q, w, torque)
            w2 = w + 0.5 * h * a1
            a2 = push(q + 0.5 * h * w, w2, torque)
            w3 = w + 0.5 * h * a2
            a3 = push(q + 0.5 * h * w2, w3, torque)
            w4 = w + h * a3
            a4 = push(q + h * w3, w4, torque)
            q, w = q + h / 6 * (w + 2 * w2 + 2 * w3 + w4), w + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    names = "position", "velocity", "torque_command", "torque_measured"
    signals = {n: np.array([[row[i]] for row in rows]) for i, n in enumerate(names)}
    signals["position_reference"] = reference[:, None]
    loop = Controller("pd", "joint", kp=(_KP,), kd=(_KD,), period_s=_PERIOD)
    return Recording("log", ("lift",), "joint", t, signals, ("rad",), loop)


@pytest.mark.parametrize(
    ("onset", "friction", "right"),
    [
        (1e-3, _FRICTION, True),  # creeps by some counts of a fine encoder while it rests
        (1e-3, 0.95 * _FRICTION, False),
        (0.05, _FRICTION, False),  # no dry friction any more
    ],
)
def test_creep_at_rest(onset: float, friction: float, right: bool, tmp_path: Path) -> None:
    file = tmp_path / "lever.xml"
    file.write_text(_XML.format(friction))
    assert compare(load_model(file), [logged(onset)]).consistent is right
