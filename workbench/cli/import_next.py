"""The next step after an import: inspect the data, then compare, or first correct what is wrong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from workbench.inspection import Remark


def next_step(
    description: Mapping[str, Any],
    remarks: Sequence[Remark],
    target: Path,
    model: str | None,
    *,
    short: bool,
    looped: bool,
) -> str:
    """Return the last line of an import.

    Args:
        description: the recording's TOML.
        remarks: what its inspection says.
        target: where it was written.
        model: the model that was named, if one was.
        short: whether it has too few rows to be compared.
        looped: whether the recording or the model states the loop.
    """
    wrong = [remark for remark in remarks if remark.severity == "problem"]
    if wrong:
        first = {remark.topic: remark for remark in reversed(wrong)}  # one example of each kind
        ways = dict.fromkeys(
            _way(first[topic], description) for topic in dict.fromkeys(r.topic for r in wrong)
        )
        return f"Next: {'; '.join(ways)}. Then: workbench inspect {target}"
    if short:
        return "Next: import a longer log."
    if not looped and not any(s.startswith("torque") for s in description["columns"]):
        if amperes := description["columns"].get("current"):
            names = ",".join(name["column"] if isinstance(name, dict) else name for name in amperes)
            constants = ",".join(["K*N*m"] * len(amperes))
            return (
                "Next: convert the currents to torque, with K in N m per A: --column "
                f"torque_measured={names} --unit torque={constants}; or give the gains (--kp, --kd)."
            )
        return "Next: name the torque (--column torque_measured=…) or the gains (--kp, --kd)."
    return f"Next: workbench inspect {target}. Then: workbench compare {model or 'MODEL'} {target}"


def _way(remark: Remark, description: Mapping[str, Any]) -> str:
    """Return how to correct one problem."""
    column = _column(remark, description)
    if remark.topic == "sign":
        which = "every torque column" if remark.value.get("whole") else "the columns with the wrong sign"
        return f"negate {which}, e.g. {{column = '{column}', scale = -1.0}} in [columns]"
    if remark.topic == "swap":
        return "exchange the swapped names in [columns], or give --column with --force"
    if remark.topic == "zero":
        return "add the offsets in [columns], e.g. {column = 'NAME', offset = NUMBER}, in the unit of [units]"
    if remark.topic == "unit":
        scale = f"{1.0 / abs(remark.value['factor']):.4g}" if remark.value.get("factor") else "NUMBER"
        return f"give the right unit in [units], or a factor, e.g. {{column = '{column}', scale = {scale}}}"
    if "rate_hz" in remark.value:
        return f"correct the clock, e.g. --rate {remark.value['rate_hz']:.4g} --force if no column is time"
    return "correct the log, or its [columns], [units] and [controller]"


def _column(remark: Remark, description: Mapping[str, Any]) -> str:
    """Return the column that a remark is most likely about."""
    columns, axes = description["columns"], list(description["axes"])
    said = remark.text.lower()
    about = remark.value.get("signal") or ("torque_measured" if "torque" in said else "velocity")
    names = columns.get(about) or columns["position"]
    name = names[axes.index(remark.axis) if remark.axis in axes else 0]
    return name["column"] if isinstance(name, dict) else name
