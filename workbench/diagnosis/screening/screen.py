"""Screening: the test loss that every effect in every place would have, from one linearisation."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from workbench.comparison import is_free
from workbench.core import EffectKey, Recording
from workbench.effects import Compliance, Door, OnGround, effect_named, kinds, places
from workbench.models import AppliedEffect, Placement

from ..data import Data
from ..fitting.bounded_least_squares import solve
from ..fitting.normal_equations import Normal, normal, total
from ..hypothesis import applied_effect
from .command_path import by_command_path
from .propagation import propagate_sensitivities
from .sensitivity import Linearisation, SensitivityColumn

#: What acts on the motion; what shifts commands or readings is no torque.
TORQUES = frozenset({Door.MOTOR, Door.FRICTION, Door.MECHANISM})
_BLOCK = 64  # columns propagated together; only those of one effect are compared with each other
_MOVED = (-0.01, -0.003, -0.001, 0.001, 0.003, 0.01)  # m, of a foot: values to begin with
_HELD = 4_000_000  # numbers of a column times columns, of more than a block of which long data get fewer


@dataclass(frozen=True)
class Candidate:
    """An effect in a place with its first estimate.

    Attributes:
        key: which, where.
        coefficients: linear coefficients, (k,).
        shape: nonlinear parameters.
        test_loss: predicted weighted mean square on data that were not fitted.
        beside: nonlinear parameters of the model's own effects, when this one is added.
    """

    key: EffectKey
    coefficients: np.ndarray
    shape: Mapping[str, float]
    test_loss: float
    beside: Mapping[EffectKey, Mapping[str, float]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Entry:
    """An effect of one shape: the numbers of its columns, and the effect of one unit."""

    key: EffectKey
    shape: Mapping[str, float]
    linear: list[int]
    fixed: int | None
    strength: float


def screen(
    linearisation: Linearisation,
    data: Data,
    simulated: Sequence[Recording],
    free: Sequence[AppliedEffect],
    *,
    left_out: Container[EffectKey] = (),
    whole: Equations | None = None,
) -> tuple[list[Candidate], float]:
    """All effects that could be added to the linearised model, with their predicted test loss.

    Args:
        linearisation: model, motions and loops on all recordings of `data`.
        data: recordings and weights.
        simulated: the model's runs.
        free: effects in the model whose parameters may follow.
        left_out: effects that are not asked for.
        whole: the equations of all effects where they are known; only without `free` and `left_out`.

    Returns:
        Candidates, best first, and the test loss without any of them (parameters of `free` refitted).
    """
    following = [c for applied in free for c in linearisation.derivatives(applied)]
    kept, known = list(range(len(following))), propagate_sensitivities([linearisation], [following], data)[0]
    best: dict[EffectKey, Candidate] = {}
    without: float | None = None
    size = int(np.clip(_HELD // sum(m.position.size for m in linearisation.motions), 1, _BLOCK))
    taken = {applied.key for applied in free}
    asked = [key for key in places(linearisation.model) if key not in taken and key not in left_out]
    for entries, pieces, held_out in (
        [(whole.entries, whole.pieces, whole.held_out)]
        if whole is not None
        else (
            (entries, *equations(linearisation, known, columns, data, simulated))
            for columns, entries in _blocks(linearisation, len(following), asked, size)
        )
    ):
        if without is None:
            anywhere = np.full(len(kept), -np.inf), np.full(len(kept), np.inf)
            without = judge(pieces, held_out, kept, (), anywhere)[0]
        for entry in entries:
            candidate = _candidate(linearisation, entry, kept, pieces, held_out)
            before = best.get(entry.key)
            if before is None or candidate.test_loss < before.test_loss:
                best[entry.key] = candidate
    apart = [c for c in on_the_ground(linearisation, data) if c.key not in taken]
    found = [*by_command_path(linearisation, best.values(), without or 0.0), *apart]
    return sorted(found, key=lambda c: c.test_loss), without or 0.0


def on_the_ground(linearisation: Linearisation, data: Data) -> list[Candidate]:
    """Candidates of ground contact and foot position, from measured forces, by simulation.

    They are no torque along a motion. Where forces were not recorded, these effects are in
    `unobservable_effects`.
    """
    tried: list[tuple[EffectKey, np.ndarray, Mapping[str, float]]] = []
    for key in places(linearisation.model) if data.replay.on_ground else ():
        effect = effect_named(key.effect)
        if isinstance(effect, OnGround):
            own = effect.guesses(linearisation.motions[: data.training])
            tried += [(key, np.zeros(0), shape) for shape in own]
        elif kinds.moves_feet(effect):
            tried += [(key, np.array([value]), {}) for value in _MOVED]
    models = []
    for key, coefficients, shape in tried:
        values = effect_named(key.effect).parameters.to_values(coefficients, shape)
        models.append(
            linearisation.model.with_effect(applied_effect(linearisation.model, AppliedEffect(key), values))
        )
    squares = [data.mean_squares(runs) for runs in data.run(models)] if models else []
    part = data.tests_on_holdout
    test_loss = [data.objective(data.pool(s, part)) if np.isfinite(s).all() else np.inf for s in squares]
    best: dict[EffectKey, Candidate] = {}
    for (key, coefficients, shape), left in sorted(zip(tried, test_loss, strict=True), key=lambda x: -x[1]):
        best[key] = Candidate(key, coefficients, shape, left)
    return list(best.values())


def unobservable_effects(linearisation: Linearisation, data: Data) -> list[EffectKey]:
    """Effects that this kind of replay, or the recorded ground forces, cannot show."""
    out = []
    for key in places(linearisation.model):
        effect = effect_named(key.effect)
        hidden = not data.replay.shows(key.effect)
        if data.replay.on_ground and isinstance(effect, OnGround):
            hidden = hidden or not effect.guesses(linearisation.motions[: data.training])
        # what shifts commands or readings is no torque, which is all that a measured motion tells
        along = not data.replay.simulates and effect.door not in TORQUES
        if hidden or along:
            out.append(key)
    return out


def _blocks(
    linearisation: Linearisation, first: int, asked: Iterable[EffectKey], size: int
) -> Iterator[tuple[list[SensitivityColumn], list[Entry]]]:
    """Effects in their places, in all shapes, in blocks of `size` columns that are numbered from `first`."""
    columns: list[SensitivityColumn] = []
    entries: list[Entry] = []
    sizes = sizes_of(linearisation)
    for key in asked:
        effect, place = effect_named(key.effect), Placement.of(linearisation.model, key)
        replay = linearisation.data.replay
        if isinstance(effect, Compliance | OnGround) or not replay.shows(key.effect):
            continue  # see `compliance_candidates` and `on_the_ground`
        if kinds.moves_feet(effect) and replay.on_ground:
            continue  # how deep a foot goes is no torque along the motion
        for shape in effect.parameters.shapes(linearisation.motions, linearisation.model, place):
            linear, fixed = linearisation.columns(key, shape)
            own = [*linear, *([fixed] if fixed else [])]
            if columns and len(columns) + len(own) > size:
                yield columns, entries
                columns, entries = [], []
            start = first + len(columns)
            columns += own
            where = start + len(linear) if fixed is not None else None
            numbers = list(range(start, start + len(linear)))
            entries.append(Entry(key, shape, numbers, where, strength_of(own, sizes)))
    yield columns, entries


def _candidate(
    linearisation: Linearisation, entry: Entry, kept: list[int], pieces: list[Normal], held_out: Normal | None
) -> Candidate:
    lower, upper = limits_of(linearisation, entry)
    open_low, open_high = np.full(len(kept), -np.inf), np.full(len(kept), np.inf)
    bounds = np.concatenate([open_low, lower]), np.concatenate([open_high, upper])
    fixed = () if entry.fixed is None else (entry.fixed,)
    test_loss, solution = judge(pieces, held_out, [*kept, *entry.linear], fixed, bounds)
    return Candidate(entry.key, solution[len(kept) :], entry.shape, test_loss)


def limits_of(linearisation: Linearisation, entry: Entry) -> tuple[np.ndarray, np.ndarray]:
    """Physical bounds of an entry's coefficients."""
    bounds = effect_named(entry.key.effect).parameters.bounds(
        linearisation.model, Placement.of(linearisation.model, entry.key)
    )
    return bounds[0][: len(entry.linear)], bounds[1][: len(entry.linear)]


