"""A machine whose loop is stable because of what its model lacks: a heavy rotor, and friction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from workbench.core import Controller, Recording, SimulationError
from workbench.models import Model

_TICK, _FINE = 0.03, 60  # s; steps of the simulation in one
_LINK, _ROTOR, _RUBBING = 0.0005, 0.006, 0.08  # kg m^2, kg m^2, N m
_INERTIA, _WEIGHT = _LINK + 0.2 * 0.05**2 + _ROTOR, 0.2 * 9.81 * 0.05  # kg m^2, N m
_KP, _KD = 4.0, 0.2
_STEP = 4e-4  # rad, of the encoder


@pytest.fixture
def wrist(tmp_path: Path) -> Model:
    (tmp_path / "wrist.xml").write_text(
        '<mujoco><worldbody><body><joint name="w" axis="0 1 0"/>'
        f'<inertial pos="0 0 -0.05" mass="0.2" diaginertia="{_LINK} {_LINK} {_LINK}"/>'
        "</body></worldbody></mujoco>"
    )
    return wb.load_model(str(tmp_path / "wrist.xml"))


def turned(seed: int, seconds: float = 40.0, sign: float = 1.0) -> Recording:
    """The wrist along a sum of sines, its torque measured; `sign` of the torque that its log states."""
    rng = np.random.default_rng(seed)
    t = np.arange(round(seconds / _TICK)) * _TICK
    ease = np.clip(t / 3.0, 0.0, 1.0) ** 2
    waves = [
        a * np.sin(2 * np.pi * f * t + rng.uniform(0, 6)) for a, f in ((0.5, 0.2), (0.2, 0.55), (0.1, 1.7))
    ]
    reference = ease * np.sum(waves, axis=0)
    q = w = 0.0
    rows = []
    for r in reference:
        at = _STEP * np.round(q / _STEP)
        u = _KP * (r - at) - _KD * w
        rows.append((at, w, r, u, sign * u + rng.normal(0, 0.005)))
        h = _TICK / _FINE
        for _ in range(_FINE):
            free = w + h * (u - _WEIGHT * np.sin(q)) / _INERTIA
            w = np.sign(free) * max(0.0, abs(free) - h * _RUBBING / _INERTIA)
            q += h * w
    names = ("position", "velocity", "position_reference", "torque_command", "torque_measured")
    signals = {n: column[:, None] for n, column in zip(names, np.array(rows).T, strict=True)}
    signals["torque_command"] = sign * signals["torque_command"]
    loop = Controller("pd", "actuator", kp=(_KP,), kd=(_KD,), period_s=_TICK)
    return Recording(f"turned {seed}", ("w",), "actuator", t, signals, ("rad",), controller=loop)


def test_what_keeps_a_loop_stable_is_found_without_the_loop(wrist: Model) -> None:
    logs, judging = [turned(1), turned(2)], turned(3)
    with pytest.raises(SimulationError, match="unstable"):
        wb.compare(wrist, logs)
    node, better = wb.improve(wrist, logs, [judging])
    found = {s.key.effect: s.parameters for s in node.steps}
    assert found["coulomb_friction"]["torque"].value == pytest.approx(_RUBBING, rel=0.1)
    assert found["reflected_inertia"]["inertia"].value == pytest.approx(_ROTOR, rel=0.25)
    assert any("unstable in the loop" in note for note in node.notes)
    assert wb.compare(better, [judging]).error < 0.5, "it runs in the loop now"


def test_a_loop_that_nothing_explains_is_said_to_be_unstable(wrist: Model) -> None:
    with pytest.raises(SimulationError, match="unstable"):
        wb.diagnose(wrist, [turned(1, sign=-1.0)])


def test_a_loop_without_a_torque_is_said_to_be_unstable(wrist: Model) -> None:
    log = turned(1)
    bare = {n: x for n, x in log.signals.items() if not n.startswith("torque")}
    with pytest.raises(SimulationError, match="unstable"):
        wb.diagnose(wrist, [replace(log, signals=bare)])
