"""How MuJoCo's friction constraint is made to act like friction with a small creep before sliding."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.models import Model

from .chain import TorqueChain

_LOAD = 0.05  # share of the torque limit that loads a drive at least
_UNLIMITED = 100.0  # N m: what a drive without a limit is taken to have
_STABLE = 1.5  # largest product of rate and step; Runge-Kutta 4 needs less than 2.78


def set_friction_constraints(
    m: mujoco.MjModel, chain: TorqueChain, model: Model, kinds: tuple[str, ...]
) -> None:
    """Choose the constraint's parameters of every tendon that has dry friction.

    Below its bound f the constraint acts like a damper: force = (b d / ((1 - d) A)) w, with A the inverse
    inertia that the tendon feels, d its impedance and b its reference damping (MuJoCo, "Computation",
    solver parameters). The damper is set to f / w_s, so that sliding starts at the model's sliding speed
    w_s; d is taken as small as a stable step allows, where the constraint answers without lag.

    Args:
        m: compiled model, changed in place.
        chain: friction that depends on the state.
        model: for the sliding speed.
        kinds: ``hinge`` or ``slide`` per serial joint.
    """
    for ident in range(m.ntendon):
        name = m.tendon(ident).name
        location, _, index = name.partition(":")
        if location not in ("actuator", "joint") or not index.isdecimal():
            continue  # a tendon of the MJCF's own
        row = model.transmission[int(index)] if location == "actuator" else np.eye(model.size)[int(index)]
        slow = model.sliding_speed * (0.1 if kinds[int(np.argmax(np.abs(row)))] == "slide" else 1.0)
        # a law may differ by direction, or be nothing but damping, which the constraint must not soften
        around = 10.0 * slow * np.array([-1.0, 0.0, 1.0])
        loss = float(m.tendon_frictionloss[ident])
        laws = [t for t in chain.friction if t.tendon == name]
        # one that grows with the load sets in at the sliding speed under a small one, above it later
        load = np.full(3, _LOAD * min(float(model.actuators.torque_limit[int(index)]), _UNLIMITED))
        loss += sum(float(np.max(t.law(around, load, *t.parameters))) for t in laws)
        if loss <= 0.0:
            continue
        rate = loss / slow * float(m.tendon_invweight0[ident])
        give = min(0.9, _STABLE / (rate * m.opt.timestep))
        impedance = 1.0 - give
        m.tendon_solref_fri[ident] = -1.0, -rate * give
        m.tendon_solimp_fri[ident] = impedance, impedance, 0.001, 0.5, 2.0
