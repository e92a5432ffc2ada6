"""What gives way as the torque shows it, and no closed loop as long as something else is missing too."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from workbench.effects import effect_named

from ..data import Data
from ..fitting.fit import fit
from ..fitting.refinement import with_candidates
from ..hypothesis import Fit, Hypothesis, applied_effect
from ..loss import floor_of_judging
from ..policy import POLICY
from ..removed_share import removed_share
from ..screening.compliance import pins_of, what_gives_way
from ..screening.screen import Candidate
from ..screening.sensitivity import Scene
from ..search_result import Stage
from ..significance import witnessed
from .beside_backlash import beside_gap
from .choice import behind

_ROUNDS = 12  # of a fit of a gap with others: the slopes of runs that part are rough
_FEW = 3  # of a fit on the way there


def plain_by_torque(
    scene: Scene,
    data: Data,
    start: Fit,
    progress: Callable[[str], None],
    least: float = 0.0,
    most: float | None = None,
) -> tuple[Stage, ...]:
    """The spring or gap that leaves little of the torque that is lacking, as the torque has it.

    Its closed loop does not run as the measured one while anything else is missing, least of all with a gap,
    whose runs part: no simulation tells by itself that it is there. What else is missing where a gap is comes
    with it.

    Args:
        scene: the model that lacks something.
        data: its recordings.
        start: the model as it is, with what was found of it.
        progress: told what is being done.
        least, most: share of the torque that is lacking, between which it must leave of it; `most` is what is
            plain by the policy, unless it is given.

    Returns:
        A stage each, whose data and runs are not its own yet; none where nothing is plain.
    """
    known = what_gives_way(scene, data.training, 1.0, start.hypothesis.free)
    most = POLICY.torque_plain if most is None else most
    if not known or not least <= known[0].judged <= most:
        return ()
    plain, *others = known
    progress(f"beginning with {plain.key}, which the torque shows")
    chosen = [plain]
    if effect_named(plain.key.effect).wanders:
        chosen = beside_gap(scene, plain, start, data.training)
    fits = _fits(scene, chosen, start, data)
    if fits is None or not witnessed(scene, fits[-1]):
        return ()
    close = behind(plain.key, plain.judged, ((c.key, c.judged) for c in others))
    stages = []
    for candidate, earlier, found in zip(chosen, (start, *fits), fits, strict=False):
        removed = removed_share(earlier.judged, found.judged, floor_of_judging(data))
        stage = Stage(
            added=candidate.key,
            fit=found,
            data=data,
            removed_share=removed,
            rivals=pins_of(scene.model, candidate.key),
            others=(),
            dropped=(),
            ranking=((candidate.key, removed),),  # what others leave of the torque is no share of this
            behind=close if candidate is chosen[0] else (),
            folds=(int(np.sum(found.agreeing < earlier.agreeing)), len(found.agreeing)),
            by_held_out=data.held_out_judges,
        )
        stages.append(stage)
    return tuple(stages)


def _fits(scene: Scene, chosen: Sequence[Candidate], start: Fit, data: Data) -> list[Fit] | None:
    """Of the first candidate, the first two, and so on; None where all of them do not run."""
    fits: list[Fit | None] = []
    before = start
    rounds = (*(_FEW for _ in chosen[1:]), _ROUNDS) if len(chosen) > 1 else (1,)
    for k, most in enumerate(rounds):
        hypothesis = _with_unseen(with_candidates(scene, chosen[: k + 1], start), before)
        fits += fit([hypothesis], data, most)
        before = fits[-1] or before
    last = fits[-1]
    # on the way there a loop may not run; what it leads to does
    return None if last is None else [f or last for f in fits]


def _with_unseen(hypothesis: Hypothesis, before: Fit) -> Hypothesis:
    """With values of an earlier fit where the torque at the gap says nothing and there are none yet."""
    known = {a.key: a.values for a in before.hypothesis.free}
    free = []
    for applied in hypothesis.free:
        earlier = known.get(applied.key, {})
        values = {name: value or earlier.get(name, value) for name, value in applied.values.items()}
        free.append(applied_effect(hypothesis.base, applied, values))
    return replace(hypothesis, free=tuple(free))
