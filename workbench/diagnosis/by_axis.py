"""What is found of an arm axis by axis: a wrist that does strange things takes nothing from the shoulder."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.effects import effect_named

from .data import Data
from .fit import fit
from .hypothesis import Fit

# What friction does beyond its laws stays on a geared arm, and so do masses that are a little wrong: shares
# of an axis's excess as friction leaves them on arms with published friction.
_EXPLAINED = 0.60
#: Axes that say more together than a stranger on one of them could.
MANY = 3


def shares(data: Data, start: Fit, end: Fit, at_end: Data) -> np.ndarray:
    """Share of each axis's excess that is gone at the end, of fitted or held-out data, the smaller, (n,).

    `at_end` has the floor of the last model. An axis without an excess has a share of 1.
    """
    least = np.ones(len(data.recordings[0].axes))
    for held_out in {False, data.held_out_judges}:
        floor, later = data.pool(data.floor, held_out), at_end.pool(at_end.floor, held_out)
        first, last = data.pool(start.mean_squares, held_out), data.pool(end.mean_squares, held_out)
        weight = data.weight**2
        before = np.sum(np.maximum(first - floor, 0.0) * weight, axis=0)
        after = np.sum(np.maximum(last - np.maximum(floor, later), 0.0) * weight, axis=0)
        there = before > 0.0
        least = np.minimum(least, 1.0 - np.where(there, after / np.where(there, before, 1.0), 0.0))
    return least


def explained_by_axis(data: Data, start: Fit, end: Fit, at_end: Data) -> dict[str, float]:
    """Share of its excess that each axis has explained, where many do well with friction and rotors.

    By the names of these axes; empty where they are too few or one of them does not do well.
    """
    axes = _axes(end)
    if axes is None or len(axes) < MANY:
        return {}
    found = shares(data, start, end, at_end)
    own = {end.hypothesis.base.axes[k]: float(found[k]) for k in sorted(axes)}
    return own if min(own.values()) > _EXPLAINED else {}


def where_it_holds(whole: Fit, start: Fit, data: Data) -> Fit:
    """The fit with only the effects on axes that do well with them; as it is where too few would be left."""
    axes = _axes(whole)
    if axes is None:
        return whole
    sound = {k for k in axes if shares(data, start, whole, data)[k] > _EXPLAINED}
    if sound == axes or len(sound) < MANY:
        return whole
    names = {whole.hypothesis.base.axes[k] for k in sound}
    free = tuple(a for a in whole.hypothesis.free if a.key.axis in names)
    return fit([replace(whole.hypothesis, free=free)], data)[0] or whole


def _axes(found: Fit) -> set[int] | None:
    """The axes of its effects; None where one of these is more than friction or a rotor."""
    added, axes = found.hypothesis.added, found.hypothesis.base.axes
    if not all(effect_named(a.key.effect).basic and a.key.axis in axes for a in added):
        return None
    return {axes.index(a.key.axis) for a in added if a.key.axis is not None}
