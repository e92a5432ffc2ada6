"""What gives way as the torque shows it, and no closed loop as long as something else is missing too."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .choosing import behind
from .data import Data
from .fit import fit
from .giving import pins_of, what_gives_way
from .hypothesis import Fit
from .judging import witnessed
from .refining import with_candidate
from .sensitivity import Scene
from .stage import Stage

_PLAIN = 0.25  # of the torque that is lacking: what leaves no more stands whatever the loop says


def plain_by_torque(
    scene: Scene, data: Data, start: Fit, progress: Callable[[str], None]
) -> tuple[Stage, ...]:
    """The spring or gap that leaves little of the torque that is lacking, as the torque has it.

    Its closed loop does not run as the measured one while anything else is missing, least of all with a gap,
    whose runs part: no simulation tells by itself that it is there.

    Args:
        scene: the model that lacks something.
        data: its recordings.
        start: the model as it is.
        progress: told what is being done.

    Returns:
        One stage, whose data and runs are not its own yet; none where nothing is plain.
    """
    found = what_gives_way(scene, data.training, 1.0)
    if not found or found[0].judged > _PLAIN:
        return ()
    plain, *others = found
    progress(f"beginning with {plain.key}, which the torque shows")
    fitted = fit([with_candidate(scene, plain, start)], data, 1)[0]
    if fitted is None or not witnessed(scene, fitted):
        return ()
    stage = Stage(
        added=plain.key,
        fit=fitted,
        data=data,
        removed_share=(start.judged - fitted.judged) / max(start.judged, 1e-12),
        rivals=pins_of(scene.model, plain.key),
        others=(),
        dropped=(),
        ranking=tuple((c.key, 1.0 - c.judged) for c in found),
        behind=behind(plain.key, plain.judged, ((c.key, c.judged) for c in others)),
        folds=(int(np.sum(fitted.agreeing < start.agreeing)), len(fitted.agreeing)),
        by_held_out=data.held_out_judges,
    )
    return (stage,)
