"""Recordings of a case, made, written and read back as a user's are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from workbench.core import Recording
from workbench.effects import load_model
from workbench.models import Model
from workbench.recordings import load_recordings, save_recording
from workbench.rigs import (
    Experiment,
    HiddenEffect,
    Sensors,
    VirtualLeg,
    revealing_experiments,
    work_and_rest,
)

from .cases import Case
from .degrade import degrade
from .experiments import experiments_for
from .field.plant import recorded
from .second.hidden import Hidden
from .second.leg import Noise, SecondLeg
from .second.motions import motions


@dataclass(frozen=True)
class Recorded:
    """What a diagnosis is given."""

    model: Model
    training: tuple[Recording, ...]
    held_out: tuple[Recording, ...]


def record(case: Case, folder: Path) -> Recorded:
    """The demo's experiments, and those without which the hidden effects would not show, or odd ones.

    Args:
        case: of any simulator.
        folder: where the model's file is kept, where it has one of its own.

    Raises:
        SimulationError: the leg runs away.
    """
    if case.field is not None:
        model, made = recorded(case.field, folder)
        read = _written_and_read(made)
        return Recorded(model, read[:-1], read[-1:])
    model = load_model("leg")
    if case.rig == "second":
        read = _written_and_read(_second(case))
        return Recorded(model, read[:-1], read[-1:])
    sensors, period = Sensors(), 3e-3
    *training, judge = experiments_for([h.effect for h in case.hidden], case.seed)
    match case.recorded:
        case "one_chirp":
            training = training[:1]
        case "slow_only":
            training = training[-1:]
        case "short":
            training = [_first(e, 3.0) for e in training if e.excitation.kind != "multisine"]
        case "long":
            training = [*training, work_and_rest()]
        case "revealing":
            training = [e for e in revealing_experiments() if e.name != "work_and_rest"]
        case "coarse":
            sensors = Sensors(encoder=2 * np.pi / 2**12)
        case "noisy":
            sensors = Sensors(velocity_noise=0.06, torque_noise=0.1)
        case "fast_loop":
            period = 2e-3
    hidden = [HiddenEffect(h.effect, h.axis, h.location, h.parameters) for h in case.hidden]
    leg = VirtualLeg(hidden, case.seed, sensors, control_period=period)
    recordings = [_degraded(r, case.recorded) for r in leg.run([*training, judge])]
    held_out = case.recorded not in ("no_holdout", "one_chirp")
    read = _written_and_read(recordings if held_out else recordings[:-1])
    return Recorded(model, read[:-1], read[-1:]) if held_out else Recorded(model, read, ())


def _second(case: Case) -> list[Recording]:
    """The second leg's motions, the one that judges last."""
    noise = Noise(encoder=2 * np.pi / 2**12) if case.recorded == "coarse" else Noise()
    tick = 2e-3 if case.recorded == "fast_loop" else 3e-3
    hidden = [Hidden(h.effect, h.axis, h.location, h.parameters) for h in case.hidden]
    return SecondLeg(hidden, case.seed, noise, tick).run(motions(case.seed))


def _first(experiment: Experiment, duration: float) -> Experiment:
    rows = round(duration / experiment.period)
    return replace(
        experiment, reference=experiment.reference[:rows], feedforward=experiment.feedforward[:rows]
    )


def _degraded(recording: Recording, how: str) -> Recording:
    match how:
        case "no_velocity":
            return degrade(recording, without=("velocity",))
        case "no_torque":
            return degrade(recording, without=("torque_measured",))
        case "jitter":
            return degrade(recording, jitter=0.05)
        case "every_third":
            return degrade(recording, every=3)
        case _:
            return recording


def _written_and_read(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    with TemporaryDirectory() as folder:
        files = [Path(folder) / f"{number}_{r.name}.toml" for number, r in enumerate(recordings)]
        for recording, file in zip(recordings, files, strict=True):
            save_recording(recording, file)
        return tuple(load_recordings([str(file) for file in files]))
