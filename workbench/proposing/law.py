"""The controller, found from its log: command against position error and speed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import Controller, Recording
from workbench.inspection.law import fit_gains, ticks
from workbench.inspection.ticks import find_ticks

_HOLDS = 0.02  # what a law may leave of the command, as a part of its variation
_EXACT = 0.005  # of a law row by row
_FEW = 50


@dataclass(frozen=True)
class Law:
    """``torque = kp (q_ref - q) + kd (v_ref - v)``, one gain per axis; `rest` stays of it."""

    kp: tuple[float, ...]
    kd: tuple[float, ...]
    period_s: float
    rest: float
    coordinates: str


def find_law(recording: Recording, transmission: np.ndarray | None = None) -> Law | None:
    """Return the PD law that the logged command follows; None if there is no command, or it follows none.

    Args:
        recording: what was logged.
        transmission: J in q_p = J q_s, shape (n, n), to look for a law in the other coordinates too.
    """
    if any(recording.get(s) is None for s in ("torque_command", "position_reference")):
        return None
    if "velocity" in recording.derived:
        return None  # a law needs the speed that the controller saw
    n = len(recording.axes)
    ratio, phase, _ = find_ticks(recording)
    at = ticks(recording, ratio, phase)
    if len(at.command) < _FEW or not np.ptp(at.command, axis=0).all():
        return None
    maps = {recording.coordinates: np.eye(n)}
    if transmission is not None:
        joints = recording.coordinates == "actuator"
        maps["joint" if joints else "actuator"] = np.linalg.inv(transmission) if joints else transmission
    ones = Controller("pd", recording.coordinates, (1.0,) * n, (1.0,) * n)
    fits = {where: fit_gains(at, ones, m) for where, m in maps.items()}
    where = min(fits, key=lambda w: fits[w].rest)
    fit = fits[where]
    if not fit.rest < _HOLDS:
        return None
    gains = {k: f for k, (f, std) in fit.by_name.items() if np.isfinite(std)}
    kp = [gains.get(f"kp_{i}", 0.0) for i in range(n)]
    kd = [gains.get(f"kd_{i}", 0.0) for i in range(n)]
    if min(kp) <= 0 or min(kd) < -0.02 * max(kp):
        return None
    return Law(tuple(kp), tuple(max(0.0, x) for x in kd), ratio * recording.period, fit.rest, where)


def is_law(error: np.ndarray, speed: np.ndarray, torque: np.ndarray) -> bool:
    """Return whether torques (N, n) are a law of position errors and speeds (N, n), whatever their units.

    A measured torque is not: it is late, it is noisy, and a drive has limits.
    """
    if not torque.size or len(torque) < _FEW:
        return False
    known = np.column_stack([error, speed, np.ones(len(error))])
    rest = torque - known @ np.linalg.lstsq(known, torque, rcond=None)[0]
    return bool((rest.std(axis=0) < _EXACT * torque.std(axis=0)).all())