def entries_of(linearisation: Linearisation) -> tuple[list[SensitivityColumn], list[Entry]]:
    """All effects in all places and shapes, with their columns."""
    columns: list[SensitivityColumn] = []
    entries: list[Entry] = []
    for more, found in _blocks(linearisation, 0, places(linearisation.model), 10**9):
        columns, entries = more, found
    return columns, entries


@dataclass(frozen=True)
class Equations:
    """Of all effects in all places and shapes: normal equations of training folds and of held-out data."""

    entries: tuple[Entry, ...]
    pieces: list[Normal]
    held_out: Normal | None


def equations(
    linearisation: Linearisation,
    known: list[np.ndarray],
    columns: list[SensitivityColumn],
    data: Data,
    simulated: Sequence[Recording],
) -> tuple[list[Normal], Normal | None]:
    """Normal equations of each training fold, and of the held-out recordings together.

    `known`: responses of the unknowns that stand before `columns`, per recording.
    """
    return equations_of(responses(linearisation, known, columns, data), data, simulated)


def responses(
    linearisation: Linearisation, known: list[np.ndarray], columns: list[SensitivityColumn], data: Data
) -> list[np.ndarray]:
    """Weighted changes of the signals by each unknown, (N, 2, n, C) per recording."""
    parts = [
        propagate_sensitivities([linearisation], [columns[k : k + _BLOCK]], data)[0]
        for k in range(0, len(columns), _BLOCK)
    ]
    each = zip(*([known] if known else []), *parts, strict=True)
    return [own[0] if len(own) == 1 else np.concatenate(own, axis=-1) for own in each]


