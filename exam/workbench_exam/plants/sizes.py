"""How large an effect or a stranger is, in proportion to the machine that it is drawn for."""

from __future__ import annotations

import numpy as np

from .chain import Machine
from .drawn import Drawn, Item, judged
from .machines import draw_machine
from .plant import along


def values_of(drawn: Drawn, name: str, i: int, rng: np.random.Generator) -> dict[str, float]:
    """Values of an effect on drive `i`, in proportion to the machine."""
    machine = drawn.file.machine
    link, reach, middle = machine.links[i], machine.reach[i], machine.posture[i]
    rub, quick = draw_machine(drawn.family, drawn.seed).links[i].friction, 1.5 * reach

    def u(low: float, high: float) -> float:
        return few_digits(rng.uniform(low, high))

    def share() -> float:
        return -u(0.35, 0.7) if rng.integers(2) else u(0.5, 1.5)

    way = along(machine, i) or (0.0, 0.0, 0.0)
    made = {
        "viscous_damping": lambda: {"damping": share() * link.damping},
        "coulomb_friction": lambda: {"torque": share() * link.friction},
        "reflected_inertia": lambda: {"inertia": share() * link.armature},
        "first_moment_error": lambda: {
            "along": share() * link.mass * abs(sum(a * b for a, b in zip(link.centre, way, strict=True)))
        },
        "link_inertia_error": lambda: {
            "inertia": u(-0.6, 0.6) * sum(a * abs(b) for a, b in zip(link.inertia, link.axis, strict=True))
        },
        "payload_mass": lambda: {"mass": u(0.25, 0.7) * machine.links[-1].mass},
        "torque_constant_error": lambda: {"gain": u(0.75, 0.9) if rng.integers(2) else u(1.12, 1.3)},
        "torque_bias": lambda: {"torque": u(0.7, 2.0) * rub * (1 if rng.integers(2) else -1)},
        "torque_saturation": lambda: {"limit": u(0.6, 0.85) * _peak(drawn, i)},
        "parallel_spring": lambda: {
            "stiffness": u(1.5, 4.0) * rub / reach,
            "rest": middle + u(-0.3, 0.3) * reach,
        },
        "quadratic_drag": lambda: {"drag": u(0.8, 2.0) * rub / quick**2},
        "stribeck_friction": lambda: _stribeck(u(0.5, 1.0) * rub, u(1.6, 2.5), u(0.1, 0.3) * quick),
        "cogging": lambda: {
            "torque": u(0.5, 1.2) * rub,
            "order": float(rng.integers(6, 21)),
            "phase": u(0.0, 6.28),
        },
        "joint_compliance": lambda: {
            "stiffness": link.armature * u(40.0, 90.0) ** 2,
            "damping": link.armature * 2.0,
        },
        "backlash": lambda: {"gap": u(0.01, 0.03), "stiffness": link.armature * 150.0**2},
        "encoder_offset": lambda: {"angle": u(0.03, 0.1) * (1 if rng.integers(2) else -1)},
        "current_loop_lag": lambda: {"time_constant": u(0.003, 0.008)},
        "command_delay": lambda: {"time": 5e-4 * int(rng.integers(4, 11))},
    }[name]()
    return {key: few_digits(value) for key, value in made.items()}


def _stribeck(coulomb: float, times: float, speed: float) -> dict[str, float]:
    return {"coulomb": coulomb, "static": coulomb * times, "speed": speed}


def stranger_of(machine: Machine, name: str, rng: np.random.Generator) -> Item:
    """Once to three times the friction of the drive it acts on."""
    own = int(rng.choice([i for i, link in enumerate(machine.links) if link.driven]))
    reach, middle = machine.reach[own], machine.posture[own]
    torque = machine.links[own].friction * rng.uniform(1.0, 3.0)
    if name == "follower" and len(machine.links) == 1:
        name = "tone"
    values = {
        "rough_patch": lambda: {
            "torque": 2 * torque,
            "angle": middle + reach * rng.uniform(-0.3, 0.3),
            "width": reach * rng.uniform(0.1, 0.25),
        },
        "follower": lambda: {
            "torque": torque,
            "phase": rng.uniform(-0.4, 0.4),
            "other": float(rng.choice([i for i in range(len(machine.links)) if i != own])),
        },
        "tone": lambda: {
            "torque": torque,
            "frequency": np.exp(rng.uniform(np.log(0.7), np.log(8.0))),
            "phase": rng.uniform(0, 6),
        },
        "cubic_spring": lambda: {
            "stiffness": 3 * torque / reach**3,
            "rest": middle + reach * rng.uniform(-0.2, 0.2),
        },
    }[name]()
    return Item(name, machine.axes[own], {key: few_digits(value) for key, value in values.items()})


def few_digits(value: float) -> float:
    """Of so few digits that every machine draws the same."""
    return float(f"{value:.6g}")


def _peak(drawn: Drawn, i: int) -> float:
    return float(np.abs(judged(drawn.file, drawn).torque[:, i]).max())
