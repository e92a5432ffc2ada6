"""A run of the visible stretch of time while a slider moves; the complete run follows when it rests."""

from __future__ import annotations

import numpy as np

from workbench.comparison import ClosedLoop, Replay
from workbench.core import Recording
from workbench.models import Model
from workbench.simulation import Run, simulate

_LEAD_S = 0.5  # before the stretch, in which loops forget where they began
_MOST = 0.5  # share of a recording above which the whole is as quick


def stretch_rows(recording: Recording, window: tuple[float, float] | None) -> slice | None:
    """Return the rows to simulate for a stretch of time; None if the complete recording is as fast.

    Args:
        recording: measured.
        window: from when to when it is looked at [s]; None where that is not known.
    """
    if window is None:
        return None
    first = max(0, int(np.floor((window[0] - _LEAD_S) / recording.period)))
    last = min(len(recording), int(np.ceil(window[1] / recording.period)) + 1)
    return slice(first, last) if 2 <= last - first <= _MOST * len(recording) else None


def run_stretch(model: Model, replay: Replay, index: int, rows: slice, before: Recording) -> Recording | None:
    """Return a run of a model, recomputed in some rows.

    Args:
        model: as it is now.
        replay: of all recordings.
        index: which of them.
        rows: of `stretch_rows`.
        before: the run of a model nearly the same, from whose state it begins.

    Returns:
        `before` with the new rows in it; None where stretches cannot be run, or the model is unstable.
    """
    recording = replay.recordings[index]
    position, velocity = before.get("position"), before.get("velocity")
    if not isinstance(replay, ClosedLoop) or position is None or velocity is None:
        return None
    piece = recording.rows(rows)
    start = np.stack([position[rows.start], velocity[rows.start]])
    made = simulate([Run(model, piece, start=start)], strict=False)[0]
    if not np.isfinite(made.position).all():
        return None
    lead = 0 if rows.start == 0 else min(int(_LEAD_S / recording.period), len(made) - 1)
    signals = {name: values.copy() for name, values in before.signals.items()}
    for name, values in made.signals.items():
        if name in signals and len(values) == rows.stop - rows.start:
            signals[name][rows.start + lead : rows.stop] = values[lead:]
    return before.with_signals(**signals)
