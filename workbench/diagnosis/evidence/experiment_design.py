"""Experiments for a machine, as designs and as the commands that make them."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.comparison import with_torque_by_law
from workbench.core import InputError, Recording
from workbench.core.paths import models_folder
from workbench.frf import Design, Limit, chirp, multisine, scale_to_limits
from workbench.models import Model
from workbench.recordings.velocity import derive_velocity
from workbench.simulation import held_posture, holds, joint_limits, limits_of, predictor, whole_period

from ..policy import POLICY

_LENGTH_S = 6.0  # of each experiment


@dataclass(frozen=True)
class Option:
    """An experiment that may distinguish effects: band [Hz], and amplitude relative to the recorded
    motion.
    """

    kind: str
    drive: str
    f_min: float
    f_max: float
    share: float
    posture: float = 0.5  # place in the range of the last joint


def designed(model: Model, option: Option, recordings: Sequence[Recording]) -> tuple[Design, str]:
    """Return an experiment for this machine, no harder than the recorded motion, and the command that makes
    it.

    Raises:
        InputError: it is none for this machine, or what is known does not say how hard it may be.
    """
    model, loop = in_a_loop(model, recordings)
    rate = 1.0 / recordings[0].period
    length = whole_period(model, _LENGTH_S, rate)
    hold = held_posture(model, _posture(model, option.posture))
    if option.drive == "torque":
        size = option.share * _torques(model, recordings)
    else:
        travel = np.max([_spread(r, ("position",)) for r in recordings], axis=0)
        size = option.share * np.sqrt(2.0) * travel
    size = [float(f"{s:.2g}") for s in np.maximum(size, 1e-6)]
    band = {
        "f_min_hz": option.f_min,
        "f_max_hz": min(option.f_max, POLICY.resolved * rate),
        "rate_hz": rate,
        "hold": hold,
    }
    driven = "torque_feedforward" if option.drive == "torque" else "position_reference"
    if option.kind == "multisine":
        design = multisine(model.axes, **band, period_s=length, rms=size, driven=driven, periods=1)
    else:
        if not hold:
            raise InputError("no loop follows a reference")
        design = chirp(model.axes, **band, duration_s=length, amplitude=size, driven=driven)
    limits: list[Limit] = limits_of(model, [max(_fastest(r) for r in recordings)])
    scaled = scale_to_limits(design, predictor(model, limits), limits)
    words = [
        f"workbench excite {_opened_by(model)}{loop} -o next.toml",
        f"--kind {option.kind} --drive {option.drive}",
        f"--f-min {option.f_min:g} --f-max {band['f_max_hz']:g} --period {length:g}",
        *(f"--amplitude {s * scaled.factor:.2g}" for s in size),
    ]
    if option.posture != 0.5:
        words += [f"--posture {name}={value:.3g}" for name, value in _posture(model, option.posture).items()]
    return scaled.design, " ".join(words)


def in_a_loop(model: Model, recordings: Sequence[Recording]) -> tuple[Model, str]:
    """Return the model in its loop, or in the first loop that a recording states, and the option for that."""
    if not holds(model):
        for r in recordings:
            closed = replace(model, controller=r.controller)
            if r.source is not None and holds(closed):
                return closed, f" --loop {shlex.quote(str(r.source))}"
    return model, ""


def _fastest(recording: Recording) -> float:
    """Return the highest speed of any axis, derived as on loading if it was not recorded."""
    speed = recording.get("velocity")
    if speed is None:
        speed = derive_velocity(recording.position, recording.period)
    return float(np.nanmax(np.abs(speed)))


def _opened_by(model: Model) -> str:
    """Return the name of a shipped model, otherwise its file, as a command line takes it."""
    shipped = model.source == models_folder() / f"{model.name}.toml"
    return model.name if shipped or model.source is None else shlex.quote(str(model.source))


def _posture(model: Model, place: float) -> dict[str, float]:
    """Return a position reference with the last joint inside its range; empty if it has no range.

    Raises:
        InputError: a posture is asked of a machine without a range or loop in joint coordinates.
    """
    low, high = joint_limits(model)[-1]
    if place == 0.5:
        return {}
    if not np.isfinite(low) or model.controller.coordinates != "joint":
        raise InputError("no range to choose a posture from")
    return {model.joints[-1]: float(low + place * (high - low))}


def _torques(model: Model, recordings: Sequence[Recording]) -> np.ndarray:
    """Return the largest spread (n,) of the torque in recordings; computed by the law of the loop if none was
    logged.

    Raises:
        InputError: nothing says what torque there was.
    """
    known = with_torque_by_law(model, recordings)
    names = ("torque_command", "torque_measured", "torque_feedforward")
    torque = np.max([_spread(r, names) for r in known or recordings], axis=0)
    if not torque.any():
        raise InputError("no torque is known from which to size an experiment")
    return torque


def _spread(recording: Recording, names: Sequence[str]) -> np.ndarray:
    """Return the standard deviation (n,) of the first of these signals that is present and varies."""
    for name in names:
        values = recording.get(name)
        if values is not None and np.ptp(values) > 0:
            return values.std(axis=0)
    return np.zeros(len(recording.axes))
