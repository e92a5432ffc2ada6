"""A law that holds in other coordinates than stated: joints for drives, or drives for joints."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Controller, Recording

from .law import Ticks, fit_gains, ticks, unexplained
from .ticks import find_ticks

_EXACT = 0.005  # what a law that holds may leave, as a part of the command's variation
_FAR = 0.05  # what the stated one leaves that is asked about
_SAME = 0.02  # of a gain, by which it may be off


@dataclass(frozen=True)
class Elsewhere:
    """The coordinates in which a law holds, its residual there, and its residual in the stated ones."""

    stated: str
    coordinates: str
    rest: float
    rest_stated: float
    to_controller: np.ndarray

    def __str__(self) -> str:
        return (
            f"in {self.coordinates} coordinates the logged command follows the stated law "
            f"({unexplained(self.rest)}), in {self.stated} coordinates, as "
            f"stated, it does not ({100 * self.rest_stated:.2g} % remains)"
        )


def law_elsewhere(recording: Recording, transmission: np.ndarray | None = None) -> Elsewhere | None:
    """Return where the stated law holds, if not in the stated coordinates.

    Args:
        recording: what was logged.
        transmission: J in q_p = J q_s, shape (n, n); None where no model is at hand: then the usual ones are
            tried, and the one that the command itself shows.
    """
    needed = ("torque_command", "position_reference", "velocity")
    if recording.controller.kind != "pd" or any(recording.get(s) is None for s in needed):
        return None
    ratio, phase, _ = find_ticks(recording)
    at = ticks(recording, ratio, phase)
    if len(at.command) < 50 or not np.ptp(at.command, axis=0).all():
        return None
    return found_elsewhere(recording, at, transmission)


def found_elsewhere(recording: Recording, at: Ticks, transmission: np.ndarray | None) -> Elsewhere | None:
    """Return the same as `law_elsewhere`, from the controller's ticks."""
    c = recording.controller
    there = replace(c, coordinates="joint" if c.coordinates == "actuator" else "actuator")
    rest = min(fit_gains(at, c, m).rest for m in maps(recording, c, transmission))
    tried = maps(recording, there, transmission)
    shown = None
    if transmission is None and there.coordinates != recording.coordinates:
        shown = _shown(at)
    tried += [] if shown is None else [shown]
    fits = [(fit_gains(at, c, m), m) for m in tried]
    fit, m = min(fits, key=lambda found: found[0].rest)
    gains = [f for name, (f, _) in fit.by_name.items() if name.startswith("k")]
    alike = all(abs(f - 1.0) < _SAME for f in gains)
    if rest < _FAR or fit.rest > min(_EXACT, 0.1 * rest) or not alike:
        return None
    return Elsewhere(c.coordinates, there.coordinates, fit.rest, rest, m)


def maps(recording: Recording, controller: Controller, transmission: np.ndarray | None) -> list[np.ndarray]:
    """Return candidates of M, which maps the recording's positions to the controller's."""
    n = len(recording.axes)
    if recording.coordinates == controller.coordinates:
        return [np.eye(n)]
    usual: list[np.ndarray] = [np.eye(n)]
    belt = np.array([[1.0, 0.0], [1.0, 1.0]])
    for leg in (belt, np.block([[np.eye(1), np.zeros((1, 2))], [np.zeros((2, 1)), belt]])):
        if n % len(leg) == 0:
            usual.append(np.kron(np.eye(n // len(leg)), leg))
    given = usual if transmission is None else [np.asarray(transmission, float)]
    return [np.linalg.inv(j) for j in given] if recording.coordinates == "actuator" else given


def _shown(at: Ticks) -> np.ndarray | None:
    """Return M from the command: ``command = M^T kp (reference - M position) - ...``, so M is B over A."""
    n = at.command.shape[1]
    columns = np.hstack([at.reference, at.position, at.velocity, np.ones((len(at.command), 1))])
    size = np.linalg.norm(columns, axis=0).clip(1e-12)
    found, *_, strength = np.linalg.lstsq(columns / size, at.command - at.feedforward, rcond=None)
    if strength[-1] < 1e-6 * strength[0]:
        return None
    found = found / size[:, None]
    a, b = found[:n].T, -found[n : 2 * n].T
    return np.linalg.solve(a, b) if np.linalg.cond(a) < 1e6 else None
