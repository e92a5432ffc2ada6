"""Recordings as MuJoCo would have made them from the model's own file.

MuJoCo's usual integrators let the torque act half a step early and show the speed half a step late, and its
dry friction is soft. A machine has neither; a recording of a simulation has both, as large as many effects.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.core import Recording
from workbench.models import Model, friction_leads, load_tree
from workbench.simulation import whole_steps

_STATE = "If you know that this is right, state"


def by_mujoco(model: Model, recordings: Sequence[Recording]) -> list[tuple[Recording, ...]]:
    """Return recordings as MuJoCo made them by each way in which it may have run the model's file: in fine
    steps, with its soft friction, or in the file's own. None where they state what made them.
    """
    if any(x is not None for r in recordings for x in (r.timing.stepped, r.timing.soft_friction)):
        return []
    compiled = load_tree(model.serial).compile()
    out = []
    if friction_leads(compiled):
        line = (
            "the recordings show dry friction as soft as MuJoCo makes it, so it is taken as the model's file "
            f"has it. {_STATE} soft_friction = true in [timing]"
        )
        out.append(tuple(_noted(r, line, soft_friction=True) for r in recordings))
    step = float(compiled.opt.timestep)
    # along a measured motion steps make no difference
    if all(r.controller.kind != "unknown" and _fits(r, step) for r in recordings):
        line = (
            f"MuJoCo seems to have made the recordings, in steps of {1e3 * step:g} ms as the model's file "
            f"has, so it is run in these. {_STATE} stepped = true in [timing]"
        )
        out.append(tuple(_read_as_is(_noted(r, line, stepped=True)) for r in recordings))
    return out


def _fits(recording: Recording, step: float) -> bool:
    """Whether rows and ticks of a loop are whole numbers of steps apart."""
    periods = recording.period, recording.controller.period_s or recording.period
    return all(whole_steps(period, step) is not None for period in periods)


def _read_as_is(recording: Recording) -> Recording:
    """With a loop that takes MuJoCo's speed: a difference over a step has the same value but more noise."""
    loop = recording.controller
    return replace(recording, controller=replace(loop, velocity=loop.velocity or "sensor"))


def _noted(recording: Recording, line: str, **timing: bool) -> Recording:
    timed = replace(recording.timing, **timing)
    return replace(recording, timing=timed, notes=(*recording.notes, line))
