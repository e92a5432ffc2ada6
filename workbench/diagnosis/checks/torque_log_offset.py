"""The torque log offset: measured torque that is logged whole rows later or earlier than its command."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from workbench.core import Recording
from workbench.effects import held

from ..policy import POLICY


def torque_offset_lines(
    recordings: Sequence[Recording], delay: float, late: Collection[str | None] = ()
) -> list[str]:
    """Return one line for each axis whose measured torque is shifted against its command by whole rows.

    That is how a late drive looks too. But a drive's delay is in the motion as well, and is found; where it
    is not, and the rest stays unexplained, the log is what to look at.

    Args:
        recordings: those fitted.
        delay: from command to torque by the model [s].
        late: axes whose drives were found to be late; None is all of them.
    """
    pairs = [
        (held(r.signals["torque_command"], r.period, delay)[0], r.signals["torque_measured"])
        for r in recordings
        if {"torque_command", "torque_measured"} <= set(r.signals) and len(r) > 4 * POLICY.shift_rows
    ]
    lines = []
    for index, axis in enumerate(recordings[0].axes if pairs else ()):
        shifts = range(-POLICY.shift_rows, POLICY.shift_rows + 1)
        left = {s: sum(_off(asked[:, index], given[:, index], s) for asked, given in pairs) for s in shifts}
        best = min(shifts, key=lambda s: left[s])
        if best and not {axis, None} & set(late) and left[best] < POLICY.shift_left * left[0]:
            rows = f"{abs(best)} row{'s' * (abs(best) > 1)}"
            verb, way = ("lags", "up") if best > 0 else ("leads", "down")
            ms = 1000.0 * abs(best) * recordings[0].period
            lines.append(
                f"at {axis}, the measured torque {verb} the one that the model's drive would give by {rows} "
                f"({ms:.3g} ms); where the motion shows no such shift, move the column of the log {way}"
            )
    return lines


def _off(asked: np.ndarray, given: np.ndarray, shift: int) -> float:
    """The squared difference between two torques, one shifted by whole rows, always over the same rows."""
    rows = np.arange(POLICY.shift_rows, len(asked) - POLICY.shift_rows)
    return float(np.nansum((given[rows] - asked[rows - shift]) ** 2))
