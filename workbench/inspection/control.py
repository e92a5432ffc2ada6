"""The logged command compared with the stated controller: ticks, gains, signs, swaps."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from workbench.core import Controller, Recording
from workbench.core.text import counted

from .coordinates import Elsewhere, found_elsewhere, maps
from .factors import name_factor
from .law import LawFit, Ticks, fit_commands, fit_gains, fit_sensors, ticks, unexplained
from .result import Remark
from .speeds import explain_speed, remark_on_speed
from .ticks import find_ticks

_EXACT = 0.005  # what a law that holds may leave, as a part of the command's variation
_HOLDS = 0.02  # the same of a law whose speed was not logged, and is made of the position
_FAIR = 0.2  # above this the law is not followed
_MULTIPLE = 1.5  # of what the law asks for: a measured torque that is as far off is in another unit
_OFF = 0.02  # relative deviation of a gain that is reported
_SWAPS = (
    ("position",),
    ("velocity",),
    ("position", "velocity"),
    ("command",),
    ("reference",),
    ("feedforward",),
    ("command", "feedforward"),
    ("position", "velocity", "command", "reference", "feedforward"),
)


def remark_on_control(recording: Recording, transmission: np.ndarray | None) -> list[Remark]:
    """Check period and phase of the controller's ticks, then the law itself.

    Args:
        recording: what was measured.
        transmission: J in q_p = J q_s, shape (n, n), or None to try the usual ones.
    """
    if recording.get("torque_command") is None:
        return _measured(recording, transmission)
    ratio, phase, remarks = find_ticks(recording)
    if recording.get("position_reference") is None:
        return remarks
    at = ticks(recording, ratio, phase)
    if len(at.command) < 50 or np.ptp(at.command) == 0:
        return remarks
    if recording.controller.kind not in ("pd", "cascade_pv"):
        return remarks + _pushes_away(recording, at)
    c = recording.controller
    tried = maps(recording, c, transmission)
    if "velocity" in recording.derived:
        speeds = explain_speed(recording, ratio, phase, tried)
        if speeds[0].fit.rest < _HOLDS:
            return [*remarks, remark_on_speed(speeds, recording.axes)]
    fit, m = min(((fit_gains(at, c, m), m) for m in tried), key=lambda found: found[0].rest)
    if fit.rest > _EXACT:
        if c.kind == "pd" and (elsewhere := found_elsewhere(recording, at, transmission)) is not None:
            return [*remarks, _elsewhere(elsewhere)]
        other = _alternative(recording, at, ratio, phase, tried, fit.rest)
        if other is not None:
            return remarks + other
    if fit.rest > _FAIR:
        text = (
            f"The logged command does not follow the stated law: {100 * fit.rest:.2g} % of it remains "
            "unexplained."
        )
        if recording.coordinates != c.coordinates and transmission is None:
            text += " Its coordinates differ from the signals'; give the transmission."
        return [*remarks, Remark("warning", "controller", None, text, {"unexplained": fit.rest})]
    return remarks + _read_gains(recording, fit, m)


def _measured(recording: Recording, transmission: np.ndarray | None) -> list[Remark]:
    """Return a remark if a measured torque without a command is a clear multiple of the law's command."""
    c, torque = recording.controller, recording.get("torque_measured")
    if c.kind != "pd" or torque is None or recording.get("position_reference") is None:
        return []
    at = ticks(recording.with_signals(torque_command=torque), 1, 0)
    if len(at.command) < 50 or np.ptp(at.command) == 0:
        return []
    fit = min((fit_commands(at, c, m) for m in maps(recording, c, transmission)), key=lambda fit: fit.rest)
    if fit.rest > _FAIR:
        return []
    said = zip(recording.axes, fit.factors.tolist(), strict=True)
    return [
        _scaled("The measured torque", "torque_measured", axis, 1 / factor, {"unexplained": fit.rest})
        for axis, factor in said
        if not 1 / _MULTIPLE < factor < _MULTIPLE
    ]


