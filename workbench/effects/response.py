"""Response of an effect along a motion: torques and sensor readings, as columns of unknown coefficients."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.models import Placement

from .motion import Line, Motion


@dataclass(frozen=True)
class Response:
    """Response of an effect along a motion, divided into parts that are linear in unknown coefficients.

    Everything is in actuator coordinates. None: nothing there.

    Attributes:
        columns: torque on the mechanism per unit of each coefficient, shape (k, N, n); k may be 0.
        offset: torque that has no free coefficient, (N, n), or None.
        tap: change of `torque_measured` itself by what has no free coefficient, (N, n).
        commands: change of the torque that the controller asks for from a row on, per unit of each
            coefficient, (k, N, n).
        readings: change of the position and the velocity that sensors read, per unit, (k, 2, N, n).
        reading: the same of what has no free coefficient, (2, N, n).
    """

    columns: np.ndarray
    offset: np.ndarray | None = None
    tap: np.ndarray | None = None
    commands: np.ndarray | None = None
    readings: np.ndarray | None = None
    reading: np.ndarray | None = None

    @staticmethod
    def read(motion: Motion, readings: np.ndarray) -> Response:
        """Return the response of a sensor: `readings` (k, 2, N, n), and no torque."""
        return Response(np.zeros((len(readings), *motion.position.shape)), readings=readings)

    @staticmethod
    def passed(motion: Motion, line: Line) -> Response:
        """Return the change by another path between command and sensor; no free coefficient."""
        (at, mean), (new_at, new_mean) = motion.line.passed, line.passed
        empty = np.zeros((0, *motion.position.shape))
        return Response(empty, offset=(new_mean - mean) * motion.gain, tap=new_at - at)


def smooth_sign(speed: np.ndarray) -> np.ndarray:
    """Return the sign of a measured speed, smoothed where noise dominates (1 % of the rms speed)."""
    width = 0.01 * float(np.sqrt(np.mean(speed**2))) + 1e-12
    return np.tanh(speed / width)


def single(place: Placement, torque: np.ndarray, motion: Motion) -> np.ndarray:
    """Return a torque on one coordinate, (N,), as generalised torque in actuator coordinates, (N, n).

    By virtual work: tau_s = row^T torque, and tau_p = J^-T tau_s (paper, Eq. 4).
    """
    return torque[:, None] * (np.linalg.inv(motion.transmission).T @ place.row)[None, :]


def read_on(place: Placement, position: np.ndarray, velocity: np.ndarray, motion: Motion) -> np.ndarray:
    """Return a change (N,) of the position and velocity reading of one drive, as that of all drives,
    (2, N, n).
    """
    out = np.zeros((2, *motion.position.shape))
    out[0, :, place.index], out[1, :, place.index] = position, velocity
    return out
