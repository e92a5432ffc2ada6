"""The experiment that shows more of the unexplained error, chosen by where that error is largest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError, Recording, Share, SimulationError
from workbench.models import Model

from ..policy import POLICY
from .experiment_design import Option, designed

_FASTEST_HZ = 30.0  # up to which speeds are passed

_ADVICE = {
    "speed": "move through these speeds in both directions, with large and with small accelerations",
    "position": "move slowly back and forth across this range",
    "frequency": "excite only this band",
    "time": "repeat the same run. If the error returns at the same time, it depends on the motion. If not, "
    "look for another cause, such as temperature or an outside force",
}
_AT = {"speed": "at speeds of ", "position": "at positions of ", "frequency": "at ", "time": "from "}


def follow_up(model: Model, where: Sequence[Share], recordings: Sequence[Recording]) -> str:
    """Return one or two sentences on what to record where the error is largest, with the command that designs
    it.

    Args:
        model: the machine, with what is known of it.
        where: shares of the rest, the largest first; none where nothing is known of its place.
        recordings: what was recorded so far, which nothing proposed exceeds.
    """
    if not where:
        return "Record slow sweeps, steady runs and a multisine, and hold out one recording for testing."
    most, rate = where[0], 1.0 / recordings[0].period
    low, high = most.range
    place = f"{_AT[most.quantity]}{low:.3g} to {high:.3g} {most.unit}"
    said = (
        f"Most of the remaining error is in the {most.axis} {most.signal}, {place}: {_ADVICE[most.quantity]}"
    )
    if most.quantity == "frequency" and low > POLICY.resolved * rate:
        return f"{said}, with a log faster than {rate:.4g} rows per second."
    command = _command(model, most, recordings)
    return f"{said}{f' ({command})' if command else ''}. Hold out one recording for testing."


def _command(model: Model, most: Share, recordings: Sequence[Recording]) -> str:
    """Return the command that designs the experiment; empty if this machine has no such experiment."""
    option = _option(most, recordings)
    if option is None:
        return ""
    try:
        return designed(model, option, recordings)[1]
    except (InputError, SimulationError):
        return ""


def _option(most: Share, recordings: Sequence[Recording]) -> Option | None:
    low, high = most.range
    if most.quantity == "frequency":
        return Option("multisine", "torque", _short(max(0.8 * low, 0.2)), _short(max(1.25 * high, 1.0)), 1.0)
    if most.quantity == "position":
        return Option("chirp", "position", 0.1, 0.6, 1.0)
    if most.quantity == "speed":
        # harder than recorded, within limits: these speeds are to be passed
        return Option("multisine", "torque", 0.2, _fast_enough(most, recordings), 1.5)
    return None


def _short(value: float) -> float:
    return float(f"{value:.2g}")


def _fast_enough(most: Share, recordings: Sequence[Recording]) -> float:
    """Return the frequency [Hz] at which motion of the recorded width has twice the speeds in question."""
    axis = recordings[0].axes.index(most.axis)
    wide = np.sqrt(2.0) * max(float(r.position[:, axis].std()) for r in recordings)
    fastest = max(abs(x) for x in most.range)
    return _short(float(np.clip(2.0 * fastest / (2.0 * np.pi * max(wide, 1e-9)), 1.0, _FASTEST_HZ)))
