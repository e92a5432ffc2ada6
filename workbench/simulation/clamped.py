"""Commands that were clipped to a limit before they were logged: what the loop had asked for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_FOLLOWED = 0.1  # of a command's variation a law that holds may leave in rows that are not cut


def before_clamp(
    command: np.ndarray, law: np.ndarray, limits: Sequence[tuple[int, float, float]]
) -> np.ndarray:
    """Return a logged command (N, n) with the unclipped command of the loop where it is at a limit.

    A drive that is said to be without a limit would have followed that.

    Args:
        command: in the recording's own coordinates.
        law: what the stated loop asks for along the measured motion, (N, n), the same coordinates.
        limits: at which it stands, as `command_limits` finds them.
    """
    out = command.copy()
    for axis in {axis for axis, _, _ in limits}:
        asked, ideal = out[:, axis], law[:, axis]
        at = {limit: np.isclose(asked, limit, rtol=1e-6, atol=0.0) for i, limit, _ in limits if i == axis}
        free = ~np.any(list(at.values()), axis=0)
        if np.std((ideal - asked)[free]) < _FOLLOWED * np.std(asked):
            for limit, cut in at.items():
                beyond = cut & (np.sign(limit) * ideal > abs(limit))
                asked[beyond] = ideal[beyond]
    return out
