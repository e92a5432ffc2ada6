"""A motor's ripple has several harmonics: each is named where the motion covers several periods of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from workbench import diagnose
from workbench.core import Controller, Diagnosis, Recording
from workbench.effects import load_model

_ROTOR = """<mujoco><worldbody><body><joint name="motor" axis="0 0 1" armature="0.002"/>
<inertial pos="0 0 0" mass="0.1" diaginertia="0.0005 0.0005 0.0005"/></body></worldbody></mujoco>"""
_INERTIA = 0.0025


def turned(name: str, seed: int, ripples: dict[float, float], turns: float) -> Recording:
    """A rotor moved to and fro by hand over some turns, its torque measured."""
    random, t = np.random.default_rng(seed), np.arange(4000) * 0.005
    reach, f = np.pi * turns, 0.21 + 0.04 * random.random()
    phase = 2 * np.pi * f * t + random.random()
    q = reach * np.sin(phase)
    w = reach * 2 * np.pi * f * np.cos(phase)
    a = -reach * (2 * np.pi * f) ** 2 * np.sin(phase)
    torque = _INERTIA * a + 0.05 * w + 0.1 * np.sign(w)
    torque -= sum(size * np.sin(order * q + order) for order, size in ripples.items())
    signals = {
        "position": q + 1e-4 * random.standard_normal(t.shape),
        "velocity": w + 1e-3 * random.standard_normal(t.shape),
        "torque_measured": torque + 0.01 * random.standard_normal(t.shape),
    }
    return Recording(
        name, ("motor",), "actuator", t, {k: v[:, None] for k, v in signals.items()}, ("rad",), Controller()
    )


def asked(tmp_path: Path, ripples: dict[float, float], turns: float) -> Diagnosis:
    file = tmp_path / "rotor.xml"
    file.write_text(_ROTOR, "utf-8")
    logs = [turned(name, k, ripples, turns) for k, name in enumerate(("one", "two", "three"))]
    return diagnose(load_model(file), logs[:2], logs[2:])


def test_each_harmonic_is_named_with_its_size(tmp_path: Path) -> None:
    hidden = {7.0: 0.8, 14.0: 0.2, 28.0: 0.3}
    found = asked(tmp_path, hidden, 1.2)
    sizes = {
        round(f.parameters["order"].value, 1): f.parameters["torque"].value
        for f in found.findings
        if f.key.effect == "cogging"
    }
    assert found.verdict == "missing_effect"
    assert sizes == {order: pytest.approx(size, rel=0.1) for order, size in hidden.items()}
    assert {f.key.effect for f in found.findings} == {"cogging", "viscous_damping", "coulomb_friction"}


def test_on_a_short_way_a_sum_of_sines_is_no_cause(tmp_path: Path) -> None:
    found = asked(tmp_path, {2.0: 0.5, 3.1: 0.4}, 0.3)
    assert sum(f.key.effect == "cogging" for f in found.findings) <= 1
