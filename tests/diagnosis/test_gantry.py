"""Two linear axes, one on the other: a mass that both carry is one number, not a rotor of each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from workbench.core import Controller, Diagnosis, Recording
from workbench.diagnosis import diagnose
from workbench.effects import load_model

MODEL = """<mujoco model="gantry"><worldbody><body name="bridge">
<joint name="x" type="slide" axis="1 0 0" armature="6" damping="40" frictionloss="20"/>
<inertial pos="0 0 0" mass="12" diaginertia="0.5 0.5 0.5"/>
<body name="carriage"><joint name="y" type="slide" axis="0 1 0" armature="5" damping="30" frictionloss="14"/>
<inertial pos="0 0 0" mass="4" diaginertia="0.05 0.05 0.05"/>{site}</body></body></worldbody></mujoco>"""
SITE = '<site name="tool" pos="0 0 -0.1"/>'
PERIOD, STEPS = 0.002, 20
LOOP = Controller("pd", "joint", kp=(9000.0, 6000.0), kd=(500.0, 350.0), period_s=PERIOD)


def made(seed: int, carried: float) -> Recording:
    """A log of the machine with so much on its carriage [kg], by small steps of two masses."""
    generator = np.random.default_rng(seed)
    t = np.arange(0.0, 4.0, PERIOD)
    f, p = generator.uniform(0.2, 1.2, (2, 4)), generator.uniform(0.0, 6.28, (2, 4))
    waves = [np.sin(2 * np.pi * np.outer(t, own) + at) - np.sin(at) for own, at in zip(f, p, strict=True)]
    reference = 0.01 * np.stack([w.sum(axis=1) for w in waves], axis=1)
    mass, damping = np.array([22.0, 9.0]) + carried, np.array([40.0, 30.0])
    q, w, rows, h = np.zeros(2), np.zeros(2), [], PERIOD / STEPS
    for wanted in reference:
        at, speed = q + generator.normal(0.0, 1e-5, 2), w + generator.normal(0.0, 1e-3, 2)
        force = np.array(LOOP.kp) * (wanted - at) - np.array(LOOP.kd) * speed
        rows.append((at, speed, force, force + generator.normal(0.0, 0.5, 2)))
        for _ in range(STEPS):
            middle = w + 0.5 * h * (force - damping * w) / mass
            w = w + h * (force - damping * middle) / mass
            w = np.sign(w) * np.maximum(np.abs(w) - h * np.array([20.0, 14.0]) / mass, 0.0)
            q = q + h * middle
    names = "position", "velocity", "torque_command", "torque_measured"
    signals = {name: np.stack([row[k] for row in rows]) for k, name in enumerate(names)}
    signals["position_reference"] = reference
    return Recording(f"made_{seed}", ("x", "y"), "joint", t, signals, ("m", "m"), LOOP)


def told(folder: Path, site: str, carried: float) -> Diagnosis:
    file = folder / "gantry.xml"
    file.write_text(MODEL.format(site=site))
    logs = [made(seed, carried) for seed in range(3)]
    return diagnose(load_model(file), logs[:2], logs[2:])


def test_a_payload_is_one_mass(tmp_path: Path) -> None:
    (finding,) = told(tmp_path, SITE, 1.5).findings
    assert finding.key.effect == "payload_mass"
    assert finding.parameters["mass"].value == pytest.approx(1.5, rel=0.02)


def test_a_wrong_mass_of_the_carriage_is_one_number(tmp_path: Path) -> None:
    (finding,) = told(tmp_path, "", -1.2).findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "y")
    assert finding.total is not None and finding.total.value == pytest.approx(2.8, rel=0.02)
