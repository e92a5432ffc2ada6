"""Draws a hidden effect for any machine, with a size that its torque and motion make visible."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording

from .own_machine import HiddenIn, OwnMachine

_PLAIN = (
    "coulomb_friction", "viscous_damping", "torque_constant_error", "reflected_inertia", "torque_bias",
    "parallel_spring", "command_delay", "joint_compliance",
)  # fmt: skip


def draw_own(machine: OwnMachine, clean: Recording, seed: int) -> HiddenIn:
    """Return one effect at one drive, of a size that torque and motion of the clean run clearly show.

    Args:
        machine: where it will be.
        clean: a run of the machine without it.
        seed: draws effect, drive and size.
    """
    generator = np.random.default_rng([seed, 41])
    names = (*_PLAIN, "payload_mass") if machine.mechanism.foot else _PLAIN
    effect = names[generator.integers(len(names))]
    k = int(generator.integers(machine.size))
    share = float(np.exp(generator.uniform(np.log(0.1), np.log(0.3))))
    torque = float(np.std(clean.signals["torque_measured"][:, k]))
    speed = float(np.std(clean.signals["velocity"][:, k]))
    way = float(np.ptp(clean.signals["position"][:, k]))
    middle = float(np.mean(clean.signals["position"][:, k]))
    push = share * torque
    softly = torque / max(way, 1e-9)
    inertia = share * max(machine.rotor[k], push * way / max(speed, 1e-9) ** 2)
    found: dict[str, float] = {
        "coulomb_friction": {"torque": push},
        "viscous_damping": {"damping": push / max(speed, 1e-9)},
        "torque_constant_error": {"gain": 1.0 - 0.5 * share},
        "reflected_inertia": {"inertia": inertia},
        "torque_bias": {"torque": push},
        "parallel_spring": {"stiffness": 2.0 * push / max(way, 1e-9), "rest": middle},
        "command_delay": {"time": 1e-3 + 0.01 * share},
        "joint_compliance": {"stiffness": 20.0 * softly, "damping": 0.02 * softly},
        "payload_mass": {"mass": share},
    }[effect]  # fmt: skip
    axis = None if effect in ("command_delay", "payload_mass") else machine.axes[k]
    return HiddenIn(effect, axis, "actuator", found)
