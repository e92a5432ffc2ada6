"""A beginning that no loop closes: what the torque along the measured motion lacks."""

from __future__ import annotations

from dataclasses import replace

from workbench.comparison import ClosedLoop, followed, scored_signals
from workbench.core import Recording, SimulationError

from ..data import gather
from ..fitting.fit import fit
from ..fitting.refinement import polished
from ..node import Way, onwards
from ..problem import Quest, quest_of
from ..search_result import Stage


def along_the_motion(quest: Quest) -> tuple[Stage, ...]:
    """Effects that explain the torque along the measured motion, fitted in the closed loop from there.

    A pendulum that swings freely on a cart swings on where its friction is missing: the model's run soon is
    another motion than the measured one, and small changes to it tell nothing. Along the measured motion the
    friction is plain.

    Returns:
        One stage an effect, whose data and runs are not its own yet; none where that was asked already, where
        a loop holds every axis to the motion that was measured, where no torque was recorded, or where it
        lacks nothing.
    """
    recordings, model = quest.data.recordings, quest.start.hypothesis.model
    if not any(_swings(r) for r in recordings):
        return ()
    blind = any(len(scored_signals(r)) < 2 for r in recordings)
    if blind or not isinstance(quest.data.replay, ClosedLoop):
        return ()
    quest.progress("asking the torque along the measured motion")
    along, training = followed(recordings), quest.data.training
    try:
        data, runs = gather(model, along[:training], along[training:], quest.seed)
    except SimulationError:
        return ()
    asked = quest_of(model, data, runs.clean, quest.limit, quest.seed, quest.progress)
    return _in_the_loop(onwards(Way(asked.start, asked.data), asked), quest)


def _swings(recording: Recording) -> bool:
    """Whether no loop holds some axis to its reference."""
    loop = recording.controller
    return loop.kind == "none" or not all(loop.kp)


def _in_the_loop(way: Way, quest: Quest) -> tuple[Stage, ...]:
    """The stages of a way along the motion, each fitted in the loops of the quest."""
    if not way.stages:
        return ()
    fits = fit([stage.fit.hypothesis for stage in way.stages], quest.data)
    if fits[-1] is None:
        return ()
    last = polished(fits[-1], quest.data)
    # on the way there a loop may not run; what it leads to does
    stages = [replace(s, fit=f or last, data=quest.data) for s, f in zip(way.stages, fits, strict=True)]
    return (*stages[:-1], replace(stages[-1], fit=last))
