"""Fit hypotheses by simulating the closed loop: Gauss-Newton on many of them at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from workbench.core import Estimate, Recording, SimulationError
from workbench.effects import Effect, axis_units, compile_plant, effect_named
from workbench.models import AppliedEffect, Model, Placement
from workbench.simulation import Run, simulate

from .data import Data
from .sensitivity import Normal, Scene, normal, respond
from .solve import solve

_ITERATIONS = 6
ENOUGH = 0.003  # relative fall of the objective below which fitting stops, good enough to compare
_STEP_SHARE = 0.005  # of a row's period
_FAR_BEHIND = 8.0
PRECISE = 1e-6  # the same for estimates: a thousandth of what a deviation of noise changes


@dataclass(frozen=True)
class Hypothesis:
    """A model, effects that its file states without a free parameter, and effects with free parameters."""

    base: Model
    free: tuple[AppliedEffect, ...]
    stated: tuple[AppliedEffect, ...] = ()

    @property
    def added(self) -> tuple[AppliedEffect, ...]:
        """All effects over the base."""
        return (*self.stated, *self.free)

    @property
    def model(self) -> Model:
        """Base with all effects in it."""
        out = self.base
        for applied in self.added:
            out = out.with_effect(applied)
        return out


@dataclass(frozen=True)
class Fit:
    """A hypothesis after fitting.

    Attributes:
        hypothesis: with the estimates and their deviations.
        simulated: its runs of all recordings.
        mean_squares: (R, 2, n).
        trained: weighted mean square on the training data.
        judged: the same on held-out data, or across folds with each fold left out of the fit.
        agreeing: per fold (or held-out recording) weighted mean square, to be held against another's.
    """

    hypothesis: Hypothesis
    simulated: tuple[Recording, ...]
    mean_squares: np.ndarray
    trained: float
    judged: float
    agreeing: np.ndarray


def values_of(hypotheses: Sequence[Hypothesis], data: Data) -> np.ndarray:
    """Training objective of hypotheses as they are; infinite where they do not run."""
    results = simulate([Run(h.model, r) for h in hypotheses for r in data.recordings], strict=False)
    count = len(data.recordings)
    squares = [data.mean_squares(results[k * count : (k + 1) * count]) for k in range(len(hypotheses))]
    return np.array([data.objective(data.pool(s)) if np.isfinite(s).all() else np.inf for s in squares])


def widened(found: Fit, others: Sequence[Fit], share: float = 0.5) -> Fit:
    """Deviations no smaller than those of rival fits of the same effects.

    They also cover a `share` of the way to the rivals' estimates.
    """
    free = []
    for k, applied in enumerate(found.hypothesis.free):
        parameters = {}
        for name, estimate in applied.parameters.items():
            rivals = [o.hypothesis.free[k].parameters[name] for o in others]
            away = max(abs(r.value - estimate.value) for r in rivals)
            least = max(estimate.std, *(r.std for r in rivals))
            spread = float(np.hypot(least, share * away))
            parameters[name] = replace(estimate, std=spread)
        free.append(AppliedEffect(applied.key, parameters))
    return replace(found, hypothesis=replace(found.hypothesis, free=tuple(free)))


@dataclass
class _Work:
    """One hypothesis on its way."""

    tried: Hypothesis
    best: Hypothesis
    runs: tuple[Recording, ...] = ()
    mean_squares: np.ndarray | None = None
    value: float = np.inf
    damping: float = 0.0
    pieces: list[Normal] | None = None
    noise: np.ndarray | None = None
    step: np.ndarray | None = None
    done: bool = False


def fit(
    hypotheses: Sequence[Hypothesis], data: Data, iterations: int = _ITERATIONS, enough: float = ENOUGH
) -> list[Fit | None]:
    """Fit all hypotheses to the training recordings, simulating them side by side.

    Args:
        hypotheses: where to start from.
        data: recordings, floor, weights.
        iterations: most simulations of each.
        enough: relative fall of the objective at which to stop.

    Returns:
        One fit a hypothesis; None where it never ran (unstable, or a body that cannot be).
    """
    works = [_Work(h, h) for h in hypotheses]
    for turn in range(iterations):
        best = min(w.value for w in works)
        for work in works:
            # what is far behind after two tries needs no better estimate to lose
            work.done |= turn > 1 and work.value > _FAR_BEHIND * best
        active = [w for w in works if not w.done]
        if not active:
            break
        _simulate(active, data, enough)
        moved = [w for w in active if not w.done]
        _linearise([w for w in moved if w.pieces is None], data)
        for work in moved:
            _step(work, data, enough)
    return [_finish(w, data) if np.isfinite(w.value) else None for w in works]


def _simulate(works: list[_Work], data: Data, enough: float) -> None:
    """Run what is to be tried; keep it where it is better, else shorten the next step."""
    runnable = []
    for work in works:
        try:
            compile_plant(work.tried.model)
            runnable.append(work)
        except SimulationError:
            _reject(work)
    models = [w.tried.model for w in runnable]
    results = simulate([Run(m, r) for m in models for r in data.recordings], strict=False)
    count = len(data.recordings)
    for k, work in enumerate(runnable):
        runs = tuple(results[k * count : (k + 1) * count])
        mean_squares = data.mean_squares(runs)
        value = data.objective(data.pool(mean_squares)) if np.isfinite(mean_squares).all() else np.inf
        if value < work.value:
            gain = (work.value - value) / work.value if np.isfinite(work.value) else 1.0
            work.best, work.runs, work.mean_squares, work.value = work.tried, runs, mean_squares, value
            work.pieces, work.damping = None, work.damping / 10.0 if work.damping > 1e-4 else 0.0
            if gain < enough:
                work.done = True
                _linearise([work], data)
        else:
            _reject(work)


def _reject(work: _Work) -> None:
    if work.pieces is None or work.damping > 100.0:
        work.done = True
        return
    work.damping = max(10.0 * work.damping, 0.1)


def _linearise(works: list[_Work], data: Data) -> None:
    """Normal equations about each hypothesis, per fold."""
    if not works:
        return
    scenes = [Scene.of(w.best.model, data, w.runs, data.training) for w in works]
    columns = [[c for a in w.best.free for c in s.derivatives(a)] for w, s in zip(works, scenes, strict=True)]
    responses = respond(scenes, columns, data)
    for work, own in zip(works, responses, strict=True):
        residuals = [data.residual(i, work.runs[i]) * data.weight for i in range(data.training)]
        work.pieces = [normal(own[f.recording][f.rows], residuals[f.recording][f.rows]) for f in data.folds]
        work.noise = sum(
            (_scatter([draw[i] for draw in data.draws], own[i], data) for i in range(data.training)),
            np.zeros((own[0].shape[-1],) * 2),
        )


def _scatter(draws: list[np.ndarray], response: np.ndarray, data: Data) -> np.ndarray:
    """Covariance (C, C) of the right side that noise causes in one recording, from its draws."""
    flat = response.reshape(draws[0].size, response.shape[-1])
    hits = np.stack([flat.T @ (d * data.weight).reshape(-1) for d in draws])
    return hits.T @ hits / len(hits)


def _step(work: _Work, data: Data, enough: float) -> None:
    """The next values to try; done where they would change nothing."""
    assert work.pieces is not None
    total = _total(work.pieces)
    low, high = _room(work.best)
    change = solve(total, low, high, work.damping)
    fall = total.square - total.after(change)
    if len(change) == 0 or fall < enough * total.square:
        work.done = True
        return
    work.tried = _moved(work.best, change)


def _total(pieces: Sequence[Normal]) -> Normal:
    out = pieces[0]
    for piece in pieces[1:]:
        out = out + piece
    return out


def _blocks(hypothesis: Hypothesis) -> list[tuple[AppliedEffect, slice]]:
    """Which unknowns belong to which free effect: linear coefficients, then nonlinear parameters."""
    out, start = [], 0
    for applied in hypothesis.free:
        effect = effect_named(applied.key.effect)
        size = len(effect.to_coefficients(applied.values)[0]) + len(effect.nonlinear)
        out.append((applied, slice(start, start + size)))
        start += size
    return out


def _room(hypothesis: Hypothesis) -> tuple[np.ndarray, np.ndarray]:
    """How far each unknown may move: to its physical bound, nonlinear ones at most by half of themselves."""
    low, high = [np.zeros(0)], [np.zeros(0)]
    for applied, _ in _blocks(hypothesis):
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.to_coefficients(applied.values)
        lower, upper = effect.bounds(hypothesis.base, Placement.of(hypothesis.base, applied.key))
        reach = np.array([0.5 * abs(shape[name]) + 1e-5 for name in effect.nonlinear])
        now = np.array([shape[name] for name in effect.nonlinear])
        own = {p.name: p for p in effect.parameters}
        floor = np.array([own[name].lower for name in effect.nonlinear])
        ceiling = np.array([own[name].upper for name in effect.nonlinear])
        low += [lower - coefficients, np.maximum(-reach, floor - now)]
        high += [upper - coefficients, np.minimum(reach, ceiling - now)]
    return np.concatenate(low), np.concatenate(high)


def _moved(hypothesis: Hypothesis, change: np.ndarray) -> Hypothesis:
    free = []
    for applied, block in _blocks(hypothesis):
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.to_coefficients(applied.values)
        own = change[block]
        shape = {name: shape[name] + own[len(coefficients) + k] for k, name in enumerate(effect.nonlinear)}
        values = effect.to_parameters(coefficients + own[: len(coefficients)], shape)
        free.append(applied_effect(hypothesis.base, applied, values))
    return replace(hypothesis, free=tuple(free))


def applied_effect(model: Model, like: AppliedEffect, values: dict[str, float]) -> AppliedEffect:
    """The same effect with other values."""
    units = axis_units(model)
    parameters = {}
    for parameter in effect_named(like.key.effect).parameters:
        unit = (
            parameter.unit
            if like.key.axis is None
            else parameter.unit_on(units[model.axes.index(like.key.axis)])
        )
        if parameter.name in values:
            parameters[parameter.name] = Estimate(float(values[parameter.name]), 0.0, unit)
    return AppliedEffect(like.key, parameters)


def _finish(work: _Work, data: Data) -> Fit:
    if work.pieces is None:
        _linearise([work], data)
    assert work.pieces is not None and work.mean_squares is not None and work.noise is not None
    total = _total(work.pieces)
    low, high = _room(work.best)
    changes = []
    for piece in work.pieces:
        rest = Normal(total.gram - piece.gram, total.right - piece.right, total.square - piece.square, 0)
        changes.append(solve(rest, low, high))
    folds = np.array([p.after(c) / p.samples for p, c in zip(work.pieces, changes, strict=True)])
    weights = np.array([p.samples for p in work.pieces])
    judged = float(np.average(folds, weights=weights))
    if data.training < len(data.recordings):
        judged = data.objective(data.pool(work.mean_squares, held_out=True))
        folds = np.array([data.objective(ms) for ms in work.mean_squares[data.training :]])
    covariance = _covariance(total, work.noise, np.array(changes), work.value, data)
    return Fit(
        _with_deviations(work.best, covariance, data), work.runs, work.mean_squares, work.value, judged, folds
    )


def _covariance(
    total: Normal, noise: np.ndarray, changes: np.ndarray, value: float, data: Data
) -> np.ndarray:
    """Covariance of the unknowns: what noise does to them, and what leaving out a fold does.

    At the noise floor the first is right. Above it the model is wrong somewhere, residuals are not
    noise, and the jackknife over folds says how far estimates move.
    """
    if len(total.right) == 0:
        return np.zeros((0, 0))
    inverse = np.linalg.pinv(total.gram, rcond=1e-10)
    from_noise = inverse @ noise @ inverse
    excess = value / max(data.objective(data.pool(data.floor)), 1e-300)
    if excess < 1.15:
        return from_noise
    count = len(changes)
    moves = changes - changes.mean(axis=0)
    jackknife = (count - 1) / count * moves.T @ moves
    return from_noise * excess + jackknife


def _with_deviations(hypothesis: Hypothesis, covariance: np.ndarray, data: Data) -> Hypothesis:
    """Standard deviations of the parameters by the delta method."""
    free = []
    for applied, block in _blocks(hypothesis):
        effect = effect_named(applied.key.effect)
        coefficients, shape = effect.to_coefficients(applied.values)
        unknowns = np.array([*coefficients, *(shape[name] for name in effect.nonlinear)])
        own = covariance[block, block]

        values = partial(_values, effect, len(coefficients))
        middle = values(unknowns)
        slopes = np.empty((len(middle), len(unknowns)))
        for i in range(len(unknowns)):
            step = 1e-4 * max(abs(unknowns[i]), 1e-6)
            slopes[:, i] = (values(unknowns + step * (np.arange(len(unknowns)) == i)) - middle) / step
        deviation = np.sqrt(np.maximum(np.diag(slopes @ own @ slopes.T), 0.0))
        # inside a step a delay acts through means, which are right to this part of it
        fine = [_STEP_SHARE * data.recordings[0].period if p.unit == "s" else 0.0 for p in effect.parameters]
        deviation = np.hypot(deviation, fine)
        parameters = {
            p.name: Estimate(float(middle[i]), float(deviation[i]), applied.parameters[p.name].unit)
            for i, p in enumerate(effect.parameters)
        }
        free.append(AppliedEffect(applied.key, parameters))
    return replace(hypothesis, free=tuple(free))


def _values(effect: Effect, count: int, unknowns: np.ndarray) -> np.ndarray:
    """Parameters of an effect from its `count` linear coefficients and its nonlinear parameters."""
    shape = dict(zip(effect.nonlinear, unknowns[count:], strict=True))
    named = effect.to_parameters(unknowns[:count], shape)
    return np.array([named[p.name] for p in effect.parameters])
