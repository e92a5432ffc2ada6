"""A gap that the torque shows plainly, and no closed loop as long as something else is missing too."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.effects import effect_named

from .data import Data
from .fit import fit
from .giving import pins_of, what_gives_way
from .hypothesis import Fit
from .judging import witnessed
from .refining import with_candidate
from .sensitivity import Scene
from .stage import Stage

_PLAIN = 0.05  # of the torque that an axis lacks: what leaves no more is beyond chance


def gap_by_torque(scene: Scene, data: Data, start: Fit, progress: Callable[[str], None]) -> tuple[Stage, ...]:
    """The gap that leaves next to nothing of the torque that its axis lacks, whatever the closed loop says.

    Runs with a gap part from the measured ones while anything else is missing, so that no simulation tells
    by itself that it is there.

    Args:
        scene: the model that lacks something.
        data: its recordings.
        start: the model as it is.
        progress: told what is being done.

    Returns:
        One stage, whose data and runs are not its own yet; none where no gap is plain.
    """
    found = what_gives_way(scene, data.training, 1.0)
    gaps = [c for c in found if effect_named(c.key.effect).wanders and c.judged < _PLAIN]
    if not gaps:
        return ()
    progress(f"beginning with {gaps[0].key}, which the torque shows")
    fitted = fit([with_candidate(scene, gaps[0], start)], data, 1)[0]
    if fitted is None or not witnessed(scene, fitted):
        return ()
    others = [c.judged for c in found if c.key != gaps[0].key]
    excess = max(start.judged, 1e-12)
    stage = Stage(
        added=gaps[0].key,
        fit=fitted,
        data=data,
        removed_share=(start.judged - fitted.judged) / excess,
        rivals=pins_of(scene.model, gaps[0].key),
        others=(),
        dropped=(),
        ranking=tuple((c.key, 1.0 - c.judged) for c in found),
        margin=min(others, default=float("inf")) / max(gaps[0].judged, 1e-12),
        folds=(int(np.sum(fitted.agreeing < start.agreeing)), len(fitted.agreeing)),
        by_held_out=data.held_out_judges,
    )
    return (stage,)
