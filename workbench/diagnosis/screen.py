"""Every effect in every place, judged by what it would explain, from one linearisation of the loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.effects import effect_named, places
from workbench.models import AppliedEffect, Placement

from .data import Data
from .sensitivity import Column, Normal, Scene, normal, respond, total
from .solve import solve


@dataclass(frozen=True)
class Candidate:
    """An effect in a place with its first estimate.

    Attributes:
        key: which, where.
        coefficients: linear coefficients, (k,).
        shape: nonlinear parameters.
        judged: weighted mean square that it would leave on data it was not fitted on.
        detectable: how many standard deviations of noise an effect of 2 % of the torque would show,
            beyond what simpler effects in the same place can imitate.
    """

    key: EffectKey
    coefficients: np.ndarray
    shape: Mapping[str, float]
    judged: float
    detectable: float


@dataclass(frozen=True)
class _Entry:
    key: EffectKey
    shape: Mapping[str, float]
    linear: list[int]
    fixed: int | None
    strength: float


def screen(
    scene: Scene, data: Data, simulated: Sequence[Recording], free: Sequence[AppliedEffect]
) -> tuple[list[Candidate], float]:
    """Judge all effects that could be added to the scene's model.

    Args:
        scene: model, motions and loops on all recordings of `data`.
        data: recordings and weights.
        simulated: the model's runs.
        free: effects in the model whose parameters may follow.

    Returns:
        Candidates, best first, and the judged error without any of them (parameters of `free` refitted).
    """
    columns: list[Column] = []
    for applied in free:
        columns += scene.derivatives(applied)
    kept = list(range(len(columns)))
    entries: list[_Entry] = []
    taken = {applied.key for applied in free}
    for key in places(scene.model):
        if key in taken:
            continue
        effect = effect_named(key.effect)
        place = Placement.of(scene.model, key)
        for shape in effect.shapes(scene.motions[0], scene.model, place):
            linear, fixed = scene.columns(key, shape)
            start = len(columns)
            columns += linear
            where = None
            if fixed is not None:
                where = len(columns)
                columns.append(fixed)
            own = [*linear, *([fixed] if fixed else [])]
            entries.append(
                _Entry(key, shape, list(range(start, start + len(linear))), where, _strength(scene, own))
            )
    pieces, held_out = _equations(scene, columns, data, simulated)
    without = _judge(pieces, held_out, kept, None, (np.full(len(kept), -np.inf), np.full(len(kept), np.inf)))
    best: dict[EffectKey, Candidate] = {}
    for entry in entries:
        candidate = _candidate(scene, entry, kept, pieces, held_out)
        known = best.get(entry.key)
        if known is None or candidate.judged < known.judged:
            best[entry.key] = candidate
    return sorted(best.values(), key=lambda c: c.judged), without[0]


def _candidate(
    scene: Scene, entry: _Entry, kept: list[int], pieces: list[Normal], held_out: Normal | None
) -> Candidate:
    effect = effect_named(entry.key.effect)
    place = Placement.of(scene.model, entry.key)
    lower, upper = (b[: len(entry.linear)] for b in effect.bounds(scene.model, place))
    open_low, open_high = np.full(len(kept), -np.inf), np.full(len(kept), np.inf)
    bounds = np.concatenate([open_low, lower]), np.concatenate([open_high, upper])
    judged, solution = _judge(pieces, held_out, [*kept, *entry.linear], entry.fixed, bounds)
    return Candidate(entry.key, solution[len(kept) :], entry.shape, judged, _detectable(pieces, entry, kept))


def _equations(
    scene: Scene, columns: list[Column], data: Data, simulated: Sequence[Recording]
) -> tuple[list[Normal], Normal | None]:
    """Normal equations of each training fold, and of the held-out recordings together."""
    responses = respond([scene], [columns], data)[0]
    residuals = [data.residual(i, s) * data.weight for i, s in enumerate(simulated)]
    pieces = [normal(responses[f.recording][f.rows], residuals[f.recording][f.rows]) for f in data.folds]
    held_out: Normal | None = None
    for i in range(data.training, len(simulated)):
        own = normal(responses[i], residuals[i])
        held_out = own if held_out is None else held_out + own
    return pieces, held_out


def _judge(
    pieces: list[Normal],
    held_out: Normal | None,
    index: list[int],
    fixed: int | None,
    bounds: tuple[np.ndarray, np.ndarray],
) -> tuple[float, np.ndarray]:
    """Mean square left on held-out data (or across folds), and the solution on all training data."""
    parts = [_shifted(p, index, fixed) for p in pieces]
    whole = total(parts)
    solution = solve(whole, *bounds)
    if held_out is not None:
        other = _shifted(held_out, index, fixed)
        return other.after(solution) / other.samples, solution
    left = 0.0
    for part in parts:
        rest = whole - part
        left += part.after(solve(rest, *bounds))
    return left / whole.samples, solution


def _shifted(piece: Normal, index: list[int], fixed: int | None) -> Normal:
    """Only some unknowns, with a fixed column taken off the residual first."""
    if fixed is None:
        return piece.pick(index)
    right = piece.right - piece.gram[:, fixed]
    square = piece.square - 2.0 * piece.right[fixed] + piece.gram[fixed, fixed]
    return Normal(piece.gram, right, float(square), piece.samples).pick(index)


def _strength(scene: Scene, columns: list[Column]) -> float:
    """Root mean square of the largest column over that of the motor torque: what one unit does."""
    motor = np.sqrt(np.mean([np.mean(m.torque**2) for m in scene.motions]))
    sizes = [np.sqrt(np.mean([np.mean(t**2) for t in c.torque])) for c in columns]
    return float(max(sizes, default=0.0) / max(motor, 1e-300))


def _detectable(pieces: list[Normal], entry: _Entry, kept: list[int]) -> float:
    """Size in noise deviations of a share of 2 % of the torque, beside parameters that follow."""
    own = entry.linear or ([entry.fixed] if entry.fixed is not None else [])
    if not own or entry.strength == 0.0:
        return 0.0
    gram = total(pieces).gram
    k = own[-1]
    seen = gram[k, k]
    others = [*kept, *own[:-1]]
    if others:
        block = gram[np.ix_(others, others)] + 1e-12 * np.trace(gram[np.ix_(others, others)]) * np.eye(
            len(others)
        )
        seen -= gram[k, others] @ np.linalg.solve(block, gram[others, k])
    return float(np.sqrt(max(seen, 0.0)) * 0.02 / entry.strength)
