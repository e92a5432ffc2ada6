"""A link that no other axis moves, whose file states no rotor: its inertia or mass may be wrong both ways."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Controller, Recording
from workbench.diagnosis import diagnose, improve
from workbench.effects import load_model
from workbench.models import Model

_STEP, _INERTIA, _GRAVITY = 0.002, 0.15, 3.0
_PENDULUM = """<mujoco><worldbody><body><joint name="shoulder" axis="0 1 0"/>
<inertial pos="0 0 -0.25" mass="{mass}" diaginertia="{own} {own} {own}"/></body></worldbody></mujoco>"""

_CART = """<mujoco><worldbody><body><joint name="shoulder" type="slide" axis="1 0 0" damping="0.4"/>
<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/></body></worldbody></mujoco>"""


def _model(folder: Path, inertia: float) -> Model:
    mass = _GRAVITY / (0.25 * 9.81)
    file = folder / f"pendulum_{inertia}.xml"
    file.write_text(_PENDULUM.format(mass=mass, own=inertia - mass * 0.0625))
    return load_model(file)


def _cart(folder: Path, mass: float) -> Model:
    file = folder / "cart.xml"
    file.write_text(_CART.format(mass=mass))
    return load_model(file)


def _swung(name: str, seed: int, gravity: float = _GRAVITY, damping: float = 0.0) -> Recording:
    """A pendulum along a motion, with the torque that this takes; who closed the loop is not known.

    Without gravity a cart of that many kilograms takes the same force.
    """
    generator, t = np.random.default_rng(seed), np.arange(4000) * _STEP
    tones, phase = np.array([0.3, 0.7, 1.1, 1.9]), generator.uniform(0.0, 2.0 * np.pi, 4)
    arc, turn = 2.0 * np.pi * tones, 2.0 * np.pi * tones * t[:, None] + phase
    q, w, a = (
        x.sum(axis=1)[:, None]
        for x in (0.4 * np.sin(turn), 0.4 * arc * np.cos(turn), -0.4 * arc**2 * np.sin(turn))
    )
    torque = _INERTIA * a + gravity * np.sin(q) + damping * w
    signals = {
        "position": q + 2e-5 * generator.standard_normal(q.shape),
        "velocity": w + 1e-3 * generator.standard_normal(q.shape),
        "torque_measured": torque + 0.01 * generator.standard_normal(q.shape),
    }
    return Recording(name, ("shoulder",), "actuator", t, signals, ("rad",), controller=Controller())


def test_too_much_inertia_is_the_links_with_its_size(tmp_path: Path) -> None:
    """No rotor is less than none: it does not look the same."""
    told = diagnose(_model(tmp_path, 0.30), [_swung(f"r{k}", k) for k in range(2)])
    assert told.verdict == "missing_effect"
    (finding,) = told.findings
    assert str(finding.key) == "link_inertia_error@shoulder"
    assert finding.parameters["inertia"].value == pytest.approx(-0.15, abs=0.002)
    assert finding.probability > 0.9 and not finding.indistinguishable_from


def test_a_right_model_is_consistent(tmp_path: Path) -> None:
    recordings = [_swung(f"r{k}", k) for k in range(2)]
    right = diagnose(_model(tmp_path, _INERTIA), recordings)
    assert right.verdict == "consistent"


def test_what_is_lacking_is_a_rotor(tmp_path: Path) -> None:
    recordings = [_swung(f"r{k}", k) for k in range(2)]
    result, _ = improve(_model(tmp_path, 0.10), recordings)
    assert [str(step.key) for step in result.steps] == ["reflected_inertia@shoulder"]
    assert abs(result.steps[0].parameters["inertia"].value - 0.05) < 0.001


def test_a_cart_that_is_too_heavy_is_told_by_its_mass(tmp_path: Path) -> None:
    recordings = [replace(_swung(f"r{k}", k, 0.0, 0.4), units=("m",)) for k in range(2)]
    told = diagnose(_cart(tmp_path, 0.30), recordings)
    assert told.verdict == "missing_effect"
    (finding,) = told.findings
    assert (str(finding.key), finding.number) == ("first_moment_error@shoulder", "mass")
    assert finding.total is not None and finding.total.value == pytest.approx(_INERTIA, abs=0.002)
    assert not finding.indistinguishable_from
