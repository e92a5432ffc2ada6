"""Gains that were logged beside the references, as for drives in impedance ("MIT") mode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .assignment import Signals
from .draft import Draft

GAINS = ("kp", "kd")
_SAME = 0.01  # of a gain, by which it may vary


def settle_feedforward(out: Signals, *, law: bool) -> None:
    """Treat a commanded torque beside logged gains as feedforward, unless it is the control law itself.

    Args:
        out: the assignment so far.
        law: whether the commanded torque is a law of the logged errors and speeds.
    """
    if "kp" in out.columns and "torque_command" in out.columns and not law:
        if "torque_feedforward" not in out.columns:
            commands = out.columns["torque_command"]
            for joint, column in commands.items():
                out.put("torque_feedforward", joint, column, "commanded beside logged gains", 0.95)
        out.drop("torque_command")


def take_controller(
    draft: Draft, columns: dict[str, list[str]], axes: Sequence[str], coordinates: str
) -> dict[str, Any] | None:
    """Return the ``[controller]`` of logged gains, which are no signals; None if none, or they change.

    Args:
        draft: the table; takes what is assumed and noted.
        columns: signal -> its columns, one per axis; gains are taken out.
        axes: names of the axes.
        coordinates: of the recording, in which drives close their loops.
    """
    named = {gain: columns.pop(gain) for gain in GAINS if gain in columns}
    draft.assumed = [a for a in draft.assumed if a.what not in GAINS]
    if "kp" not in named or draft.answers.kp:
        return None
    values = {gain: _values(draft, gain, names, axes) for gain, names in named.items()}
    if any(v is None for v in values.values()) or "position_reference" not in columns:
        return None
    return {"kind": "pd", "coordinates": coordinates, **values}


def gains_shown(controller: Mapping[str, Any]) -> str:
    """Return the gains in a few words."""
    return "pd, " + "; ".join(
        f"{gain} {', '.join(f'{x:.4g}' for x in controller[gain])}" for gain in GAINS if gain in controller
    )


def _values(draft: Draft, gain: str, names: Sequence[str], axes: Sequence[str]) -> list[float] | None:
    """One gain per axis; None, and a note, where one changes."""
    out = []
    for axis, name in zip(axes, names, strict=True):
        column = draft.table.columns[name]
        column = column[np.isfinite(column)]
        low, high = float(column.min()), float(column.max())
        if high - low > _SAME * max(abs(low), abs(high)):
            draft.notes.append(
                f"{gain} of {axis} changes from {low:.4g} to {high:.4g} in '{name}': the loop is left out; "
                "cut the log to rows of one gain."
            )
            return None
        out.append(float(f"{np.median(column):.6g}"))
    return out
