"""Recordings that contradict each other: one effect explains each of them, and has another size in each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import Disagreement
from workbench.effects import effect_named
from workbench.models import AppliedEffect

from ..fitting.normal_equations import scaled_inverse, total
from ..policy import POLICY
from .equations import Entry
from .linear_problem import Linear


@dataclass(frozen=True)
class _Apart:
    """An effect with sizes of its own in each of R recordings, (R, k), and their deviations.

    `left`: squared residual of each, (R,); `alike`: of all, where it has one size in all.
    """

    entry: Entry
    sizes: np.ndarray
    deviations: np.ndarray
    left: np.ndarray
    alike: float


def disagreements(
    linear: Linear, names: Sequence[str], beside: Sequence[AppliedEffect] = ()
) -> tuple[Disagreement, ...]:
    """Return, for the effect that best explains each recording alone, sizes that differ between recordings.

    A recording that is nearly explained as it is, beside the others, says that the effect is none there. What
    stays unexplained of a recording makes its size as uncertain as if as much again hid behind the effect.

    Args:
        linear: all effects and the normal equations by recording.
        names: of the recordings.
        beside: effects that have one size in all of them.
    """
    if len(linear.own) < 2 or (linear.excess <= linear.quiet).all():
        return ()  # what is at the noise contradicts nothing
    known = [_entry_of(applied, linear) for applied in beside]
    shared = [e for e in known if e is not None]
    tried = [own for e in linear.forms if e.linear and (own := _apart(linear, e, shared)) is not None]
    if not tried:
        return ()
    most = (1.0 + POLICY.tie) * min(t.left.sum() for t in tried)
    best = min((t for t in tried if t.left.sum() <= most), key=lambda t: (len(t.entry.linear), t.left.sum()))
    left, quiet = best.left - linear.quiet, linear.quiet
    if (left > np.maximum((1.0 - POLICY.explained) * linear.excess.max(), quiet)).any():
        return ()
    if left.sum() > (1.0 - POLICY.most_of_excess) * (best.alike - quiet.sum()):
        return ()  # one size in all explains nearly as much
    doubt = best.deviations * np.maximum(POLICY.significant, np.sqrt(np.maximum(left, 0.0)))[:, None]
    rows = np.arange(best.sizes.shape[1])
    low, high = best.sizes.argmin(axis=0), best.sizes.argmax(axis=0)
    apart = np.ptp(best.sizes, axis=0) / np.maximum(np.hypot(doubt[low, rows], doubt[high, rows]), 1e-300)
    k = int(apart.argmax())
    if apart[k] < 1.0 or np.ptp(best.sizes[:, k]) < POLICY.disagreement * np.abs(best.sizes[:, k]).max():
        return ()
    return (_told(best, k, names),)


def _told(found: _Apart, which: int, names: Sequence[str]) -> Disagreement:
    """The disagreement in one of the unknowns of an effect."""
    entry, parameters = found.entry, effect_named(found.entry.key.effect).parameters
    name = parameters.linear_of(entry.shape)[which].name
    told = [parameters.to_values(sizes, entry.shape) for sizes in found.sizes]
    # an unknown of a chart that is no parameter stands for itself
    values = [
        float(own[name] if name in own else sizes[which])
        for own, sizes in zip(told, found.sizes, strict=True)
    ]
    several = name if len(entry.linear) > 1 else ""
    return Disagreement(tuple(names[: len(values)]), entry.key, tuple(values), several)


def _entry_of(applied: AppliedEffect, linear: Linear) -> Entry | None:
    """The form that comes closest to an effect that was found; None if it has no columns."""
    _, shape = effect_named(applied.key.effect).parameters.to_coefficients(applied.values)
    forms = [e for e in linear.forms if e.key == applied.key and e.linear and set(e.shape) == set(shape)]
    return min(forms, key=lambda e: sum(abs(e.shape[n] - x) for n, x in shape.items()), default=None)


def _apart(linear: Linear, entry: Entry, shared: Sequence[Entry]) -> _Apart | None:
    """Return an effect with its own sizes in each recording, beside shared ones; None where one shows nothing
    of it.
    """
    others = [k for e in shared if e.key != entry.key for k in e.linear]
    own = [piece.pick([*others, *entry.linear]) for piece in linear.own]
    count, k = len(others), len(entry.linear)
    if any((np.diag(piece.gram)[count:] <= 0.0).any() for piece in own):
        return None
    places = [[*range(count), *range(count + r * k, count + (r + 1) * k)] for r in range(len(own))]
    gram, right = np.zeros((count + len(own) * k,) * 2), np.zeros(count + len(own) * k)
    for piece, place in zip(own, places, strict=True):
        gram[np.ix_(place, place)] += piece.gram
        right[place] += piece.right
    inverse = scaled_inverse(gram)
    found, alike = inverse @ right, total(own)
    deviations = np.sqrt(np.maximum(np.diag(inverse)[count:], 0.0))
    return _Apart(
        entry,
        found[count:].reshape(len(own), k),
        deviations.reshape(len(own), k),
        np.array([piece.after(found[place]) for piece, place in zip(own, places, strict=True)]),
        float(alike.after(scaled_inverse(alike.gram) @ alike.right)),
    )
