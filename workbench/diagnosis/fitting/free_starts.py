"""Fits in short windows whose starts are free, so that noise of the measured starts pulls no parameter.

A run from a measured state begins with the noise of that state. Where a parameter says how fast such a
disturbance dies away, as the damping of a contact does, the error is smallest with too much of it: the sum of
squares holds the square of the noise, and that falls. With the starts as unknowns of their own (H. G. Bock,
1983) what they do is no error any more. They are few, and each acts in its own window alone, so that they are
taken out first: what is left of the residuals no start can make (variable projection; G. H. Golub,
V. Pereyra, 1973).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from workbench.core import Recording
from workbench.effects import effect_named
from workbench.models import Model

from ..data import Data
from ..hypothesis import Fit, Hypothesis, moved, step_bounds
from ..screening.sensitivity import FiniteDifference, Linearisation
from .bounded_least_squares import solve
from .fit import FINE_TOLERANCE, fit
from .normal_equations import Normal, normal, total
from .uncertainty import covariance_of, scatter, with_deviations

_ROUNDS = 4
_SEEN_TOLERANCE = 1e-8  # of the largest response to a start: less is nothing


def with_free_starts(found: Fit, data: Data) -> Fit:
    """Return the fit with its parameters where they are best if every window may start elsewhere.

    A fit without effects that have to be run on the ground is returned as it is, and so is one in a replay
    without windows.
    """
    ground = any(data.replay.needs_runs(effect_named(a.key.effect)) for a in found.hypothesis.free)
    if not ground or data.replay.start_responses(found.hypothesis.model, 0) is None:
        return found
    tried, runs, best = found.hypothesis, found.simulated, None
    for _ in range(_ROUNDS):
        equations = _equations(tried, runs, data)
        if equations is None or (best is not None and equations[0].square >= best[1][0].square):
            break
        best = tried, equations
        change = solve(equations[0], *step_bounds(tried))
        if equations[0].square - equations[0].after(change) < FINE_TOLERANCE * equations[0].square:
            break
        tried = moved(tried, change)
        (runs,) = data.run([tried.model])
        if not np.isfinite(data.mean_squares(runs)).all():
            break
    made = None if best is None else fit([best[0]], data, iterations=1)[0]
    if best is None or made is None:
        return found
    hypothesis, (whole, pieces, noise) = best
    low, high = step_bounds(hypothesis)
    moves = np.array([solve(whole - piece, low, high) for piece in pieces])
    covariance = covariance_of(whole, noise, moves, made.training_loss, data)
    return replace(made, hypothesis=with_deviations(made.hypothesis, covariance, data))


def _equations(
    hypothesis: Hypothesis, runs: Sequence[Recording], data: Data
) -> tuple[Normal, list[Normal], np.ndarray] | None:
    """Normal equations of all and of each fold, and what noise does to them.

    None where derivatives take no runs: what a start can make changes with the parameters too, and a run
    with others has its own.
    """
    here = Linearisation.of(hypothesis.model, data, runs, data.training)
    columns = [c for a in hypothesis.free for c in here.derivatives(a)]
    apart = [c for c in columns if isinstance(c, FiniteDifference)]
    if len(apart) < len(columns):
        return None
    made = data.run([c.model for c in apart], data.training)
    others = [_without_starts(c.model, r, data) for c, r in zip(apart, made, strict=True)]
    parts, noise = [], np.zeros((len(columns),) * 2)
    for i, own in enumerate(_without_starts(hypothesis.model, runs, data, data.draws)):
        residual, draws = own[..., 0], own[..., 1:]
        response = np.stack(
            [(residual - o[i][..., 0]) / c.change for o, c in zip(others, apart, strict=True)], axis=-1
        )
        noise += scatter(list(np.moveaxis(draws, -1, 0)), response)
        parts.append((response, residual))
    pieces = [normal(parts[f.recording][0][f.rows], parts[f.recording][1][f.rows]) for f in data.folds]
    return total(pieces), pieces, noise


def _without_starts(
    model: Model, runs: Sequence[Recording], data: Data, draws: Sequence[Sequence[np.ndarray]] = ()
) -> list[np.ndarray]:
    """Weighted residuals, and draws beside them, without what changes of the starts can make; (N, 2, n, 1 +
    draws) for each training recording.
    """
    out = []
    for i in range(data.training):
        told = data.replay.start_responses(model, i)
        assert told is not None
        starts, responses = told
        every = [data.residual(i, runs[i]), *(draw[i] for draw in draws)]
        values = np.stack([x * data.weight for x in every], axis=-1)
        left, valid = np.zeros_like(values), data.recordings[i].valid
        for first, end in pairwise([*starts, len(values)]):
            rows = np.arange(first, end)[valid[first:end]]
            if not len(rows):
                continue
            own = (responses[rows] * data.weight[:, :, None]).reshape(-1, responses.shape[-1])
            size = np.linalg.norm(own, axis=0)
            basis, seen, _ = np.linalg.svd(own / np.where(size > 0.0, size, 1.0), full_matrices=False)
            basis = basis[:, seen > _SEEN_TOLERANCE * max(seen[0], _SEEN_TOLERANCE)]
            flat = values[rows].reshape(len(own), -1)
            left[rows] = (flat - basis @ (basis.T @ flat)).reshape(values[rows].shape)
        out.append(left)
    return out
