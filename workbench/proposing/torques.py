"""Columns of torques: measured or commanded."""

from __future__ import annotations

import numpy as np

from .assignment import Signals, filled, moves
from .gains import settle_feedforward
from .law import is_law
from .match import held_share
from .names import Role
from .roles import drives


def settle_torques(out: Signals, data: dict[str, np.ndarray]) -> None:
    """Decide a torque's role: measured, unless the smoother of two or held like a command."""
    plain = out.columns.pop("torque", {})
    because = out.because.pop("torque", "its name")
    out.sure.pop("torque", None)
    # columns of one name are one signal, whatever a joint that hardly moves or has no drive looks like
    driven = {joint: c for joint, c in plain.items() if moves(data[c])}
    held = bool(driven) and float(np.median([held_share(filled(data[c])) for c in driven.values()])) > 0.4
    settle_feedforward(out, law=is_law(*_loop(out, data, out.columns.get("torque_command", {}))))
    commanded = "torque_command" in out.columns
    law = not commanded and bool(driven) and is_law(*_loop(out, data, driven))
    for joint, column in plain.items():
        if joint in out.columns.get("torque_measured", {}):
            if joint not in out.columns.get("torque_command", {}):
                out.put("torque_command", joint, column, "the other torque is measured", 0.91)
        elif commanded:
            out.put("torque_measured", joint, column, f"{because}; the other one is the command", 0.96)
        elif law:
            out.put("torque_command", joint, column, "a control law of the logged errors and speeds", 0.97)
        elif held:
            out.put("torque_command", joint, column, "constant over rows, like a controller's output", 0.9)
        else:
            out.put("torque_measured", joint, column, "its name, which does not say if measured", 0.91)


def take_drives(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Use torques of drives, or their commands, if nothing else is a torque."""
    if any(signal.startswith("torque") for signal in out.columns):
        return
    free = [n for n in data if n not in out.used()]
    for signal, joint, column in drives(free, roles, list(out.columns.get("position", {}))):
        if joint not in out.columns.get(signal, {}):
            out.put(signal, joint, column, "a drive's signal, by its name; read as torque", 0.91)


def _loop(
    out: Signals, data: dict[str, np.ndarray], torques: dict[str, str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Errors, speeds and torques (N, n) of the joints that are driven; no columns where not all are logged.

    Args:
        out, data: what is known.
        torques: joint -> column of its torque; joints that are called otherwise are in the positions' order.
    """
    signals = [out.columns.get(s, {}) for s in ("position_reference", "position", "velocity")]
    asked, seen, speeds = ({j: c for j, c in own.items() if c in data} for own in signals)
    if not set(torques) <= set(seen) and len(torques) == len(seen):
        torques = dict(zip(seen, torques.values(), strict=True))
    if not torques or not all(j in seen and j in asked and j in speeds for j in torques):
        return np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0))
    error = [filled(data[asked[j]]) - filled(data[seen[j]]) for j in torques]
    speed = [filled(data[speeds[j]]) for j in torques]
    torque = [filled(data[name]) for name in torques.values()]
    return np.stack(error, axis=1), np.stack(speed, axis=1), np.stack(torque, axis=1)
