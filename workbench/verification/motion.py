"""Motion: frequency responses at several postures, and a swing under torques, MuJoCo against Drake."""

from __future__ import annotations

import numpy as np

from workbench.core import Check
from workbench.mechanism.linear import linearise
from workbench.mechanism.simulate import simulate
from workbench.s3n import reduced, run_variant

from .states import relative
from .subject import Subject

_POSTURES = 3
_OMEGA = 2.0 * np.pi * np.logspace(-1, 2, 40)  # 0.1 to 100 Hz, as in the paper
_EPS = 1e-4  # rad or m: central differences of gravity err by its square
_ROWS, _PERIOD, _STEP = 150, 0.002, 0.0005  # 0.3 s
_SWING = 20.0  # rad/s^2, what the torques of the swing would do at rest


def frf_check(subject: Subject) -> Check:
    """Speed over torque in drive coordinates at several postures: the exact variant and the closed chain."""
    chain, model = subject.chain, subject.model
    assert chain is not None
    worst, back = 0.0, np.linalg.inv(model.transmission)
    for joints in subject.states.position[:_POSTURES]:
        q = chain.drive_position(joints)
        plant = linearise(chain, q, model.actuators.inertia, model.actuators.damping)
        real = plant.frequency_response(_OMEGA)
        ours = _response(subject, joints, back)
        worst = max(worst, float((np.abs(ours - real) / np.abs(real).max(axis=(1, 2), keepdims=True)).max()))
    allowed = max(1e-6, 10.0 * subject.tolerance)
    return Check("frf", worst, allowed, "", f"MuJoCo, Drake, {_POSTURES} postures")


def _response(subject: Subject, joints: np.ndarray, back: np.ndarray) -> np.ndarray:
    """Speed over torque (F, n, n) of the exact variant about a posture, drive coordinates."""
    n = subject.model.size
    steps = np.concatenate([np.zeros((1, n)), _EPS * np.eye(n), -_EPS * np.eye(n)])
    at = reduced(subject.plants["exact"], joints + steps, np.zeros_like(steps))
    stiffness = -(at.gravity[1 : n + 1] - at.gravity[n + 1 :]).T / (2.0 * _EPS)
    mass, damping, stiffness = (back.T @ x @ back for x in (at.mass[0], at.damping, stiffness))
    s = 1j * _OMEGA[:, None, None]
    return np.linalg.inv(s * mass + damping + stiffness / s)


def motion_check(subject: Subject, seed: int) -> Check:
    """Return a swing of 0.3 s under held random torques about the middle of the workspace."""
    chain, model = subject.chain, subject.model
    assert chain is not None
    joints = np.median(subject.states.position, axis=0)
    q = chain.drive_position(joints)
    plant = linearise(chain, q, model.actuators.inertia, model.actuators.damping)
    generator = np.random.default_rng(seed)
    swing = np.repeat(generator.standard_normal((_ROWS // 15, model.size)), 15, axis=0)
    torque = plant.holding + _SWING * swing @ plant.mass / np.sqrt(model.size)
    real = simulate(
        chain, model.actuators.inertia, model.actuators.damping, torque, _PERIOD, q, substeps=2
    ).position[:-1]
    run = run_variant(
        model, "exact", torque, period=_PERIOD, step=_STEP, start=(joints, np.zeros_like(joints)),
        integrator="RK4",
    )  # fmt: skip
    ours = run.position @ model.transmission.T
    allowed = max(1e-6, 100.0 * subject.tolerance)
    return Check("motion", relative(ours - real, real - real[0]), allowed, "", "MuJoCo, Drake, 0.3 s")
