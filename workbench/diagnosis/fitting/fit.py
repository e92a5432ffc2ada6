"""Fit of hypotheses by closed-loop simulation: Gauss-Newton on many of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from workbench.core import Recording

from ..data import Data
from ..hypothesis import Fit, Hypothesis, moved, step_bounds
from ..policy import POLICY
from ..removed_share import removed_share
from ..screening.propagation import propagate_sensitivities
from ..screening.sensitivity import Linearisation
from .bounded_least_squares import solve
from .delays import across_row_edge, has_whole_row_delay, retry_at_best_delay
from .normal_equations import Normal, normal, total
from .uncertainty import covariance_of, scatter, with_deviations

_ITERATIONS = 6
TOLERANCE = 0.003  # relative fall of the objective below which fitting stops, good enough to compare
_FIRST_ITERATIONS = 3  # simulations of each hypothesis in the first round of successive halving
_AT_ONCE = 10_000_000  # rows times axes squared of loops held at once; each takes some tens of bytes of them
_EDGES = 4  # simulations from which a fit counts as converged, and of fits across the edge of a row
_OVERFLOW = 1e100  # noise levels of response to one unit; the square of much more is no number
FINE_TOLERANCE = 1e-6  # the same for estimates: a thousandth of what a deviation of noise changes


def values_of(hypotheses: Sequence[Hypothesis], data: Data) -> np.ndarray:
    """Return the training objective of hypotheses with their current values; infinite if they fail to run."""
    squares = [data.mean_squares(runs) for runs in data.run([h.model for h in hypotheses])]
    return np.array([data.objective(data.pool(s)) if np.isfinite(s).all() else np.inf for s in squares])


@dataclass
class _Work:
    """The state of fitting one hypothesis."""

    tried: Hypothesis
    best: Hypothesis
    runs: tuple[Recording, ...] = ()
    mean_squares: np.ndarray | None = None
    value: float = np.inf
    damping: float = 0.0
    pieces: list[Normal] | None = None
    phase_folds: list[Normal] = field(default_factory=list)
    noise: np.ndarray | None = None
    done: bool = False


def fit(
    hypotheses: Sequence[Hypothesis], data: Data, iterations: int = _ITERATIONS, enough: float = TOLERANCE
) -> list[Fit | None]:
    """Return fits of all hypotheses to the training recordings; they are simulated side by side.

    Args:
        hypotheses: where to start from.
        data: recordings, floor, weights.
        iterations: most simulations of each.
        enough: relative fall of the objective at which to stop.

    Returns:
        One fit a hypothesis; None where it never ran (unstable, or a body that cannot be).
    """
    works = _iterated(hypotheses, data, iterations, enough)
    if iterations >= _EDGES:
        works = [_across_row_edge(w, data, enough) for w in works]
    _linearise([w for w in works if w.pieces is None and np.isfinite(w.value)], data)
    return [_finish(w, data) for w in works]


def _iterated(
    hypotheses: Sequence[Hypothesis], data: Data, iterations: int, enough: float = TOLERANCE
) -> list[_Work]:
    """Return hypotheses after some Gauss-Newton iterations; not linearised at their last values."""
    works = [_Work(h, h) for h in hypotheses]
    for turn in range(iterations):
        best = min((w.value for w in works), default=np.inf)
        for work in works:
            # a much worse one is given up after two iterations
            work.done |= turn > 1 and work.value > POLICY.fit_behind * best
        active = [w for w in works if not w.done]
        if not active:
            break
        _simulate(active, data, enough)
        if turn == iterations - 1:
            break
        moving = [w for w in active if not w.done]
        _linearise([w for w in moving if w.pieces is None], data)
        for work in moving:
            if not work.done:
                _step(work, enough)
    return works


def _across_row_edge(work: _Work, data: Data, enough: float) -> _Work:
    """The fit, or a better one with the delay in a neighbouring row, if noise does not explain the error."""
    floor = data.objective(data.least())
    if not has_whole_row_delay(work.best) or not POLICY.delay_above * floor < work.value < np.inf:
        return work
    _linearise([work] if work.pieces is None else [], data)
    if work.pieces is None:
        return work
    starts = across_row_edge(work.best, total(work.pieces), data.recordings[0].period)
    return min([work, *_iterated(starts, data, _EDGES, enough)], key=lambda w: w.value)


def successive_halving(
    hypotheses: Sequence[Hypothesis], current: Fit, data: Data
) -> tuple[list[Fit | None], list[float | None]]:
    """Return fits by successive halving: first on the most informative recordings, then the best on all.

    Args:
        hypotheses: to be compared.
        current: the fit that they would replace.
        data: recordings, floor, weights.

    Returns:
        Per hypothesis its fit to all recordings, None where it never ran or was given up; and the share of
        the squared error above the noise that it removed on the first recordings, None where it never ran.
    """
    most_informative = data.most_informative(current.mean_squares, POLICY.informative_share)
    some = data.part(most_informative)
    floor = some.objective(some.pool(some.floor))
    before = some.objective(some.pool(current.mean_squares[list(most_informative)]))
    first = _iterated(hypotheses, some, _FIRST_ITERATIONS)
    most = POLICY.delay_left * before + (1.0 - POLICY.delay_left) * floor
    first = _retried_delays(first, _still_competing(first, before, floor), some, most)
    near = _still_competing(first, before, floor)
    shares = [removed_share(before, w.value, floor) if np.isfinite(w.value) else None for w in first]
    running = {k: w.best for k, w in enumerate(first) if near[k]}
    final = dict(zip(running, fit(list(running.values()), data), strict=True))
    return [final.get(k) for k in range(len(first))], shares


def _still_competing(works: Sequence[_Work], before: float, floor: float) -> np.ndarray:
    """Return which of them (W,) are close enough to the best to go on."""
    left = np.array([w.value - floor for w in works])
    limit = POLICY.race_behind * max(left.min(initial=np.inf), 0.0) + POLICY.race_noise * floor
    limit += POLICY.race_excess * max(before - floor, 0.0)
    return np.isfinite(left) & (left <= limit)


def _retried_delays(works: list[_Work], near: np.ndarray, data: Data, most: float) -> list[_Work]:
    """Return fits with poorly fitted delays restarted at the best delay, or in a neighbouring row."""
    led = retry_at_best_delay([w.best for w in works], [w.value for w in works], near)
    out = list(works)
    for k, other in zip(led, _iterated(list(led.values()), data, _FIRST_ITERATIONS), strict=True):
        out[k] = min(out[k], other, key=lambda w: w.value)
    done = [near[k] or w.value > most for k, w in enumerate(out)]
    return [w if d else _across_row_edge(w, data, TOLERANCE) for d, w in zip(done, out, strict=True)]


def _simulate(works: list[_Work], data: Data, enough: float) -> None:
    """Simulate the trial values; keep them if they are better, otherwise raise the damping."""
    results = data.run([w.tried.model for w in works])
    for work, runs in zip(works, results, strict=True):
        mean_squares = data.mean_squares(runs)
        value = data.objective(data.pool(mean_squares)) if np.isfinite(mean_squares).all() else np.inf
        if value < work.value:
            gain = (work.value - value) / work.value if np.isfinite(work.value) else 1.0
            work.best, work.runs, work.mean_squares, work.value = work.tried, runs, mean_squares, value
            work.pieces, work.damping = None, work.damping / 10.0 if work.damping > 1e-4 else 0.0
            work.done = gain < enough
        else:
            _reject(work)


def _reject(work: _Work) -> None:
    if work.pieces is None or work.damping > 100.0:
        work.done = True
        return
    work.damping = max(10.0 * work.damping, 0.1)


def _linearise(works: list[_Work], data: Data) -> None:
    """Compute normal equations about each hypothesis and fold; long recordings are processed a few hypotheses
    at a time.
    """
    size = sum(len(r) * len(r.axes) ** 2 for r in data.recordings[: data.training])
    together = max(1, _AT_ONCE // size)
    for first in range(0, len(works), together):
        _linearise_together(works[first : first + together], data)


def _linearise_together(works: list[_Work], data: Data) -> None:
    linearisations = [Linearisation.of(w.best.model, data, w.runs, data.training) for w in works]
    columns = [
        [c for a in w.best.free for c in s.derivatives(a)] for w, s in zip(works, linearisations, strict=True)
    ]
    responses = propagate_sensitivities(linearisations, columns, data)
    for work, own in zip(works, responses, strict=True):
        if not all(np.abs(r).max(initial=0.0) < _OVERFLOW for r in own):  # nor NaN
            work.value, work.done = np.inf, True  # the loop about this motion is unstable: no direction
            continue
        residuals = [data.residual(i, work.runs[i]) * data.weight for i in range(data.training)]
        work.pieces, work.phase_folds = (
            [normal(own[f.recording][f.rows], residuals[f.recording][f.rows]) for f in folds]
            for folds in (data.folds, data.phase_folds if any(data.motion_periods) else ())
        )
        work.noise = sum(
            (scatter([draw[i] * data.weight for draw in data.draws], own[i]) for i in range(data.training)),
            np.zeros((own[0].shape[-1],) * 2),
        )


def _step(work: _Work, enough: float) -> None:
    """Compute the next trial values; mark a hypothesis done if they would change nothing."""
    assert work.pieces is not None
    whole = total(work.pieces)
    low, high = step_bounds(work.best)
    change = solve(whole, low, high, work.damping)
    fall = whole.square - whole.after(change)
    if len(change) == 0 or fall < enough * whole.square:
        work.done = True
        return
    work.tried = moved(work.best, change)


def _finish(work: _Work, data: Data) -> Fit | None:
    if not np.isfinite(work.value):
        return None
    assert work.pieces is not None and work.mean_squares is not None and work.noise is not None
    whole = total(work.pieces)
    low, high = step_bounds(work.best)
    changes = []
    for piece in work.pieces:
        rest = whole - piece
        changes.append(solve(rest, low, high))
    folds = np.array([p.after(c) / p.samples for p, c in zip(work.pieces, changes, strict=True)])
    weights = np.array([p.samples for p in work.pieces])
    test_loss = float(np.average(folds, weights=weights))
    if data.tests_on_holdout:
        test_loss = data.objective(data.pool(work.mean_squares, held_out=True))
        folds = np.array([data.objective(ms) for ms in work.mean_squares[data.training :]])
    # model error is the same in every period of a motion, and would not show in their scatter
    moves = [solve(whole - piece, low, high) for piece in work.phase_folds] or changes
    covariance = covariance_of(whole, work.noise, np.array(moves), work.value, data)
    return Fit(
        with_deviations(work.best, covariance, data),
        work.runs,
        work.mean_squares,
        work.value,
        test_loss,
        folds,
    )