def _pushes_away(recording: Recording, at: Ticks) -> list[Remark]:
    """Return a remark on an unstated law that drives an axis away from its reference: none would hold."""
    n = len(recording.axes)
    fit = fit_gains(at, Controller("pd", recording.coordinates, (1.0,) * n, (1.0,) * n), np.eye(n))
    remarks = []
    for i, axis in enumerate(recording.axes if fit.rest < _EXACT else ()):
        kp, std = fit.by_name[f"kp_{i}"]
        if kp < -5 * std:
            text = (
                f"The command of '{axis}' is a PD law of kp {kp:.4g}, which pushes away from the reference: "
                "its torque or its motion has the wrong sign."
            )
            remarks.append(Remark("problem", "sign", axis, text, {"kp": kp, "unexplained": fit.rest}))
    return remarks


def _elsewhere(found: Elsewhere) -> Remark:
    text = f'The loop acts in other coordinates: {found}. State coordinates = "{found.coordinates}".'
    value = {
        "coordinates": found.coordinates,
        "unexplained": found.rest,
        "to_controller": found.to_controller,
    }
    return Remark("problem", "controller", None, text, value)


def _alternative(
    recording: Recording, at: Ticks, ratio: int, phase: int, tried: list[np.ndarray], rest: float
) -> list[Remark] | None:
    """The simplest mistake that makes the law hold: late measurements, a wrong sensor, swapped columns."""
    c, axes = recording.controller, recording.axes
    enough = min(0.1, 0.2 * rest)
    for lag in range(1, max(4, ratio) + 1):
        late = ticks(recording, ratio, phase, lag)
        fit, m = min(((fit_gains(late, c, m), m) for m in tried), key=lambda found: found[0].rest)
        if fit.rest < enough:
            text = f"The command uses measurements from {counted(lag, 'row')} earlier."
            severity = "note" if recording.timing.delay == "loop" or lag <= 1 else "warning"
            value = {"rows": lag, "delay_s": lag * recording.period}
            return [Remark(severity, "clock", None, text, value), *_read_gains(recording, fit, m)]
    for scaled in (fit_sensors, fit_commands):
        best_fit = min((scaled(at, c, m) for m in tried), key=lambda fit: fit.rest)
        if best_fit.rest < enough:
            return _read_columns(axes, best_fit)
    found: list[tuple[float, tuple[str, ...], int, int, LawFit, np.ndarray]] = []
    for signals in _SWAPS:
        for a, b in combinations(range(len(axes)), 2):
            swapped = at.swapped(signals, a, b)
            found += [(fit.rest, signals, a, b, fit, m) for m in tried for fit in [fit_gains(swapped, c, m)]]
    best = min(found, key=lambda entry: entry[0], default=None)
    if best is None or best[0] > enough:
        return None
    _, signals, a, b, fit, m = best
    what = {"command": "torque_command", "reference": "position_reference"}
    named = "The " + " and ".join(what.get(s, s) for s in signals) if len(signals) < 5 else "All"
    text = f"{named} columns of '{axes[a]}' and '{axes[b]}' are swapped: after an exchange, the law holds."
    value = {"axes": [axes[a], axes[b]], "signals": list(signals), "unexplained": fit.rest}
    return [Remark("problem", "swap", None, text, value), *_read_gains(recording, fit, m)]


