"""What is certain of a drive's command path: its measured torque beside the command that was logged.

Between these two stand delay, current loop and limits of the drive, and nothing of the machine. So an effect
that leads from one to the other is certain, whatever else is missing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from workbench.core import EffectKey, Estimate, Recording
from workbench.effects import SignalStage, contains, effect_named, places
from workbench.models import AppliedEffect, Placement

from ..policy import POLICY
from ..screening.sensitivity import Linearisation
from .free_functions import Adequacy

#: How an effect stands that was found so: whole, and beside whatever else.
ON_PATH = Adequacy(1.0, 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class _OnPath:
    """An effect as it fits best, and the mean squares (n,) that it leaves of each drive, over the noise's."""

    applied: AppliedEffect
    left: np.ndarray


def certain_on_path(linearisation: Linearisation) -> tuple[AppliedEffect, ...]:
    """Return the effects that make of a drive's logged command its measured torque, but for the noise.

    Of each drive one, if no other does that too. None where command or torque were not logged. Held-out
    recordings say nothing here.

    Args:
        linearisation: about measured motions.
    """
    apart = _apart(linearisation)
    if apart is None:
        return ()
    noise = _noise(linearisation)
    plain = np.mean(np.concatenate(apart) ** 2, axis=0) > POLICY.near_noise * noise
    if not plain.any():
        return ()
    keys = [key for key in places(linearisation.model) if _is_on_path(key)]
    tried = [found for key in keys for found in _fits(key, linearisation, apart, noise)]
    out = []
    for drive in np.flatnonzero(plain):
        good = [t.applied for t in tried if t.left[drive] < POLICY.at_noise]
        # a limit at one speed is one at every speed too
        simple = [a for a in good if not any(contains(a.key, other.key) for other in good)]
        out += simple if len(simple) == 1 and not _left_to_the_loop(simple[0].key) else []
    return tuple(out)


def _is_on_path(key: EffectKey) -> bool:
    effect = effect_named(key.effect)
    return effect.stage is SignalStage.COMMAND and not effect.parameters.linear


def _left_to_the_loop(key: EffectKey) -> bool:
    """Return whether the loop has to say it: rows tell a delay of all drives to a row only, and what settles
    more of the model than its own numbers is not told by these.
    """
    return key.axis is None or bool(effect_named(key.effect).parameters.settles)


def _fitted(linearisation: Linearisation) -> tuple[Recording, ...]:
    data = linearisation.data
    return tuple(data.recordings[: data.training])


def _apart(linearisation: Linearisation) -> list[np.ndarray] | None:
    """Return how far each recording's torque (N, n) is off its command; None where these were not logged."""
    out = []
    for motion, recording in zip(linearisation.fitted_motions, _fitted(linearisation), strict=True):
        off = motion.line.off_command
        if off is None or recording.get("torque_command") is None:
            return None
        out.append(off[_rows(recording)])
    return out


def _rows(recording: Recording) -> np.ndarray:
    """Return the rows (N,) that count."""
    return recording.valid & (np.arange(len(recording)) >= POLICY.path_settles * len(recording))


def _noise(linearisation: Linearisation) -> np.ndarray:
    """Return the mean squares (n,) of a measured torque's noise, with what right simulations differ by."""
    to_actuator = linearisation.loops[0].reading.to_actuator
    own = np.nan_to_num(linearisation.data.replay.noise.levels.torque_std) ** 2
    measured = np.concatenate([np.asarray(m.line.measured) for m in linearisation.fitted_motions])
    slack = POLICY.model_deviation**2 * np.mean(measured**2, axis=0)
    return own @ np.linalg.inv(to_actuator) ** 2 + slack + 1e-300


def _fits(
    key: EffectKey, linearisation: Linearisation, apart: Sequence[np.ndarray], noise: np.ndarray
) -> list[_OnPath]:
    """Return the effect with the values that leave least; nothing where it has no start or no end."""
    effect, model = effect_named(key.effect), linearisation.model
    place, motions = Placement.of(model, key), linearisation.fitted_motions
    names = effect.parameters.nonlinear

    def left(shape: dict[str, float]) -> np.ndarray:
        taps = [effect.response(m, model, place, shape).tap for m in motions]
        rows = map(_rows, _fitted(linearisation))
        return np.concatenate([a - np.asarray(t)[v] for a, t, v in zip(apart, taps, rows, strict=True)])

    starts = effect.parameters.shapes(motions, model, place)
    if not starts:
        return []
    first = min(starts, key=lambda shape: float(np.sum(left(dict(shape)) ** 2 / noise)))
    low, high = np.array([effect.parameters.shape_bounds(model, place)[n] for n in names]).T
    begin = np.clip([first[n] for n in names], low, high)
    found = least_squares(
        lambda x: (left({**first, **dict(zip(names, x, strict=True))}) / np.sqrt(noise)).ravel(),
        begin,
        bounds=(low, high),
        x_scale=np.maximum(np.abs(begin), 1e-6),
        diff_step=1e-4,
    )
    values = dict(zip(names, map(float, found.x), strict=True))
    deviations = np.sqrt(np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    late = POLICY.delay_deviation * linearisation.data.recordings[0].period
    parameters = {
        p.name: Estimate(values[p.name], float(np.hypot(d, late if p.unit == "s" else 0.0)), p.unit)
        for p, d in zip((p for p in effect.parameters if p.name in names), deviations, strict=True)
    }
    rest = np.mean(left({**first, **values}) ** 2, axis=0) / noise
    return [_OnPath(AppliedEffect(key, parameters), rest)]
