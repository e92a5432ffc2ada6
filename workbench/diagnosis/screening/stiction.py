"""Screening of dry friction along the measured motion, when it holds the machine at rest for long.

While friction holds, a torque changes nothing, and a loop that is linearised says the opposite. Along the
motion that was measured it is seen plainly: rows that stand still do not count, the others tell the torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import Recording
from workbench.effects import effect_named, kinds, places
from workbench.simulation import scored_torque

from ..data import Data, gather_along
from ..hypothesis import Fit
from ..loss import rescored, test_noise_floor
from ..policy import POLICY
from .candidate import Candidate
from .equations import Equations
from .screen import screen
from .sensitivity import Linearisation


def has_long_standstill(recordings: Sequence[Recording]) -> bool:
    """Return whether an axis stands still for a large part of the recordings, whatever holds it."""
    change = np.concatenate([np.abs(np.diff(r.position, axis=0)) for r in recordings])
    still = change < POLICY.still_step * np.sqrt(np.mean(change**2, axis=0))
    return bool((np.mean(still, axis=0) > POLICY.still_rows).any())


def candidates(
    linearisation: Linearisation, current: Fit, data: Data, seed: int, whole: Equations | None = None
) -> tuple[Candidate, ...]:
    """Return every effect screened in the loop, or dry friction along the measured motion if that explains
    more.

    Screening in the loop is enough where machines are seldom at rest, torque was not recorded, or some effect
    explains the data anyway.

    Args:
        linearisation: the loops linearised.
        current: the fit so far.
        data: its recordings.
        seed: of the noise simulations.
        whole: the equations of all effects, where they are known.

    Returns:
        Best first.
    """
    in_loop = screen(linearisation, data, current.hypothesis.free, whole=whole)
    known = all(scored_torque(r) for r in data.recordings)
    floor = test_noise_floor(data)
    left = min((c.test_loss - floor for c in in_loop), default=0.0)
    explained = left < POLICY.still_explained * (current.test_loss - floor)
    if explained or not data.replay.machine_alone or not known or not has_long_standstill(data.recordings):
        return tuple(in_loop)
    model = current.hypothesis.model
    along, simulated = gather_along(model, data.recordings, data.training, seed)
    before = rescored(
        replace(current, simulated=simulated.clean, mean_squares=along.mean_squares(simulated.clean)), along
    )
    floor_along = test_noise_floor(along)
    if before.test_loss < POLICY.at_noise * floor_along:
        return tuple(in_loop)  # no torque is missing along the motion, and so no friction
    moving = Linearisation.of(model, along, before.simulated, len(along.recordings))
    scale = (current.test_loss - floor) / max(before.test_loss - floor_along, 1e-12)

    def better(own: Candidate, other: Candidate) -> Candidate:
        """The candidate with the smaller excess: the noise along the motion differs from that in the loop."""
        test_loss = floor + scale * max(other.test_loss - floor_along, 0.0)
        return replace(other, test_loss=test_loss) if test_loss < own.test_loss else own

    others = {key for key in places(model) if not kinds.is_dry(effect_named(key.effect))}
    found = screen(moving, along, current.hypothesis.free, left_out=others)
    seen = {c.key: c for c in found if c.key not in others}
    best = (better(c, seen[c.key]) if c.key in seen else c for c in in_loop)
    return tuple(sorted(best, key=lambda c: c.test_loss))
