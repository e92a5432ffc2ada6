"""What dry friction is, read along the measured motion, where it holds the machine for long.

While friction holds, a torque changes nothing, and a loop that is linearised says the opposite. Along the
motion that was measured it is seen plainly: rows that stand still do not count, the others tell the torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import followed
from workbench.core import Recording
from workbench.effects import effect_named

from .data import Data, gather
from .hypothesis import Fit
from .judging import rejudged
from .screen import Candidate, screen
from .sensitivity import Scene

_STILL = 0.02  # of the rms change from row to row: less is no motion
_LONG = 0.2  # share of the rows; a motion that only turns round stands for less


def stands_long(recordings: Sequence[Recording]) -> bool:
    """Whether an axis stands still for a good part of recordings, whatever holds it."""
    change = np.concatenate([np.abs(np.diff(r.position, axis=0)) for r in recordings])
    still = change < _STILL * np.sqrt(np.mean(change**2, axis=0))
    return bool((np.mean(still, axis=0) > _LONG).any())


def read_along(candidates: Sequence[Candidate], current: Fit, data: Data, seed: int) -> tuple[Candidate, ...]:
    """Candidates with the estimates of dry friction taken along the measured motion, best first.

    Where machines do not stand for long, or torque was not recorded, they stay as they are.

    Args:
        candidates: as screened in the loop.
        current: the model that lacks something.
        data: its recordings.
        seed: of the noise simulations.
    """
    known = all({"torque_measured", "torque_command"} & set(r.signals) for r in data.recordings)
    if data.replay.on_ground or not known or not stands_long(data.recordings):
        return tuple(candidates)
    model, runs = current.hypothesis.model, followed(data.recordings)
    along, simulated = gather(model, runs[: data.training], runs[data.training :], seed)
    along = along.heard(along.mean_squares(simulated.clean))
    before = rejudged(
        replace(current, simulated=simulated.clean, mean_squares=along.mean_squares(simulated.clean)), along
    )
    scene = Scene.of(model, along, before.simulated, len(runs))
    seen = {
        c.key: replace(c, judged=c.judged / before.judged * current.judged)
        for c in screen(scene, along, before.simulated, current.hypothesis.free)[0]
        if effect_named(c.key.effect).dry
    }
    return tuple(sorted((seen.get(c.key, c) for c in candidates), key=lambda c: c.judged))
