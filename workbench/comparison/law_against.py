"""The torque by the law of a loop, held against what may be otherwise in it: what its log does not state."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from workbench.core import Recording
from workbench.effects import LinkMotion, Motion, Plant, effect_named, places
from workbench.models import Model, Placement
from workbench.recordings import NoiseLevels
from workbench.simulation import law_torque, motion_of, required_torque, smooth_track

from .answer_share import Asked
from .band import corner_hz
from .counted_rows import moving
from .inverse import lowpass
from .measured_motion import FilteredRecording

Speed = Literal["sensor", "difference"]
CONSTANT, DIFFERENCE, LATE = range(3)  #: what may change the torque by the law: places in `Asked.answers`
_EDGE_S = 0.3


def law_against(recording: Recording, plant: Plant, levels: NoiseLevels, *, by_need: bool) -> list[Asked]:
    """Return what one recording says of each axis, on rows away from its ends: by the torque that the model
    needs, or by that which was measured.
    """
    n = plant.model.size
    to_actuator = recording.to_actuator(plant.model.transmission)
    band = 0.2 / recording.period
    track = smooth_track(recording, None, to_actuator, levels.position_std, levels.velocity_std, band)
    measured = None if by_need else recording.get("torque_measured")
    tick = recording.controller.period_s or recording.period
    # a torque that was measured is that of the tick at its row
    middle = 0.5 if measured is None else 0.5 - 0.5 * min(tick / recording.period, 1.0)

    def by_law(speed: Speed, *, constant: bool = False) -> np.ndarray:
        loop = reading_speed(with_reference(recording, constant), speed)
        return law_torque(loop, plant, track, middle)

    first = by_law("sensor")
    changed = [
        by_law("sensor", constant=True) - first,
        by_law("difference") - first,
        -0.5 * np.gradient(first, axis=0),  # of drives that are half a row late
    ]
    shown = recording.with_signals(torque_command=first @ to_actuator)
    corner = corner_hz(shown, plant, levels)

    def passed(values: np.ndarray) -> np.ndarray:
        return lowpass(values, recording, corner)

    def centred(values: np.ndarray) -> np.ndarray:
        # a mean over a row is less than the middle by its curvature / 24
        long = np.pad(values, ((1, 1), (0, 0)), mode="edge")
        return passed(values - np.diff(long, 2, axis=0) / 24.0)

    edge = min(len(first) // 10, int(_EDGE_S / recording.period))
    rows = np.flatnonzero(recording.valid)
    rows = rows[(rows >= edge) & (rows < len(first) - edge)]
    if measured is not None:
        lacking = passed(first - measured @ np.linalg.inv(to_actuator))
        answers = np.stack([passed(x) for x in changed], axis=-1)
        drive = np.stack([passed(np.gradient(first, axis=0)), passed(first)], axis=-1)
        none = drive[rows, 0, :0]
        return [Asked(lacking[rows, k], answers[rows, k], none, none, drive[rows, k]) for k in range(n)]
    # dry friction at rest takes any torque, also one that the model does not have
    reading = FilteredRecording(
        shown, track, to_actuator, "torque_command", corner, np.ones_like(first, bool)
    )
    (moves,) = moving([reading], [np.zeros_like(first)], plant.model.transmission)
    weights = passed(_weights(motion_of(track, shown, plant, to_actuator), plant.model))
    lacking = centred(first) - passed(required_torque(plant, track, recording.period))
    answers = np.stack([centred(x) for x in changed], axis=-1)
    out = []
    for k in range(n):
        q, w = track.position[:, k], track.velocity[:, k]
        size = float(np.sqrt(np.mean(w**2))) + 1e-12
        friction = np.stack([np.tanh(w / (0.01 * size)), np.sin(q), np.cos(q), np.ones_like(q)], axis=1)
        others = np.hstack([passed(friction), weights[:, k, np.any(weights[:, k], axis=0)]])
        parts = passed(track.acceleration), passed(w[:, None]), others
        own = rows[moves[rows, k]]
        out.append(Asked(lacking[own, k], answers[own, k], *(p[own] for p in parts)))
    return out


def _weights(motion: Motion, model: Model) -> np.ndarray:
    """Torque (N, n, C) of the weight of a first moment of each link, which may not be as the model has it."""

    moving = motion.link

    def still(joint: int) -> LinkMotion:
        link = moving(joint)
        return replace(link, rise=np.zeros_like(link.rise), spin_up=np.zeros_like(link.spin_up))

    motion = replace(motion, velocity=np.zeros_like(motion.velocity), link=still)
    effect = effect_named("first_moment_error")
    keys = [key for key in places(model) if key.effect == effect.name]
    found = [effect.response(motion, model, Placement.of(model, key), {}).columns for key in keys]
    return np.moveaxis(np.concatenate([np.zeros((0, *motion.position.shape)), *found]), 0, -1)


def with_reference(recording: Recording, held: bool) -> Recording:
    """Return the recording with a reference that is constant between rows, or is not."""
    return replace(recording, timing=replace(recording.timing, reference_held=held))


def reading_speed(recording: Recording, how: Speed) -> Recording:
    """Return the recording of a loop that computes its speed in this way."""
    return replace(recording, controller=replace(recording.controller, velocity=how))
