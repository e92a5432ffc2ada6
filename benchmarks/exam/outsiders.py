"""Sizes of what no catalogue explains: each raises the nominal model's error twofold to tenfold."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from workbench.rigs import HiddenEffect
from workbench.rigs.experiments import HOLD

_AXES = ("hip", "knee")
#: How much less a torque on the knee takes to move the leg as far.
_SHARE = {"hip": 1.0, "knee": 0.7}
_AT = {("hip", "actuator"): HOLD[0], ("knee", "actuator"): HOLD.sum(), ("knee", "joint"): HOLD[1]}


class _Draw:
    """Random numbers and a place."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng([seed, 107])

    def log(self, low: float, high: float) -> float:
        return float(np.exp(self._generator.uniform(np.log(low), np.log(high))))

    def even(self, low: float, high: float) -> float:
        return float(self._generator.uniform(low, high))

    def sign(self) -> float:
        return float(self._generator.choice([-1.0, 1.0]))

    def axis(self) -> str:
        return str(self._generator.choice(_AXES))

    def seat(self) -> tuple[str, str]:
        return list(_AT)[self._generator.integers(len(_AT))]


def _drive(
    effect: str, parameters: Callable[[_Draw, float], dict[str, float]]
) -> Callable[[_Draw], HiddenEffect]:
    """An outsider in a drive; parameters of a draw and the axis' share of torque."""

    def drawn(draw: _Draw) -> HiddenEffect:
        axis = draw.axis()
        return HiddenEffect(effect, axis, parameters=parameters(draw, _SHARE[axis]))

    return drawn


def _placed(
    effect: str, parameters: Callable[[_Draw, float, float], dict[str, float]]
) -> Callable[[_Draw], HiddenEffect]:
    """An outsider in a drive or a pin; parameters of a draw, the share of torque and the angle held there."""

    def drawn(draw: _Draw) -> HiddenEffect:
        axis, location = draw.seat()
        chosen = parameters(draw, _SHARE[axis], float(_AT[axis, location]))
        return HiddenEffect(effect, axis, "joint" if location == "joint" else "actuator", chosen)

    return drawn


#: Name -> how it is drawn.
OUTSIDE: Mapping[str, Callable[[_Draw], HiddenEffect]] = {
    "periodic_disturbance": _drive(
        "periodic_disturbance",
        lambda d, s: {
            "torque": s * d.log(0.25, 0.8),
            "frequency": d.log(0.7, 12.0),
            "phase": d.even(0.0, 6.28),
        },
    ),
    "random_walk_torque": _drive(
        "random_walk_torque", lambda d, s: {"torque": s * d.log(0.3, 0.8), "time_constant": d.log(0.08, 1.0)}
    ),
    "cubic_spring": _placed(
        "cubic_spring", lambda d, s, at: {"stiffness": s * d.log(2.5, 8.0), "rest": at + d.even(-0.35, 0.35)}
    ),
    "position_dependent_friction": _placed(
        "position_dependent_friction",
        lambda d, s, at: {
            "torque": s * d.log(0.3, 0.8),
            "order": d.even(4.0, 10.0),
            "phase": d.even(0.0, 6.28),
        },
    ),
    "rough_patch": _placed(
        "rough_patch",
        lambda d, s, at: {
            "torque": s * d.log(0.6, 1.5),
            "angle": at + d.even(-0.15, 0.15),
            "width": d.log(0.04, 0.12),
        },
    ),
    "one_sided_spring": _placed(
        "one_sided_spring",
        lambda d, s, at: {"stiffness": s * d.log(2.5, 8.0), "rest": at + d.even(-0.15, 0.15)},
    ),
    "cross_spring": lambda d: HiddenEffect(
        "cross_spring", parameters={"stiffness": d.log(0.5, 2.0), "rest": d.even(-0.4, 0.4)}
    ),
    "cross_damping": _drive("cross_damping", lambda d, s: {"damping": d.sign() * s * d.log(0.2, 0.5)}),
    "drifting_torque": _drive(
        "drifting_torque", lambda d, s: {"torque": s * d.log(0.3, 0.8), "time": d.log(4.0, 12.0)}
    ),
    "torque_hysteresis": _drive("torque_hysteresis", lambda d, s: {"torque": s * d.log(0.2, 0.5)}),
    "torque_deadband": _drive("torque_deadband", lambda d, s: {"torque": s * d.log(0.2, 0.5)}),
    "torque_dropout": _drive(
        "torque_dropout", lambda d, s: {"interval": d.log(0.3, 2.0), "duration": d.log(0.005, 0.03)}
    ),
}


def draw_outsider(name: str, seed: int) -> HiddenEffect:
    """One outsider with its place and size."""
    return OUTSIDE[name](_Draw(seed))
