"""Which rows of a measured motion are compared with a model: valid, not at the ends, and while something
moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from workbench.core import Recording
from workbench.simulation import Track, edge_rows

from .measured_motion import FilteredRecording

_RINGING, _RINGING_S = 10, 0.5  # of a gap, at most
_SPREAD = 0.25  # of a period of the filter's corner frequency
_STILL, _SURE = 0.02, 3.0  # of the rms speed; of the speed's own noise
_TURNS = 2.0  # times the lead before a reversal, that soft friction turns in


def moving(
    readings: Sequence[FilteredRecording],
    wobbles: Sequence[np.ndarray],
    transmission: np.ndarray,
    leads: np.ndarray | float = 0.0,
) -> list[np.ndarray]:
    """Return which rows and axes are counted, (N, n) each: valid, away from the ends, and in motion.

    Args:
        readings: of the recordings.
        wobbles: the noise of each track's velocity, (N, n), actuator coordinates.
        transmission: of the model.
        leads: how long before a reversal dry friction of drives and pins turns [s], (2 n,); rigid: none.
    """
    # drives and pins: friction of either may hold
    rows = np.vstack([np.eye(len(transmission)), np.linalg.inv(transmission)])
    speeds = [_sure_speed(r.track, rows, leads) for r in readings]
    overall = np.sqrt(np.mean(np.concatenate(speeds) ** 2, axis=0))
    out = []
    for reading, speed, wobble in zip(readings, speeds, wobbles, strict=True):
        r = reading.recording
        own = np.sqrt(np.mean(speed**2, axis=0))
        noise = np.sqrt(np.mean((wobble @ rows.T) ** 2, axis=0))
        least = np.max([_STILL * own, 0.25 * _STILL * overall, _SURE * noise], axis=0)
        # a quick reversal is no standstill; what happens in one the filter spreads
        wide = 2 * int(_SPREAD / reading.corner_hz / r.period) + 1
        moves = scipy.ndimage.maximum_filter1d(speed > least, wide, axis=0)
        moves = scipy.ndimage.minimum_filter1d(moves, 2 * wide - 1, axis=0)
        # a torque counts where all move that it is made of: virtual work takes it there
        counts = np.stack([moves[:, c].all(axis=1) for c in _made_of(reading.to_actuator, rows)], axis=1)
        edge = edge_rows(len(r), r.period)
        counts[:edge], counts[len(r) - edge :] = False, False
        near = np.asarray(
            scipy.ndimage.minimum_filter1d(r.valid, 2 * int(1.0 / reading.corner_hz / r.period) + 1), bool
        )
        out.append(counts & near[:, None])
    return out


def _sure_speed(track: Track, rows: np.ndarray, leads: np.ndarray | float) -> np.ndarray:
    """The size of speeds `rows` (m, n) of the drives, (N, m), and none while their dry friction turns."""
    speed = track.velocity @ rows.T
    later = speed + _TURNS * leads * (track.acceleration @ rows.T)
    return np.where(speed * later > 0.0, np.minimum(np.abs(speed), np.abs(later)), 0.0)


def _made_of(to_actuator: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Which speeds `rows` (m, n) of the drives a torque of the recording has a share of, (n, m) bool.

    Friction f of a speed row @ w_p is a torque row^T f on the drives, and J^T row^T f in the recording.
    """
    return np.abs(rows @ to_actuator).T > 1e-12


def settled(recording: Recording) -> Recording:
    """Return the recording with the rows after a gap masked too, because the input of the loop is unknown
    there and rings on.
    """
    valid = np.array(recording.valid)
    edges = np.flatnonzero(np.diff(np.concatenate([[True], valid, [True]]).astype(int)))
    longest = int(_RINGING_S / recording.period)
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        valid[end : end + min(_RINGING * (end - start), longest)] = False
    return recording if valid.sum() < len(valid) // 4 else replace(recording, valid=valid)
