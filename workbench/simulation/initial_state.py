"""The state in which the run of a recording begins: as it is stated, or as the first rows show."""

from __future__ import annotations

import numpy as np

from workbench.core import Controller, Recording
from workbench.recordings.noise import position_levels

_CLEARLY = 6.0  # times its noise: what is elsewhere


def initial_state(
    recording: Recording,
    controller: Controller,
    reference: np.ndarray | None,
    to_actuator: np.ndarray,
    j: np.ndarray,
) -> np.ndarray:
    """Initial (q_s, rate), (2, n): at rest at the first reference, unless the first rows say otherwise.

    Args:
        recording: what is replayed.
        controller: its loop.
        reference: (N, n) in the controller's coordinates, None without one.
        to_actuator: (n, n), recording coordinates to actuator coordinates for positions.
        j: (n, n), q_p = J q_s.
    """
    back = np.linalg.inv(j)
    position, rate, doubt = _first_rows(recording)
    measured = np.stack([back @ to_actuator @ position, back @ to_actuator @ rate])
    if reference is None or controller.kind in ("none", "unknown") or not recording.timing.initial_at_rest:
        return measured
    first = reference[0] if controller.coordinates == "joint" else back @ reference[0]
    rest = np.linalg.inv(to_actuator) @ j @ first
    away = np.abs(np.stack([position - rest, rate])) > _CLEARLY * doubt
    if not away.any():
        # first rows so far apart that motion is no parabola tell no rate, but they tell where it began
        elsewhere = _first_row_is_off(recording, rest)
        first = back @ to_actuator @ recording.position[0] if elsewhere else first
        return np.stack([first, np.zeros_like(first)])
    if away[0].any() and _stands_still(recording):
        # somewhere else than it should be, as with an encoder that errs: the loop is about to jerk
        return np.stack([back @ to_actuator @ recording.position[:2].mean(axis=0), np.zeros_like(first)])
    return measured


def _first_row_is_off(recording: Recording, rest: np.ndarray) -> bool:
    """Whether the first row by itself is clearly elsewhere than at rest at the first reference, (n,)."""
    away = np.abs(recording.position[0] - rest)
    if not away.any():
        return False
    return bool((away > _CLEARLY * position_levels(recording)[1]).any())


def _stands_still(recording: Recording) -> bool:
    """Whether a recording's first row is at rest, as far as the noise of its velocity lets see."""
    velocity = recording.get("velocity")
    if velocity is None:
        return False
    noise = np.median(np.abs(np.diff(velocity, axis=0)), axis=0)
    return bool((np.abs(velocity[0]) <= 4.0 * noise).all())


def _first_rows(recording: Recording) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position and rate at the first row by a parabola, and how far off they may be, (2, n)."""
    rows = int(np.clip(0.02 / recording.period, 8, len(recording) // 2))
    t = recording.time[:rows]
    basis = np.stack([np.ones(rows), t, t**2], axis=1)
    solution, *_ = np.linalg.lstsq(basis, recording.position[:rows], rcond=None)
    # how far the motion is from a parabola shows in what half of the rows say
    half, *_ = np.linalg.lstsq(basis[: rows // 2], recording.position[: rows // 2], rcond=None)
    bent = np.abs(solution - half)[:2]
    steps = np.abs(np.diff(recording.position, axis=0))
    smallest = [float(np.min(s[s > 0], initial=1e-9)) for s in steps.T]
    scatter = np.maximum((recording.position[:rows] - basis @ solution).std(axis=0), smallest)
    spread = np.sqrt(np.diag(np.linalg.inv(basis.T @ basis)))[:2]
    doubt = spread[:, None] * scatter[None, :] + scatter[None, :] * np.array([[1.0], [0.0]])
    return solution[0], solution[1], doubt + bent