def _read_gains(recording: Recording, fit: LawFit, m: np.ndarray) -> list[Remark]:
    known = {k: (f, s) for k, (f, s) in fit.by_name.items() if s < 0.1 * abs(f)}
    value = {
        "factors": {k: {"value": f, "std": s} for k, (f, s) in known.items()},
        "unexplained": fit.rest,
        "to_controller": m,
    }
    gains = {k: f for k, (f, s) in known.items() if not k.startswith("feedforward")}
    sure = max(_OFF, 2 * fit.rest)
    off = {k: f for k, (f, std) in known.items() if abs(f - 1) > max(sure, 5 * std)}
    rough = unexplained(fit.rest)
    if not off:
        text = f"The logged command follows the stated law; {rough}."
        return [Remark("ok" if fit.rest < _EXACT else "note", "gains", None, text, value)]
    common = _common(gains)
    if common is not None and len(gains) > 1 and abs(common - 1) > sure:
        if _guessed(recording, common):
            text = f"The command is {common:.4g} times the stated law, with a velocity that was not measured."
            return [Remark("note", "gains", None, text, {**value, "factor": common})]
        return [_scaled("The command", "torque_command", None, common, value)]
    for gain, signal in (("kd", "velocity"), ("kp", "position")):
        one = _common({k: f for k, f in gains.items() if k.startswith(gain)})
        if one is not None and (one < 0 or name_factor(one)) and all(k.startswith(gain) for k in off):
            return [_scaled(f"{signal.capitalize()} (or {gain})", signal, None, 1 / one, value)]
    return [_one_gain(recording, k, f, known[k][1], value) for k, f in off.items()]


def _one_gain(recording: Recording, key: str, factor: float, std: float, value: dict) -> Remark:
    name, i = key.rsplit("_", 1)
    axis = recording.axes[int(i)]
    number = f"{factor:.4g} +- {std:.1g} times"
    value = {**value, "gain": name, "factor": factor, "std": std}
    if name == "feedforward":
        text = f"The command contains the feedforward of '{axis}' {number}."
        return Remark("problem", "sign" if factor < 0 else "unit", axis, text, value)
    stated = getattr(recording.controller, {"kd": "kv"}.get(name, name) if _cascade(recording) else name)
    text = f"{name} of '{axis}' is {number} the stated one"
    text += "." if _cascade(recording) else f": {factor * stated[int(i)]:.4g} instead of {stated[int(i)]:g}."
    if factor < 0:
        return Remark("problem", "sign", axis, text, value)
    return Remark("note" if _guessed(recording, factor) else "warning", "gains", axis, text, value)


def _guessed(recording: Recording, factor: float) -> bool:
    """Return whether the factor may come from a derived velocity that the controller did not use."""
    return "velocity" in recording.derived and abs(factor - 1) < 0.5


def _cascade(recording: Recording) -> bool:
    return recording.controller.kind == "cascade_pv"


def _read_columns(axes: tuple[str, ...], fit: LawFit) -> list[Remark]:
    remarks = []
    for key, (factor, std) in fit.by_name.items():
        signal, i = key.rsplit("_", 1)
        if std < 0.1 * abs(factor) and abs(factor - 1) > max(_OFF, 5 * std):
            value = {"signal": signal, "factor": 1 / factor, "unexplained": fit.rest}
            remarks.append(_scaled(f"The logged {signal}", signal, axes[int(i)], 1 / factor, value))
    return remarks


def _scaled(what: str, signal: str, axis: str | None, factor: float, value: dict) -> Remark:
    """Return a remark on a column that is `factor` times what the stated law says."""
    of = f"{what} of '{axis}'" if axis else what
    value = {**value, "signal": signal, "factor": factor}
    if abs(abs(factor) - 1) <= 2 * _OFF and factor < 0:
        return Remark("problem", "sign", axis, f"{of} has the wrong sign for the stated law.", value)
    meaning = name_factor(factor)
    cause = f"a mix-up of {meaning}" if meaning else "a gear ratio, a unit or the gains"
    text = f"{of} is {factor:.4g} times what the stated law says: {cause}."
    return Remark("problem", "unit", axis, text, {**value, "meaning": meaning})


def _common(factors: dict[str, float]) -> float | None:
    """Return the one factor that all share, or None."""
    values = np.array(list(factors.values()))
    if len(values) == 0:
        return None
    middle = float(np.median(values))
    return middle if np.all(np.abs(values - middle) < 0.03 * abs(middle)) else None
