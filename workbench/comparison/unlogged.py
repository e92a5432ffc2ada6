"""What a log leaves open of its loop: its reference between rows, and how it came to know its speed.

A loop may be faster than its log. A reference that the log's clock sets stands still until the next row, half
a row late on the average, which looks like damping and inertia on all axes at once; a speed that is the
difference over a tick is half a tick late, which looks like a rotor of kd times that. Neither is a fact about
the machine, so both are asked before anything is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Recording
from workbench.effects import compile_plant
from workbench.models import Model
from workbench.recordings.resample import looks_held
from workbench.simulation import Experiment, prepare, rate_read

from .answer_share import Asked, answer_share, joined
from .closed_loop import with_loops
from .law_against import CONSTANT, DIFFERENCE, LATE, Speed, law_against, reading_speed, with_reference
from .noise import NoiseModel

_SPEEDS: tuple[Speed, ...] = "sensor", "difference"
_NEAR = 0.4  # of the way from one answer to the other: a vote for the one that is as near as that
_SURE = 0.2  # the same, of all axes together, for an answer beside which the other need not be tried


@dataclass(frozen=True)
class LoopAssumption:
    """Recordings with one assumption about what their logs do not state of the loop.

    Attributes:
        recordings: with that answer in their timing and controller.
        asked: places of those that leave something open.
        between_rows: whether their reference between rows was asked.
        speed: whether it was asked how their loop came to know its speed.
        sure_between_rows, sure_of_speed: nothing speaks for the other answer.
    """

    recordings: tuple[Recording, ...]
    asked: tuple[int, ...] = ()
    between_rows: bool = False
    speed: bool = False
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

    Asked where ``[timing] reference_held`` or ``[controller] velocity`` do not say it, and a PD loop is
    known. The torque by the law along the measured motion is held against both answers, with the torque that
    the model needs; damping, dry friction and weights of each axis may be wrong. How a speed that was not
    logged was computed shows in a measured torque, too; drives may be late then, and a torque constant wrong.
    Where that does not decide, the run of a model that explains the recordings may.
    """
    opened = [i for i, r in enumerate(recordings) if _speed_is_open(model, r)]
    between = [i for i, r in enumerate(recordings) if _between_is_open(model, r)]
    alone = [i for i in opened if "torque_measured" not in recordings[i].signals]
    asked = tuple(between or alone or opened)
    if not asked:
        return (LoopAssumption(tuple(recordings)),)
    out = list(recordings)
    known = with_loops(model, [recordings[i] for i in asked])
    for i, r in zip(asked, known, strict=True):
        out[i] = replace(recordings[i], controller=r.controller)
    plant, levels = compile_plant(model), NoiseModel.of(known).levels
    speed = set(asked) <= set(opened)

    def axes_by(*, need: bool) -> list[Asked]:
        each = [law_against(r, plant, levels, by_need=need) for r in known]
        return [joined([of[k] for of in each]) for k in range(model.size)]

    if not between:
        return tuple(_by_speed(LoopAssumption(tuple(out), asked, speed=True), axes_by(need=bool(alone))))
    axes = axes_by(need=True)
    by_torque = axes_by(need=False) if speed and not alone else None
    share, std = answer_share([np.hstack([a.others, a.damping, a.inertia]) for a in axes], axes, CONSTANT)
    held = share > 0.5
    sure = max(std, abs(share - held)) < _SURE and not (held and _may_be_late(axes))
    found: list[LoopAssumption] = []
    for answer in (held,) if sure else (held, not held):
        taken = tuple(with_reference(r, answer) if i in asked else r for i, r in enumerate(out))
        rest = [replace(a, lacking=a.lacking + answer * a.answers[:, CONSTANT]) for a in axes]
        assumed = LoopAssumption(taken, asked, True, speed, sure)
        found += _by_speed(assumed, by_torque or rest) if speed else [assumed]
    return tuple(found)


def _by_speed(reading: LoopAssumption, axes: Sequence[Asked]) -> list[LoopAssumption]:
    """A reading with the way in which loops come to know their speed, or with each of them."""
    # inertia that is wrong hides it on its axes
    votes = [answer_share([np.hstack([a.others, a.damping])], [a], DIFFERENCE) for a in axes]
    decided: list[Speed] = [how for answer, how in enumerate(_SPEEDS) if _most_say(votes, answer)]
    ways: tuple[Speed, ...] = tuple(decided) or ("difference", "sensor")
    found = []
    for how in ways:
        taken = (reading_speed(r, how) if i in reading.asked else r for i, r in enumerate(reading.recordings))
        found.append(replace(reading, recordings=tuple(taken), sure_of_speed=bool(decided)))
    return found


def _may_be_late(axes: Sequence[Asked]) -> bool:
    """Whether most axes agree with drives that are half a row late, instead of a reference that is constant.

    Both move the reference by as much. A delay also looks like damping and inertia of each axis, in
    proportion to the gains of its loop, which are then wrong numbers of the model.
    """
    votes = []
    for a in axes:
        constant, late = a.answers[:, CONSTANT], a.answers[:, LATE]
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
            why = "which fits the recordings" if sure else "although the recordings hardly show it"
            notes.append(
                f"the loop runs faster than the log; between rows its reference is taken as {how}, {why}. "
                f"If you know that this is right, state reference_held = {str(held).lower()} in [timing]"
            )
        if not reading.speed:
            out[i] = replace(out[i], notes=tuple(notes))
            continue
        speed = out[i].controller.velocity
        taken = "read without delay" if speed == "sensor" else "the difference of positions over its period"
        if reading.sure_of_speed:
            line = f"no speed was logged; the loop's speed is taken as {taken}, which fits the recordings"
        else:
            line = (
                "no speed was logged, and the recordings alone do not show how the loop computed it; "
                f"it is taken as {taken}"
            )
        notes.append(f'{line}. If you know that this is right, state velocity = "{speed}" in [controller]')
        out[i] = replace(out[i], notes=tuple(notes))
    return tuple(out)


def _loop_of(model: Model, recording: Recording) -> Experiment | None:
    """Return a PD loop that follows a reference; None where it is another or none."""
    controller = recording.controller if recording.controller.kind != "unknown" else model.controller
    if controller.kind != "pd" or recording.get("position_reference") is None:
        return None
    return prepare(replace(recording, controller=controller), model)


def _speed_is_open(model: Model, recording: Recording) -> bool:
    """Return whether neither log nor description says how the loop came to know its speed."""
    if "velocity" not in recording.derived or "torque_command" in recording.signals:
        return False
    e = _loop_of(model, recording)
    return e is not None and recording.controller.velocity is None and rate_read(e) is None


def _between_is_open(model: Model, recording: Recording) -> bool:
    """Return whether the loop ticks between rows, and nothing says what its reference does there."""
    reference = recording.get("position_reference")
    if recording.timing.reference_held is not None or reference is None or looks_held(reference):
        return False
    e = _loop_of(model, recording)
    return e is not None and e.ticks_between_rows
