"""Measured torque compared with the command: swap, sign, unit, delay, saturation; and command limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import Recording
from workbench.recordings.noise import NoiseLevels

from .factors import TORQUE, name_factor
from .lags import follow, is_broad, swapped_columns
from .result import Remark

_REACH_S = 0.1  # the largest delay looked for
_SCALE = 0.05
_OFTEN = 0.005  # share of rows at the extreme from which it is a limit
_SURE = 4.0  # deviations from which a delay is one
_AT_ONCE = 0.02  # of a row: what comes within is in the same one


def driven(recording: Recording) -> Recording:
    """Return the longest stretch of valid rows in which the drives are on."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], recording.valid, [False]]).astype(int)))
    if recording.valid.all() or not len(edges):
        return recording
    first, last = max(zip(edges[::2], edges[1::2], strict=True), key=lambda span: span[1] - span[0])
    signals = {name: x[first:last] for name, x in recording.signals.items()}
    rows = slice(first, last)
    time = recording.time[rows] - recording.time[first]
    return replace(recording, time=time, signals=signals, valid=None, extra={}, guessed={})


def remark_on_torque(recording: Recording, noise: NoiseLevels) -> list[Remark]:
    """Return remarks on how the measured torque follows the command."""
    command, measured = recording.get("torque_command"), recording.get("torque_measured")
    if command is None or measured is None or np.array_equal(command, measured):
        return []
    reach = int(min(max(4, np.ceil(_REACH_S / recording.period)), len(recording) // 4))
    live = np.flatnonzero((np.ptp(command, axis=0) > 0) & (np.ptp(measured, axis=0) > 0))
    order, remarks = swapped_columns(
        recording, live, lambda a, b: follow(command[:, a], measured[:, b], reach)[1],
        "Commanded and measured torque",
    )  # fmt: skip
    for i in live:
        x, y = command[:, order[i]], measured[:, i]
        remarks += _follows(recording.axes[i], x, y, noise.torque_std[i], recording.period, reach)
    return remarks


def _follows(
    axis: str, command: np.ndarray, measured: np.ndarray, noise: float, period: float, reach: int
) -> list[Remark]:
    lag, alike = follow(command, measured, reach)
    if alike < 0.6:
        text = f"Measured torque of '{axis}' does not follow its command (correlation {alike:.2g})."
        return [Remark("warning", "unit", axis, text, {"correlation": alike})]
    core = slice(reach + 1, -reach - 1)
    near = np.column_stack([np.roll(command, lag + s)[core] for s in (-1, 0, 1)])
    y = measured[core]
    # a line through three neighbouring rows: its centre is the delay, to a part of a row
    columns = np.column_stack([near, np.ones(len(y))])
    weights, *_ = np.linalg.lstsq(columns, y, rcond=None)
    gain = float(weights[:3].sum())
    aside = np.array([-1.0, 0.0, 1.0, 0.0]) / gain
    delay = float((lag + weights @ aside) * period)
    scatter = float(np.std(y - columns @ weights) * period)
    error = scatter * float(np.sqrt(aside @ np.linalg.pinv(columns.T @ columns) @ aside))
    asked = near @ weights[:3] + weights[3]
    remarks = _limit(axis, asked, y, noise)
    if gain < 0:
        text = f"Measured torque of '{axis}' has the wrong sign against its command."
        remarks.append(Remark("problem", "sign", axis, text, {"factor": gain}))
    if abs(abs(gain) - 1) > _SCALE and not remarks:
        meaning = name_factor(gain, named=TORQUE)
        severity = "problem" if meaning else "warning"
        cause = f"a mix-up of {meaning}" if meaning else "torque constant, gear ratio or current loop"
        text = f"Measured torque of '{axis}' is {abs(gain):.4g} times its command: {cause}."
        remarks.append(Remark(severity, "unit", axis, text, {"factor": gain, "meaning": meaning}))
    if not is_broad(np.diff(command)):
        text = f"The command of '{axis}' has too few frequencies to show a delay of its measured torque."
        remarks.append(Remark("note", "delay", axis, text, {"gain": gain}))
    elif delay < -max(0.25 * period, _SURE * error):
        text = f"Measured torque of '{axis}' comes {-1e3 * delay:.3g} ms before its command."
        remarks.append(Remark("problem", "clock", axis, text, {"delay_s": delay}))
    else:
        text = f"Measured torque of '{axis}' follows its command after {1e3 * delay:.3g} ms."
        if abs(delay) < max(_SURE * error, _AT_ONCE * period):
            text = f"Measured torque of '{axis}' comes with its command, in the same row."
        remarks.append(Remark("note", "delay", axis, text, {"delay_s": delay, "gain": gain}))
    return remarks


def _limit(axis: str, asked: np.ndarray, got: np.ndarray, noise: float) -> list[Remark]:
    """The level at which the torque stops growing while the command still grows, tested against no limit."""
    best = (np.inf, np.inf, 0)
    for limit in np.quantile(np.abs(got), [0.6, 0.7, 0.8, 0.9, 0.95, 0.98, 0.99, 0.995]):
        over = np.abs(asked) > limit
        gain = _slope(asked[~over], got[~over])
        rest = got - np.clip(gain * asked, -limit, limit)
        size = float(np.mean(rest**2))
        if size < best[0]:
            best = (size, float(limit), int(np.count_nonzero(np.abs(gain * asked) > 1.05 * limit)))
    straight = float(np.mean((got - _slope(asked, got) * asked) ** 2))
    floor = 0.0 if np.isnan(noise) else noise**2
    if best[2] >= max(20, _OFTEN * len(got)) and best[0] - floor < 0.5 * (straight - floor):
        share = best[2] / len(got)
        text = f"Torque of '{axis}' saturates near {best[1]:.4g} in {100 * share:.2g} % of the rows."
        return [Remark("warning", "saturation", axis, text, {"limit": best[1], "share": share})]
    return []


def _slope(x: np.ndarray, y: np.ndarray) -> float:
    return float(x @ y / (x @ x)) if x @ x > 0 else 0.0


def command_limits(recording: Recording) -> list[tuple[int, float, float]]:
    """Return values that commands reach again and again as their ends: limits they were cut to.

    Returns:
        Axis, that value in the recording's own coordinates, and the share of rows that have it.
    """
    command = recording.get("torque_command")
    if command is None:
        return []
    found: list[tuple[int, float, float]] = []
    for i, x in enumerate(command.T):
        changes = np.count_nonzero(np.diff(x))
        if changes < 20:
            continue
        typical = len(x) / changes  # rows for which a command is held
        for extreme in (float(x.max()), float(x.min())):
            share = float(np.mean(np.abs(x - extreme) <= 1e-6 * np.ptp(x)))
            if share > _OFTEN and share * len(x) > 6 * typical:
                found.append((i, extreme, share))
    return found


def remark_on_command_limits(recording: Recording) -> list[Remark]:
    """Return remarks on commands at their largest value again and again: the controller's own limit."""
    remarks: list[Remark] = []
    for i, extreme, share in command_limits(recording):
        axis, command = recording.axes[i], recording.signals["torque_command"][:, i]
        side = "upper" if extreme == command.max() else "lower"
        text = f"Command of '{axis}' is at its {side} limit of {extreme:.4g} in {100 * share:.2g} %."
        remarks.append(Remark("warning", "saturation", axis, text, {"limit": extreme, "share": share}))
    return remarks
