"""The sentences of a comparison: how large the error is, what was compared, and what stands out."""

from __future__ import annotations

import math

import numpy as np

from workbench.core import HOPELESS, MARGIN_SIGNAL, MARGIN_TOTAL, Comparison, Outlier

from .numbers import number, percent, plain, short
from .wording import times_noise


def comparison_sentence(result: Comparison) -> str:
    """Return the result of a comparison as one sentence."""
    if not math.isfinite(result.error):
        return "Nothing moves in these recordings, so there is nothing to compare."
    if result.consistent:
        return explained_sentence(result.error, result.noise_error)
    times = times_noise(result.error, result.noise_error)
    tail = f", {times} the noise floor of {number(result.noise_error)}" if times else ""
    if result.noise_error > HOPELESS:
        return (
            "The model cannot run in these loops: sensor noise alone makes its error larger than the "
            "measured motion. Check the order of the axes, units, signs and gains."
        )
    if result.outlier is not None and result.error <= MARGIN_TOTAL * result.noise_error:
        worst = outlier_phrase(result.outlier)
        return f"The model does not explain the data: {worst}. The error as a whole is at the floor."
    return f"The model does not explain the data: its error is {number(result.error)}{tail}."


def explained_sentence(error: float, noise: float) -> str:
    """Return that a model explains the data, and what does where its error is more than noise."""
    if not error > MARGIN_SIGNAL * noise:
        return "The model explains the data to the noise."
    return (
        f"The model explains the data: its error is {times_noise(error, noise)} the noise floor, and two "
        "correct simulations of this machine differ by as much."
    )


def loop_sentence(result: Comparison) -> str:
    """Return why no motion was compared; empty if it was."""
    still = [
        e.recording
        for e in result.recordings
        if np.isnan(e.position_rmse).all()
        and not any("along the measured motion" in n for n in e.recording.notes)
    ]
    # a loop that is stated keeps its gains where it is not run, for the sake of one score
    names = [plain(r.name) for r in still if not r.controller.kp]
    if not names:
        return ""
    which = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    alike = ", in all recordings alike" if len(names) < len(still) else ""
    return (
        f"The controller of {which} is not known, so only the torque that the motion needs is "
        f"compared{alike}. State its gains in [controller]."
    )


def inverse_sentence(before: Comparison | None, after: Comparison | None) -> str:
    """Return the difference between required and recorded torque; empty if it is not known."""
    if before is None or before.inverse_dynamics is None:
        return ""
    inverse = before.inverse_dynamics
    each = ", ".join(
        f"{plain(a)} {percent(float(e))}"
        for a, e in zip(before.axes, inverse.axis_relative_error, strict=False)
    )
    text = (
        f"The torque that the model needs for the measured motion differs from the measured torque by "
        f"{percent(inverse.relative_error)} ({each}; filter: {plain(inverse.filter)})."
    )
    if after is not None and after.inverse_dynamics is not None:
        text += f" With the effects added: {percent(after.inverse_dynamics.relative_error)}."
    return text


def outlier_phrase(outlier: Outlier) -> str:
    """Return ``"the knee position is off by 1.44 times its own noise; noise alone explains at most 1.3"``."""
    return (
        f"the {plain(outlier.axis)} {outlier.signal} is off by {short(outlier.ratio)} times its own noise; "
        f"noise alone explains at most {short(outlier.limit)}"
    )
