"""Work of the drives: over a long motion they cannot take more out of a machine than they put in."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording

from .result import Remark

_CLEAR = 2.0  # times all that springs, weight and inertia give and take, by which work has to fall
_LATE_S = 0.005  # a torque may be logged so much early or late, which turns the phase of an inertia


def remark_on_work(recording: Recording, held: np.ndarray) -> list[Remark]:
    """Check, if no command is logged, that torques put as much work into the machine as they take out.

    Args:
        recording: what was measured.
        held: axes that stood still, shape (n,) bool; they are left out.
    """
    torque = recording.get("torque_measured")
    live = np.flatnonzero(~held)
    # beside a command and its law a wrong sign shows at once
    if torque is None or recording.get("torque_command") is not None or len(live) == 0:
        return []
    rows = int(np.ceil(_LATE_S / recording.period))
    shifts = range(-rows, rows + 1, max(1, rows // 2))
    power = [np.roll(torque, k, axis=0)[:, live] * recording.velocity[:, live] for k in shifts]
    whole = [_trend(np.sum(p, axis=1), recording.period) for p in power]
    if not all(done < -_CLEAR * swing for done, swing in whole):
        return []
    each = [_trend(p, recording.period) for p in np.mean(power, axis=0).T]
    taking = [recording.axes[i] for i, (done, _) in zip(live, each, strict=True) if done < 0]
    which = " or ".join(f"'{axis}'" for axis in taking)
    text = (
        f"The drives take {-max(done for done, _ in whole):.2g} J more out of the machine than they put into "
        f"it: torque or motion of {which} has the wrong sign, or something else pushes the machine."
    )
    axis = taking[0] if len(taking) == 1 else None
    return [Remark("warning", "sign", axis, text, {"axes": taking, "work_j": whole[0][0]})]


def _trend(power: np.ndarray, period: float) -> tuple[float, float]:
    """Return the work over the whole time by its straight line [J], and its variation about that line [J]."""
    work = np.cumsum(power) * period
    line = np.column_stack([np.linspace(0.0, 1.0, len(work)), np.ones(len(work))])
    (done, start), *_ = np.linalg.lstsq(line, work, rcond=None)
    return float(done), float(np.ptp(work - line @ np.array([done, start])))
