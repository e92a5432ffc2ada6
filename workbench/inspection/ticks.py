"""The controller's ticks: the rows at which the logged command changes."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording

from .result import Remark

_LONGEST = 100  # rows between ticks
_FEW = 50  # changes below which a period cannot be told


def find_ticks(recording: Recording) -> tuple[int, int, list[Remark]]:
    """Return rows per tick, the row of the first tick, and remarks if these differ from the stated ones."""
    stated = recording.controller.period_s
    rows = None if stated is None else stated / recording.period
    changes = np.flatnonzero(np.any(np.diff(recording.signals["torque_command"], axis=0) != 0, axis=1)) + 1
    ratio, phase = _regular(changes)
    remarks: list[Remark] = []
    if len(changes) < _FEW:
        return (max(1, round(rows)) if rows else 1), 0, remarks
    milliseconds = f"{1e3 * ratio * recording.period:.4g} ms"
    value = {"period_s": ratio * recording.period, "stated_s": stated, "phase_rows": phase}
    if stated is None or rows is None:
        text = f"The command is held for {milliseconds}."
        return ratio, phase, [] if ratio == 1 else [Remark("note", "controller", None, text, value)]
    if rows > 0.99 and abs(rows - round(rows)) > 0.01 * rows:
        text = f"The stated controller period is {rows:.4g} row periods, not a whole number."
        remarks.append(Remark("warning", "controller", None, text, value))
    elif ratio != max(1, round(rows)):
        text = f"The command is held for {milliseconds}, not for the stated {1e3 * stated:.4g} ms."
        # a command that changes at every row may carry a feedforward that is not held
        severity = "note" if ratio == 1 and not recording.timing.feedforward_held else "warning"
        remarks.append(Remark(severity, "controller", None, text, value))
    elif phase:
        text = f"The controller's first tick is row {phase + 1}, not the first row."
        remarks.append(Remark("warning", "controller", None, text, value))
    else:
        text = f"The command is held for {milliseconds} from the first row on, as stated."
        remarks.append(Remark("ok", "controller", None, text, value))
    if ratio == 1 and not recording.timing.feedforward_held:
        return max(1, round(rows)), 0, remarks
    return ratio, phase, remarks


def _regular(changes: np.ndarray) -> tuple[int, int]:
    """Return the longest period, in rows, whose grid has nearly all changes, and the grid's first row."""
    if len(changes) < _FEW:
        return 1, 0
    for ratio in range(_LONGEST, 1, -1):
        counts = np.bincount(changes % ratio, minlength=ratio)
        if counts.max() >= 0.99 * len(changes):
            return ratio, int(np.argmax(counts))
    return 1, 0