def equations_of(
    changes: Sequence[np.ndarray], data: Data, simulated: Sequence[Recording]
) -> tuple[list[Normal], Normal | None]:
    """Normal equations of each training fold, and of held-out recordings that judge, from `responses`."""
    residuals = [data.residual(i, s) * data.weight for i, s in enumerate(simulated)]
    pieces = [normal(changes[f.recording][f.rows], residuals[f.recording][f.rows]) for f in data.folds]
    held_out: Normal | None = None
    for i in range(data.training, len(simulated) if data.tests_on_holdout else data.training):
        own = normal(changes[i], residuals[i])
        held_out = own if held_out is None else held_out + own
    return pieces, held_out


def judge(
    pieces: list[Normal],
    held_out: Normal | None,
    index: list[int],
    fixed: Sequence[int],
    bounds: tuple[np.ndarray, np.ndarray],
) -> tuple[float, np.ndarray]:
    """Mean square left on held-out data (or across folds), and the solution on all training data.

    Args:
        pieces, held_out: see `equations`.
        index: unknowns.
        fixed: columns without a coefficient, which come off the residual first.
        bounds: of the unknowns.
    """
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


def _shifted(piece: Normal, index: list[int], fixed: Sequence[int]) -> Normal:
    for k in fixed:
        right = piece.right - piece.gram[:, k]
        square = piece.square - 2.0 * piece.right[k] + piece.gram[k, k]
        piece = Normal(piece.gram, right, float(square), piece.samples)
    return piece.pick(index)


def _size(parts: Sequence[np.ndarray | None]) -> float:
    """Root mean square of all that is there."""
    there = [np.mean(p**2) for p in parts if p is not None]
    return float(np.sqrt(np.mean(there))) if there else 0.0


def sizes_of(linearisation: Linearisation) -> tuple[float, float, float]:
    """Of the motors' torque, of the motion and of its rate."""
    motor = _size([m.torque for m in linearisation.motions])
    if all(
        map(is_free, linearisation.data.recordings)
    ):  # then what accelerates the mechanism stands for the motor's
        motor = _size([np.einsum("kij,kj->ki", m.inertia(), m.acceleration) for m in linearisation.motions])
    moved = _size([m.position - m.position.mean(axis=0) for m in linearisation.motions])
    return motor, moved, _size([m.velocity for m in linearisation.motions])


def strength_of(columns: list[SensitivityColumn], sizes: tuple[float, float, float]) -> float:
    """What one unit of the largest column does: torque over the motor's, or a reading over the motion's."""
    motor, moved, rate = (max(x, 1e-300) for x in sizes)
    shares = [
        max(
            _size(c.torque) / motor,
            _size(c.command) / motor,
            _size([None if r is None else r[0] for r in c.reading]) / moved,
            _size([None if r is None else r[1] for r in c.reading]) / rate,
        )
        for c in columns
    ]
    return max(shares, default=0.0)
