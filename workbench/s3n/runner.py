"""Runs of every variant: torques held over control periods, or a law that computes them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.core import InputError, SimulationError
from workbench.models import Model

from .loop import ConstraintSettings
from .worlds import make_world

_LOST = 1e4  # rad/s: a run that goes faster is lost

#: Torque on the drives (n,) from the row and the state (n,), (n,) in serial coordinates.
Law = Callable[[int, np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class VariantRun:
    """A run; row i is the state when the torque of row i begins to act.

    Attributes:
        time: (N,) [s].
        position, velocity: serial coordinates, (N, n).
        torque: on the drives, actuator coordinates, (N, n) [N m].
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray


def run_variant(
    model: Model,
    variant: str,
    torque: np.ndarray | Law,
    *,
    rows: int | None = None,
    period: float = 0.003,
    step: float = 0.001,
    start: tuple[np.ndarray, np.ndarray] | None = None,
    integrator: str = "implicitfast",
    constraint: ConstraintSettings | None = None,
    strict: bool = True,
) -> VariantRun:
    """Return the run of a variant of a model under torques that are held over control periods.

    What stands between a command and the drives (delay, limit, gain, bias) is not applied.

    Args:
        model: any model of the mechanism; its effects that are not structural act in every variant but
            ``constraint``, which is the mechanism of its SDF file.
        variant: a name in `VARIANT_NAMES`.
        torque: on the drives, actuator coordinates, (N, n) [N m]; or a law called at each row.
        rows: N, where `torque` is a law.
        period: control period [s], a whole number of steps.
        step: integration step [s].
        start: ``(q, v)`` in serial coordinates, (n,) each; at rest at the MJCF's own posture if left out.
        integrator: ``Euler``, ``RK4``, ``implicit`` or ``implicitfast``.
        constraint: solver settings of the variant ``constraint``.
        strict: raise where the run is lost; else its rows are NaN from there.

    Raises:
        InputError: an argument that does not fit.
        SimulationError: ``explicit`` where it diverges, or a run that is lost.
    """
    count = len(torque) if isinstance(torque, np.ndarray) else rows
    stride = round(period / step)
    if count is None or count < 1:
        raise InputError("a torque law without a number of rows", remedy="give rows=N")
    if stride < 1 or abs(stride * step - period) > 1e-9 * period:
        raise InputError(f"a period of {period} s is not a whole number of steps of {step} s", column="step")
    if isinstance(torque, np.ndarray) and (torque.ndim != 2 or torque.shape[1] != model.size):
        raise InputError(f"torque of shape {torque.shape}", remedy=f"give (N, {model.size})")
    world = make_world(model, variant, step, integrator, constraint, start)
    q, v, tau = (np.full((count, model.size), np.nan) for _ in range(3))
    for row in range(count):
        q[row], v[row] = world.state()
        if not (np.abs(v[row]) < _LOST).all():
            if strict:
                raise SimulationError(
                    f"model '{model.name}', variant '{variant}' becomes unstable at {row * period:.3f} s "
                    f"with a step of {step} s; take a shorter one"
                )
            q[row:], v[row:] = np.nan, np.nan
            break
        tau[row] = torque[row] if isinstance(torque, np.ndarray) else torque(row, q[row], v[row])
        world.advance(tau[row], stride)
    return VariantRun(np.arange(count) * period, q, v, tau)
