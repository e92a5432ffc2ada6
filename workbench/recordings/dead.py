"""Drives without torque although one is commanded: an emergency stop, or drives enabled late."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from workbench.core import Controller

_WINDOW_S = 0.04  # over which torques are compared
_LEAST_S = 0.1  # a shorter silence is no drive that is off
_NIL = 0.1  # of what is asked: less is none
_ASKED = 0.5  # of the usual torque is asked of a drive before its silence says something
_ALIKE = 0.5  # correlation of a torque with what is asked, while there is one
_FEW = 10  # rows with a torque
_NOISE = 5.0  # deviations of the silence, above which a row has torque


def dead_rows(
    signals: Mapping[str, np.ndarray],
    good: np.ndarray,
    period: float,
    controller: Controller,
    coordinates: str,
) -> np.ndarray:
    """Return rows and axes (N, n) bool in which a drive gives no torque although one is commanded.

    Args:
        signals: name -> (N, n), on a uniform clock.
        good: rows that were measured, (N,) bool.
        period: of the rows [s].
        controller: the loop, where it is stated: what it asks for stands in for a command that is not logged.
        coordinates: of the signals.
    """
    measured, asked = signals.get("torque_measured"), _asked(signals, controller, coordinates)
    if measured is None:
        return np.zeros((len(good), 0), bool)
    if asked is None or np.array_equal(asked, measured):
        return np.zeros(measured.shape, bool)
    width = max(5, round(_WINDOW_S / period))
    least = max(2 * width, round(_LEAST_S / period))
    return np.column_stack(
        [_dead(m, a, good, width, least) for m, a in zip(measured.T, asked.T, strict=True)]
    )


def dead_note(dead: np.ndarray, axes: Sequence[str], period: float) -> str:
    """Return one sentence: which drives are off, and when."""
    any_dead = np.array([rows.any() for rows in dead])
    named = [f"'{axis}'" for axis, rows in zip(axes, dead.T, strict=True) if rows.any()]
    spans = [f"from {a * period:.4g} s " + _until(b, len(any_dead), period) for a, b in _spans(any_dead)]
    which = "the drives" if len(named) == len(axes) else f"the drive of {', '.join(named)}"
    gives = "give" if len(named) > 1 else "gives"
    return (
        f"{', '.join(spans).capitalize()} {which} {gives} no torque although one is commanded, as after an "
        f"emergency stop: these {int(any_dead.sum())} of {len(any_dead)} rows are left out."
    )


def _until(end: int, rows: int, period: float) -> str:
    return "on" if end >= rows else f"to {end * period:.4g} s"


def _asked(signals: Mapping[str, np.ndarray], controller: Controller, coordinates: str) -> np.ndarray | None:
    if "torque_command" in signals:
        return signals["torque_command"]
    known = "position_reference" in signals and "velocity" in signals and controller.kind == "pd"
    if not known or controller.coordinates != coordinates:
        return None
    error = signals["position_reference"] - signals["position"]
    aim = signals.get("velocity_reference", np.zeros_like(error))
    torque = np.array(controller.kp) * error + np.array(controller.kd) * (aim - signals["velocity"])
    return torque + signals.get("torque_feedforward", np.zeros_like(error))


def _dead(measured: np.ndarray, asked: np.ndarray, good: np.ndarray, width: int, least: int) -> np.ndarray:
    """Return the rows (N,) of one axis from the first to the last in which its drive gives no torque."""
    none = np.zeros(len(measured), bool)
    if not good.any() or np.ptp(measured[good]) == 0:
        return none
    # running sums may end a little below nothing
    powers = (scipy.ndimage.uniform_filter1d(x**2, width) for x in (measured, asked))
    got, wanted = (np.sqrt(np.maximum(power, 0.0)) for power in powers)
    awake = good & (got >= _NIL * wanted)
    given = measured[awake]
    if not _follows(given, asked[awake]):
        return none
    usual = float(np.sqrt(np.mean(given**2))) if len(given) else 0.0
    silent = (got < _NIL * np.minimum(wanted, usual)) & (wanted > _ASKED * usual) & good
    out = none.copy()
    for a, b in _spans(silent):
        if b - a < width:  # a torque that only comes late after a step
            continue
        # the window's edges are not the drive's, and nothing may be asked of it for a while
        inside = measured[a:b]
        high = _NOISE * float(np.std(inside)) + abs(float(np.mean(inside)))
        loud = np.flatnonzero(np.abs(measured) > high)
        before, after = loud[loud < a], loud[loud >= b]
        first = int(before[-1]) + 1 if len(before) else 0
        last = int(after[0]) if len(after) else len(measured)
        out[first:last] |= last - first >= least
    return out


def _follows(given: np.ndarray, asked: np.ndarray) -> bool:
    """Return whether a drive follows its command while it gives a torque; else zero torque is no sign.

    A law of a wrong sign asks for a hundred times what the axis needs, and gets a tenth of it by chance.
    """
    if len(given) < _FEW or not (given.std() > 0 and asked.std() > 0):
        return len(given) >= _FEW
    return float(np.corrcoef(given, asked)[0, 1]) > _ALIKE


def _spans(rows: np.ndarray) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], rows, [False]]).astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]
