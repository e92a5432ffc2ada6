"""Scores of the shipped tasks, over a run without its first second."""

from __future__ import annotations

import numpy as np

from .machine import STEP_S
from .task import Logged


def reach_scores(log: Logged) -> dict[str, float]:
    """Return the RMS error of the joints against their reference, each and all [rad]."""
    miss = log.get("joints") - log.get("goal")
    miss = miss[_skip(miss) // 4 :]
    each = {f"{name}_rmse_rad": _rms(miss[:, k]) for k, name in enumerate(log.names)}
    return {**each, "rmse_rad": _rms(miss)}


def pitch_scores(log: Logged) -> dict[str, float]:
    """Return pitch rate and amplitude of the base, the share of planted feet, and the force on the rear
    right foot.
    """
    angular, force, gravity = (log.get(n) for n in ("base_angular", "ground_force", "base_gravity"))
    angular, force, gravity = (x[_skip(x) :] for x in (angular, force, gravity))
    if not len(angular):
        return {}
    low, high = np.percentile(angular[:, 1], [1, 99])
    normal = force.reshape(len(force), -1, 3)[..., 2]
    return {
        "pitch_rate_peak_to_peak_rad_s": float(high - low),
        "pitch_amplitude_rad": float(np.sqrt(2.0) * np.std(np.arcsin(np.clip(gravity[:, 0], -1, 1)))),
        "planted_share": float(np.mean(normal > 1.0)),
        "rear_right_force_n": float(np.mean(np.linalg.norm(force[:, 9:12], axis=1))),
    }


def circular_scores(log: Logged, wanted: tuple[float, float, float]) -> dict[str, float]:
    """Return forward speed and yaw rate, and their RMS errors against `wanted` [m/s, m/s, rad/s]."""
    angular, linear = log.get("base_angular"), log.get("base_linear")
    angular, linear = angular[_skip(angular) :], linear[_skip(linear) :]
    if not len(angular):
        return {}
    return {
        "forward_m_s": float(np.mean(linear[:, 0])),
        "yaw_rad_s": float(np.mean(angular[:, 2])),
        "forward_rmse_m_s": _rms(linear[:, 0] - wanted[0]),
        "yaw_rmse_rad_s": _rms(angular[:, 2] - wanted[2]),
    }


def _skip(x: np.ndarray) -> int:
    return min(round(1.0 / STEP_S), len(x) // 2)


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))
