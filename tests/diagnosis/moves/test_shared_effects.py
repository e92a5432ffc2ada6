"""Slides that were built alike and lack friction alike: no single axis explains much of it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

from tests.diagnosis.rig import asked
from workbench.core import Controller, EffectKey, Estimate, Recording
from workbench.diagnosis.data import Data, gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Fit, Hypothesis
from workbench.diagnosis.moves.add import grown
from workbench.diagnosis.moves.restarts import on_all_axes
from workbench.diagnosis.moves.shared_effects import needed, shared_effects
from workbench.diagnosis.node import Node
from workbench.diagnosis.search_result import AcceptedStep
from workbench.effects import load_model
from workbench.models import AppliedEffect, Model

_MASS = np.array([4.0, 2.0, 1.0, 0.5])
_KP, _KD, _STEP = 400.0 * _MASS, 40.0 * _MASS, 0.002
_AXES = ("x", "y", "z", "u")
_BODY = """<body><joint name="{name}" type="slide" axis="{axis}"/>
<inertial pos="0 0 0" mass="{mass}" diaginertia="1 1 1"/></body>"""


@cache
def gantry(slides: int = 3) -> Model:
    """Slides side by side, without any friction and gravity."""
    ways = ("1 0 0", "0 1 0", "0 0 1", "1 0 0")
    parts = list(zip(_AXES, ways, _MASS, strict=True))[:slides]
    bodies = "".join(_BODY.format(name=n, axis=a, mass=m) for n, a, m in parts)
    file = Path(mkdtemp()) / "gantry.xml"
    file.write_text(f'<mujoco><option gravity="0 0 0"/><worldbody>{bodies}</worldbody></mujoco>')
    return load_model(str(file))


def played(
    name: str,
    seed: int,
    coulomb: Sequence[float],
    damping: Sequence[float],
    hum: float | np.ndarray = 0.0,
    spring: float = 0.0,
) -> Recording:
    """The slides under PD in small steps, with dry friction that holds where it can, in a `hum` of 3 Hz.

    `spring`: of the first [N/m].
    """
    slides = len(coulomb)
    mass, kp, kd = _MASS[:slides], _KP[:slides], _KD[:slides]
    generator, t = np.random.default_rng(seed), np.arange(1500) * _STEP
    rise = np.minimum(t / 0.3, 1.0)[:, None]
    tones = 0.4 + 0.5 * np.arange(8)[:, None, None] + 0.1 * np.arange(slides)
    phases = generator.uniform(0.0, 2.0 * np.pi, (8, 1, slides))
    reference = 0.05 * rise**2 * np.sin(2.0 * np.pi * tones * t[:, None] + phases).sum(axis=0)
    reference -= reference[0]
    q, w, fine = np.zeros(slides), np.zeros(slides), 40
    rows, stiffness = [], spring * np.eye(slides)[0]
    for now, r in zip(t, reference, strict=True):
        pushed = hum * np.sin(2.0 * np.pi * 3.0 * now + np.arange(slides))
        seen = q + 2e-6 * generator.standard_normal(slides), w + 2e-4 * generator.standard_normal(slides)
        force = kp * (r - seen[0]) - kd * seen[1]
        rows.append([*seen, force, force + 0.02 * mass * generator.standard_normal(slides), r])
        for _ in range(fine):
            h, before = _STEP / fine, w
            drag = 0.5 * h / mass * np.asarray(damping)
            w = ((1.0 - drag) * w + h / mass * (force + pushed - stiffness * q)) / (1.0 + drag)
            w = np.sign(w) * np.maximum(np.abs(w) - h / mass * np.asarray(coulomb), 0.0)
            q = q + 0.5 * h * (before + w)
    names = ("position", "velocity", "torque_command", "torque_measured", "position_reference")
    signals = {n: np.array([row[k] for row in rows]) for k, n in enumerate(names)}
    loop = Controller("pd", "actuator", kp=tuple(kp), kd=tuple(kd), period_s=_STEP)
    return Recording(name, _AXES[:slides], "actuator", t, signals, ("m",) * slides, controller=loop)


def found(
    coulomb: Sequence[float], damping: Sequence[float], hum: float | np.ndarray = 0.0
) -> tuple[AcceptedStep, ...]:
    """What is found on every axis of the slides."""
    recordings = [played(f"r{k}", k, coulomb, damping, hum) for k in range(3)]
    return shared_effects(asked(gantry(len(coulomb)), recordings[:2], recordings[2:]))


def test_damping_on_every_axis_is_found_with_each_axis_s_own() -> None:
    steps = found((0.0, 0.0, 0.0), (12.0, 5.0, 2.0))
    assert {s.added.effect for s in steps} == {"viscous_damping"}
    values = {a.key.axis: a.values["damping"] for a in steps[-1].fit.hypothesis.free}
    assert np.allclose([values[axis] for axis in _AXES[:3]], [12.0, 5.0, 2.0], rtol=0.03)


def test_damping_and_dry_friction_on_every_axis_are_two_causes() -> None:
    steps = found((1.5, 0.8, 0.4), (6.0, 3.0, 1.5))
    assert {s.added.effect for s in steps} == {"viscous_damping", "coulomb_friction"}
    free = steps[-1].fit.hypothesis.free
    torque = {a.key.axis: a.values["torque"] for a in free if a.key.effect == "coulomb_friction"}
    assert np.allclose([torque[axis] for axis in _AXES[:3]], [1.5, 0.8, 0.4], rtol=0.05)


def test_more_may_be_missing_beside_one_cause_on_every_axis() -> None:
    runs = [played(f"r{k}", k, (0.0, 0.0, 0.0), (12.0, 5.0, 2.0), spring=60.0) for k in range(3)]
    problem = asked(gantry(), runs[:2], runs[2:])
    (begun,) = on_all_axes(Node(problem.start, problem.data), problem)
    assert {k.effect for k in begun.keys} == {"viscous_damping"} and not begun.done
    end = grown(begun, problem)
    assert end.keys - begun.keys == {EffectKey("parallel_spring", "x")} and end.done


def test_an_axis_that_does_well_without_is_left_out() -> None:
    steps = found((0.0, 0.0, 0.0), (12.0, 0.0, 2.0))
    assert {(s.added.effect, s.added.axis) for s in steps} == {
        ("viscous_damping", "x"),
        ("viscous_damping", "z"),
    }


def test_what_stays_unexplained_beside_it_leaves_no_axis_out() -> None:
    steps = found((1.5, 0.8, 0.4), (6.0, 3.0, 1.5), hum=0.4)
    named = {(s.added.effect, s.added.axis) for s in steps}
    assert named == {(e, a) for e in ("viscous_damping", "coulomb_friction") for a in _AXES[:3]}
    excess = float(np.prod([1.0 - s.removed_share for s in steps]))
    assert 0.005 < excess < 0.05, "far above the noise, and little of the whole"


def test_nothing_is_found_in_what_lacks_nothing() -> None:
    assert found((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) == ()


def fitted(*effects: tuple[str, str]) -> tuple[Fit, Data]:
    """Slides with damping and a hum, explained by effects on all three of them."""
    recordings = [played(f"r{k}", k, (0.0, 0.0, 0.0), (12.0, 5.0, 2.0), hum=0.1) for k in range(2)]
    data, _ = gather(gantry(), recordings, [], 0)
    free = tuple(
        AppliedEffect(EffectKey(effect, axis), {parameter: Estimate(0.0, 0.0, "")})
        for effect, parameter in effects
        for axis in _AXES[:3]
    )
    (whole,) = fit([Hypothesis(gantry(), free)], data)
    assert whole is not None
    return whole, data


def test_effects_without_which_little_more_stays_are_left_out() -> None:
    whole, data = fitted(("viscous_damping", "damping"), ("reflected_inertia", "inertia"))
    effects = [a.key.effect for a in needed(whole, data).hypothesis.free]
    assert effects == ["viscous_damping"] * 3
