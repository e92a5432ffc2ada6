"""What a log leaves open of its loop: its reference between rows, and how it came to know its speed.

A loop may be faster than its log. A reference that the log's clock sets stands still until the next row, half
a row late on the average, which looks like damping and inertia on all axes at once; a speed that is the
difference over a tick is half a tick late, which looks like a rotor of kd times that. Neither is a fact about
the machine, so both are asked before anything is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from workbench.core import Recording
from workbench.effects import LinkMotion, Motion, Plant, compile_plant, effect_named, places
from workbench.models import Model, Placement
from workbench.recordings import NoiseLevels
from workbench.recordings.resample import looks_held
from workbench.simulation import law_torque, motion_of, prepare, rate_read, required_torque, smooth_track

from .answer_share import Asked, answer_share, joined
from .band import corner_hz
from .closed_loop import with_loops
from .inverse import lowpass
from .noise import NoiseModel

_Speed = Literal["sensor", "difference"]
_SPEEDS: tuple[_Speed, ...] = "sensor", "difference"
_CONSTANT, _DIFFERENCE, _LATE = range(3)  # what may change the torque by the law: places in `Asked.answers`
_NEAR = 0.4  # of the way from one answer to the other: a vote for the one that is as near as that
_SURE = 0.2  # the same, of all axes together, for an answer beside which the other need not be tried
_EDGE_S = 0.3


@dataclass(frozen=True)
class LoopAssumption:
    """Recordings with one assumption about what their logs do not state of the loop.

    Attributes:
        recordings: with that answer in their timing and controller.
        asked: places of those that leave something open.
        between_rows: whether their reference between rows was asked.
        sure_between_rows, sure_of_speed: nothing speaks for the other answer.
    """

    recordings: tuple[Recording, ...]
    asked: tuple[int, ...] = ()
    between_rows: bool = False
    sure_between_rows: bool = False
    sure_of_speed: bool = False

    @property
    def answer(self) -> tuple[bool | None, str | None]:
        """Return the assumption: whether the reference is constant between rows, and how the loop obtains
        its speed.
        """
        if not self.asked:
            return None, None
        one = self.recordings[self.asked[0]]
        return one.timing.reference_held, one.controller.velocity


def readings(model: Model, recordings: Sequence[Recording]) -> tuple[LoopAssumption, ...]:
    """Return the recordings for all assumptions about the loop that may be right, the most likely first.

    Asked where neither ``[timing] reference_held`` nor ``[controller] velocity`` says it, no torque was
    commanded, and a PD loop is known. The torque by the law along the measured motion, less that which was
    measured, is held against both answers; drives may be late, and a torque constant wrong. Where none
    was measured, it is that which the model needs; damping, dry friction and weights of each axis may be
    wrong. Where that does not decide, the run of a model that explains the recordings may.
    """
    opened = [i for i, r in enumerate(recordings) if _is_open(model, r)]
    alone = [i for i in opened if "torque_measured" not in recordings[i].signals]
    asked = tuple(alone or opened)
    if not asked:
        return (LoopAssumption(tuple(recordings)),)
    out = list(recordings)
    known = with_loops(model, [recordings[i] for i in asked])
    for i, r in zip(asked, known, strict=True):
        out[i] = replace(recordings[i], controller=r.controller)
    plant, levels = compile_plant(model), NoiseModel.of(known).levels
    each = [_asked(r, plant, levels) for r in known]
    axes = [joined([of[k] for of in each]) for k in range(model.size)]
    between = [prepare(r, model) for r in known]
    if not alone or not any(np.any(e.ticks % e.stride) for e in between):
        return tuple(_by_speed(LoopAssumption(tuple(out), asked), axes))
    share, std = answer_share([np.hstack([a.others, a.damping, a.inertia]) for a in axes], axes, _CONSTANT)
    held = share > 0.5
    sure = max(std, abs(share - held)) < _SURE and not (held and _may_be_late(axes))
    found: list[LoopAssumption] = []
    for answer in (held,) if sure else (held, not held):
        taken = tuple(_held(r, answer) if i in asked else r for i, r in enumerate(out))
        rest = [replace(a, lacking=a.lacking + answer * a.answers[:, _CONSTANT]) for a in axes]
        found += _by_speed(LoopAssumption(taken, asked, True, sure), rest)
    return tuple(found)


def _by_speed(reading: LoopAssumption, axes: Sequence[Asked]) -> list[LoopAssumption]:
    """A reading with the way in which loops come to know their speed, or with each of them."""
    # inertia that is wrong hides it on its axes
    votes = [answer_share([np.hstack([a.others, a.damping])], [a], _DIFFERENCE) for a in axes]
    decided: list[_Speed] = [how for answer, how in enumerate(_SPEEDS) if _most_say(votes, answer)]
    ways: tuple[_Speed, ...] = tuple(decided) or ("difference", "sensor")
    found = []
    for how in ways:
        taken = (_reading(r, how) if i in reading.asked else r for i, r in enumerate(reading.recordings))
        found.append(replace(reading, recordings=tuple(taken), sure_of_speed=bool(decided)))
    return found


def _may_be_late(axes: Sequence[Asked]) -> bool:
    """Whether most axes agree with drives that are half a row late, instead of a reference that is constant.

    Both move the reference by as much. A delay also looks like damping and inertia of each axis, in
    proportion to the gains of its loop, which are then wrong numbers of the model.
    """
    votes = []
    for a in axes:
        constant, late = a.answers[:, _CONSTANT], a.answers[:, _LATE]
        beside = replace(a, lacking=a.lacking + constant, answers=(late - constant)[:, None])
        votes.append(answer_share([a.others], [beside], 0))
    return _most_say(votes, 1)


def _most_say(votes: Sequence[tuple[float, float]], answer: int) -> bool:
    """Whether most axes clearly agree with one answer, by their shares and standard deviations."""
    clear = [std < _NEAR and abs(share - answer) < _NEAR for share, std in votes]
    return sum(clear) > 0.5 * len(clear)


def noted(reading: LoopAssumption) -> tuple[Recording, ...]:
    """Return the recordings of a reading, with notes on the assumptions and their reasons."""
    out = list(reading.recordings)
    for i in reading.asked:
        notes = list(out[i].notes)
        if reading.between_rows:
            held = bool(out[i].timing.reference_held)
            how = "constant from row to row" if held else "a smooth line through the rows"
            sure = reading.sure_between_rows
            why = "which explains the recordings" if sure else "although the recordings hardly show it"
            notes.append(
                f"the loop runs faster than the log; between rows its reference is taken as {how}, {why}: "
                f"state reference_held = {str(held).lower()} in [timing] if you know it"
            )
        speed = out[i].controller.velocity
        taken = "read without delay" if speed == "sensor" else "the difference of positions over its period"
        if reading.sure_of_speed:
            line = f"no speed was logged; the loop's is taken as {taken}, which explains the recordings"
        else:
            line = (
                "no speed was logged, and the recordings alone do not show how the loop computed it; "
                f"it is taken as {taken}"
            )
        notes.append(f'{line}: state velocity = "{speed}" in [controller] if you know it')
        out[i] = replace(out[i], notes=tuple(notes))
    return tuple(out)


def _is_open(model: Model, recording: Recording) -> bool:
    """Whether the torque is known by a law alone, of which something is left open."""
    controller = recording.controller if recording.controller.kind != "unknown" else model.controller
    reference = recording.get("position_reference")
    if controller.kind != "pd" or reference is None or "velocity" not in recording.derived:
        return False
    if "torque_command" in recording.signals:
        return False
    e = prepare(replace(recording, controller=controller), model)
    between = np.any(e.ticks % e.stride) and not looks_held(reference)
    between = between and "torque_measured" not in recording.signals  # at its rows both are the same
    stated = recording.timing.reference_held is not None, controller.velocity is not None
    return bool((between and not stated[0]) or not stated[1]) and rate_read(e) is None


def _asked(recording: Recording, plant: Plant, levels: NoiseLevels) -> list[Asked]:
    """What one recording says of each axis, on rows away from its ends."""
    n = plant.model.size
    to_actuator = recording.to_actuator(plant.model.transmission)
    band = 0.2 / recording.period
    track = smooth_track(recording, None, to_actuator, levels.position_std, levels.velocity_std, band)
    measured, tick = recording.get("torque_measured"), recording.controller.period_s or recording.period
    # a torque that was measured is that of the tick at its row
    middle = 0.5 if measured is None else 0.5 - 0.5 * min(tick / recording.period, 1.0)
    first = law_torque(_reading(_held(recording, False), "sensor"), plant, track, middle)
    changed = [
        law_torque(_reading(_held(recording, True), "sensor"), plant, track, middle) - first,
        law_torque(_reading(_held(recording, False), "difference"), plant, track, middle) - first,
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
        out.append(Asked(lacking[rows, k], answers[rows, k], *(p[rows] for p in parts)))
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


def _held(recording: Recording, held: bool) -> Recording:
    return replace(recording, timing=replace(recording.timing, reference_held=held))


def _reading(recording: Recording, how: _Speed) -> Recording:
    return replace(recording, controller=replace(recording.controller, velocity=how))
