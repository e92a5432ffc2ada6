"""What most baselines start from: filtered motion, and the torque that the model's file lacks.

The torque that drives lack over the file is linear in most effects' values. Motion and torque go through the
same low-pass without lag, and rows are thinned to about as many as are independent (M. Gautier, Dynamic
identification of robots with power model, ICRA 1997). Inverse dynamics are MuJoCo's, of `model.xml`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from columns import Candidate, Inverse, candidates
from scipy.signal import butter, filtfilt
from workbench_exam.cases import Case, Recording

_CUT = 20.0  # Hz, of the low-pass
_ROW = 0.02  # s, between rows


@dataclass(frozen=True)
class Regression:
    """Rows of all recordings: `y` (N,) the lacking torque over its noise, and the candidates so too."""

    y: np.ndarray
    candidates: tuple[Candidate, ...]
    motion: dict[str, np.ndarray]


def torque_of(case: Case, recording: Recording, held: bool = False) -> np.ndarray:
    """Torques of a recording (N, n): measured, else commanded, else by the law of the loop.

    Each is held from its row to the next; of rows that are smoothed later it is the mean about the row.
    """
    s = recording.signals
    if "torque_measured" in s:
        u = s["torque_measured"]
    elif "torque_command" in s:
        u = s["torque_command"]
    else:
        u = case.kp * (s["position_reference"] - s["position"]) - case.kd * speed_of(recording)
        return u * np.array(case.driven)
    return u if held else np.vstack([u[:1], 0.5 * (u[1:] + u[:-1])])


def speed_of(recording: Recording) -> np.ndarray:
    """Measured speeds (N, n), else the differences of smoothed positions."""
    if "velocity" in recording.signals:
        return recording.signals["velocity"]
    return np.gradient(_smooth(recording.signals["position"], _period(recording)), _period(recording), axis=0)


def _period(recording: Recording) -> float:
    return float(np.median(np.diff(recording.time)))


def _smooth(x: np.ndarray, period: float) -> np.ndarray:
    b, a = butter(4, min(2 * _CUT * period, 0.8))
    return filtfilt(b, a, x, axis=0)


def regression(case: Case) -> Regression:
    """Rows and candidates of a case."""
    parts: dict[str, list[np.ndarray]] = {key: [] for key in "qwau"}
    for r in case.recordings:
        period = _period(r)
        q, w, u = (_smooth(x, period) for x in (r.signals["position"], speed_of(r), torque_of(case, r)))
        a = np.gradient(w, period, axis=0)
        rows = slice(round(0.3 / period), -round(0.3 / period), max(1, round(_ROW / period)))
        for key, values in zip("qwau", (q, w, a, u), strict=True):
            parts[key].append(values[rows])
    motion = {key: np.concatenate(values) for key, values in parts.items()}
    file = Inverse(case)
    lacks = motion["u"] - file.torque(motion)
    driven = np.flatnonzero(case.driven)
    made = [c for c in candidates(case, motion, file) if np.isfinite(c.columns).all()]
    # each drive by what is left of it when everything is allowed: a fair guess of its noise
    stacked = np.concatenate([c.columns.reshape(len(lacks), len(case.drives), -1) for c in made], axis=2)
    scale = np.ones(len(case.drives))
    for i in driven:
        columns = stacked[:, i]
        left = lacks[:, i] - columns @ np.linalg.lstsq(columns, lacks[:, i], rcond=1e-9)[0]
        scale[i] = left.std()

    def flat(x: np.ndarray) -> np.ndarray:
        """(N, n) or (N, n, K) -> (N n,) or (N n, K), over the noise."""
        over = x[:, driven] / (scale[driven] if x.ndim == 2 else scale[driven, None])
        return over.reshape(-1, *x.shape[2:])

    whole = tuple(
        Candidate(c.effect, c.place, flat(c.columns.reshape(len(lacks), len(case.drives), -1)), c.reading)
        for c in made
    )
    return Regression(flat(lacks), whole, motion | {"lacks": lacks, "scale": scale})
