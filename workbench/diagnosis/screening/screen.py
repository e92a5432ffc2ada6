"""Screening: the test loss that every effect in every place would have, from one linearisation."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from workbench.core import EffectKey
from workbench.effects import Compliance, effect_named, places
from workbench.models import AppliedEffect, Placement

from ..data import Data
from .candidate import Candidate
from .command_path import by_command_path
from .equations import Entry, Equations, bounds_of, equations
from .ground_effects import by_runs
from .propagation import propagate_sensitivities
from .sensitivity import Linearisation, SensitivityColumn

_BLOCK = 64  # columns propagated together; only those of one effect are compared with each other
_HELD = 4_000_000  # numbers of a column times columns, of more than a block of which long data get fewer


def screen(
    linearisation: Linearisation,
    data: Data,
    free: Sequence[AppliedEffect] = (),
    *,
    left_out: Container[EffectKey] = (),
    whole: Equations | None = None,
) -> list[Candidate]:
    """Return all effects that could be added to the linearised model, with their predicted test loss.

    Args:
        linearisation: model, motions and loops on all recordings of `data`.
        data: recordings and weights.
        free: effects in the model whose parameters may follow.
        left_out: effects that are not asked for.
        whole: the equations of all effects where they are known; only without `free` and `left_out`.

    Returns:
        Candidates, best first.
    """
    following = [c for applied in free for c in linearisation.derivatives(applied)]
    kept, known = list(range(len(following))), propagate_sensitivities([linearisation], [following], data)[0]
    forms: dict[tuple[EffectKey, frozenset[str]], Candidate] = {}
    without: float | None = None
    size = int(np.clip(_HELD // sum(m.position.size for m in linearisation.motions), 1, _BLOCK))
    taken = {applied.key for applied in free}
    asked = [key for key in places(linearisation.model) if key not in taken and key not in left_out]
    blocks = (
        equations(linearisation, known, columns, entries, data)
        for columns, entries in _blocks(linearisation, len(following), asked, size)
    )
    for block in blocks if whole is None else (whole,):
        if without is None:
            without = block.judged((), kept=kept)[0]
        for entry in block.entries:
            test_loss, x = block.judged([entry], bounds_of(linearisation, [entry], len(kept)), kept)
            form = entry.key, frozenset(entry.shape)
            if form not in forms or test_loss < forms[form].test_loss:
                forms[form] = Candidate(entry.key, x[len(kept) :], entry.shape, test_loss)
    apart = [c for c in by_runs(linearisation, data) if c.key not in taken]
    best = _in_best_form(forms.values())
    found = [*by_command_path(linearisation, best, without or 0.0), *apart]
    return sorted(found, key=lambda c: c.test_loss)


def _in_best_form(forms: Iterable[Candidate]) -> list[Candidate]:
    """Return each effect in the form that leaves least, with its other forms."""
    known: dict[EffectKey, list[Candidate]] = {}
    for candidate in sorted(forms, key=lambda c: c.test_loss):
        known.setdefault(candidate.key, []).append(candidate)
    return [replace(own[0], others=tuple(own[1:])) for own in known.values()]


def _blocks(
    linearisation: Linearisation, first: int, asked: Iterable[EffectKey], size: int
) -> Iterator[tuple[list[SensitivityColumn], list[Entry]]]:
    """Return effects in all places and shapes, in blocks of `size` columns numbered from `first`."""
    columns: list[SensitivityColumn] = []
    entries: list[Entry] = []
    sizes = sizes_of(linearisation)
    for key in asked:
        effect, place = effect_named(key.effect), Placement.of(linearisation.model, key)
        replay = linearisation.data.replay
        elsewhere = isinstance(effect, Compliance) or replay.needs_runs(effect)
        if elsewhere or not replay.shows(key.effect):
            continue  # see `compliance_candidates` and `by_runs`
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


def entries_of(linearisation: Linearisation) -> tuple[list[SensitivityColumn], list[Entry]]:
    """Return all effects in all places and shapes, with their columns."""
    return next(_blocks(linearisation, 0, places(linearisation.model), 10**9))


def _size(parts: Sequence[np.ndarray | None]) -> float:
    """Return the root mean square of all values that are present."""
    there = [np.mean(p**2) for p in parts if p is not None]
    return float(np.sqrt(np.mean(there))) if there else 0.0


def sizes_of(linearisation: Linearisation) -> tuple[float, float, float]:
    """Return the sizes of the motors' torque, of the motion and of its rate."""
    motor = _size([m.torque for m in linearisation.motions])
    if not linearisation.data.replay.driven:  # then what accelerates the mechanism stands for the motor's
        motor = _size([np.einsum("kij,kj->ki", m.inertia(), m.acceleration) for m in linearisation.motions])
    moved = _size([m.position - m.position.mean(axis=0) for m in linearisation.motions])
    return motor, moved, _size([m.velocity for m in linearisation.motions])


def strength_of(columns: list[SensitivityColumn], sizes: tuple[float, float, float]) -> float:
    """The strength of the largest column per unit: torque over motor torque, or reading over motion."""
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
