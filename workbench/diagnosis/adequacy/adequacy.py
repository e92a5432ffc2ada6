"""Whether an effect is certain although something else is unknown: its law is tested against free functions.

A law is adequate where it explains nearly as much of its axis's residual as a free smooth function of the
law's own quantities does, and as the law with a size that varies freely with any other quantity (varying
coefficients: T. Hastie and R. Tibshirani, J. R. Statist. Soc. B 55(4), 1993); and where its size stays what
it is when a free smooth function of any other quantity is fitted beside it (partially linear regression:
P. Robinson, Econometrica 56(4), 1988). What only correlates with the true cause fails the last, a torque of
another law the first two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.core import EffectKey, Estimate
from workbench.effects import EFFECTS, Motion, effect_named, kinds, model_value
from workbench.models import AppliedEffect, Placement, alike_axes

from ..data import Data
from ..evidence.shape import splines
from ..hypothesis import Fit
from ..policy import POLICY
from ..screening.needed_torque import kept_rows, needing
from ..screening.propagation import propagate_sensitivities
from ..screening.sensitivity import Linearisation
from ..screening.torque_regression import Regression
from ..significance import INTERVAL
from .free_functions import Adequacy, against_free_functions
from .link_errors import columns_of_links
from .masses import adequacy_of_mass, multi_axis_law

_QUANTITIES = ("position", "speed", "acceleration", "load")


@dataclass(frozen=True, eq=False)
class _Axis:
    """One coordinate: torques of laws (M, E), residual of all of them (M,), quantities, and the recording of
    each row.
    """

    laws: np.ndarray
    rest: np.ndarray
    own: Mapping[str, np.ndarray]
    others: Mapping[str, np.ndarray]
    recording: np.ndarray


def adequacies(found: Fit, regression: Regression, data: Data) -> dict[EffectKey, Adequacy]:
    """Return the adequacy of each sufficiently identifiable effect, as a law of one axis or of a mass on
    several.

    Args:
        found: with all effects that were selected, along the measured motion.
        regression: about the model without them.
        data: recordings that are replayed along their measured motion.
    """
    linearisation = regression.linearisation
    applied = found.hypothesis.free
    columns = [linearisation.total(a, a.values) for a in applied]
    acts = propagate_sensitivities([linearisation], [columns], data)[0]
    out: dict[EffectKey, Adequacy] = {}
    places = {
        (a.key.axis, a.key.location): Placement.of(linearisation.model, a.key) for a in applied if a.key.axis
    }
    axes: dict[tuple[str | None, str], tuple[_Axis, list[EffectKey]]] = {}
    for (name, location), place in places.items():
        assert place is not None
        here = [k for k, a in enumerate(applied) if (a.key.axis, a.key.location) == (name, location)]
        axis = _axis(linearisation, found, data, [part[:, 1] for part in acts], here, place)
        if len(axis.rest) >= POLICY.fewest_moving_rows:
            axes[name, location] = axis, [applied[k].key for k in here]
            out |= _of_axis(*axes[name, location])
    for group in alike_axes(linearisation.model):
        out |= _together([axes[a, "actuator"] for a in group if (a, "actuator") in axes], applied, out)
    torques = [part[:, 1] for part in acts]
    for k, a in enumerate(applied):
        if not kinds.depends_on(effect_named(a.key.effect)):
            parts = torques
            if a.key.axis is None:  # all that links err by do nearly the same as a body that was added
                links = propagate_sensitivities([linearisation], [columns_of_links(linearisation)], data)[0]
                parts = [
                    np.concatenate([p, own[:, 1]], axis=-1) for p, own in zip(torques, links, strict=True)
                ]
            law = multi_axis_law(linearisation, found, data, parts, k, len(applied))
            out[a.key] = adequacy_of_mass(law)
    return out


def _axis(
    linearisation: Linearisation,
    found: Fit,
    data: Data,
    acts: Sequence[np.ndarray],
    here: Sequence[int],
    place: Placement,
) -> _Axis:
    """Return one coordinate of all recordings, on the rows that count there."""
    laws, rest, own, others, which = [], [], [], [], []
    motions = needing(linearisation)
    braking = _own_friction(linearisation, motions, place)
    for i, (motion, loop) in enumerate(zip(motions, linearisation.loops, strict=True)):
        back = np.linalg.inv(loop.reading.to_actuator)
        if place.location == "joint":
            back = back @ linearisation.model.transmission
        onto = back[:, place.index]
        rows = kept_rows(linearisation, i)
        rows = rows[loop.reading.counts[rows][:, np.abs(onto) > 1e-12].all(axis=1)]
        scale = np.where(data.weight[1] > 0.0, 1.0 / np.where(data.weight[1] > 0.0, data.weight[1], 1.0), 0.0)
        laws.append(np.einsum("knc,n->kc", acts[i][rows][:, :, here], scale * onto))
        rest.append(data.residual(i, found.simulated[i])[rows, 1] @ onto)
        position, speed, acceleration = motion.along(place)
        load = (motion.torque + braking[i]) @ (
            linearisation.model.transmission if place.location == "joint" else np.eye(len(onto))
        )
        known = dict(zip(_QUANTITIES, (position, speed, acceleration, load[:, place.index]), strict=True))
        own.append({q: x[rows] for q, x in known.items()})
        others.append(
            {f"position {j}": motion.position[rows, j] for j in range(len(onto)) if j != place.index}
        )
        which.append(np.full(len(rows), i))
    numbers = np.concatenate(which)
    others_of = {q: np.concatenate([o[q] for o in others]) for q in others[0]}
    return _Axis(
        np.concatenate(laws),
        np.concatenate(rest),
        {q: np.concatenate([o[q] for o in own]) for q in _QUANTITIES},
        {**others_of, "time": np.arange(len(numbers), dtype=float)},
        numbers,
    )


def _own_friction(
    linearisation: Linearisation, motions: Sequence[Motion], place: Placement
) -> list[np.ndarray]:
    """Return what the model's own damping and Coulomb friction at a place do in each recording (N, n).

    What a drive carries is weight and inertia: a load that holds the model's friction says what speed says.
    """
    own = [np.zeros_like(m.torque) for m in motions]
    for effect in (e for e in EFFECTS if e.search.basic and kinds.depends_on(e) == ("speed",)):
        size = model_value(effect, linearisation.model, place, {})
        if size:
            location = "joint" if place.location == "joint" else "actuator"
            key = EffectKey(effect.name, linearisation.model.axes[place.index], location)
            (column,) = linearisation.columns(key, {}, motions)[0]
            own = [torque + size * part for torque, part in zip(own, column.torque, strict=True)]
    return own


def _together(
    axes: Sequence[tuple[_Axis, list[EffectKey]]],
    applied: Sequence[AppliedEffect],
    alone: Mapping[EffectKey, Adequacy],
) -> dict[EffectKey, Adequacy]:
    """Return the adequacy of laws shared by joints of one design, against free functions on all of them at
    once.

    An unexplained residual on one axis does not weaken a law that has one size on all.
    """
    values = {a.key: a.parameters for a in applied}
    laws = [{kinds.depends_on(effect_named(k.effect)) for k in keys} - {()} for _, keys in axes]
    out: dict[EffectKey, Adequacy] = {}
    for own in set().union(*laws):
        there = [axes[i] for i, found in enumerate(laws) if own in found]
        keys = [k for _, keys in there for k in keys if kinds.depends_on(effect_named(k.effect)) == own]
        doubted = [k for k in keys if not alone[k].is_adequate]
        if len(there) < 2 or not doubted or any(alone[k].size <= 0.0 for k in doubted):
            continue
        parts = [
            np.array([kinds.depends_on(effect_named(k.effect)) == own for k in keys]) for _, keys in there
        ]
        law = np.concatenate([a.laws[:, p].sum(axis=1) for (a, _), p in zip(there, parts, strict=True)])
        rest = np.concatenate([a.laws[:, ~p].sum(axis=1) for (a, _), p in zip(there, parts, strict=True)])
        known = {q: np.concatenate([a.own[q] for a, _ in there]) for q in _QUANTITIES}
        joined = _Axis(
            np.column_stack([law, rest]),
            np.concatenate([a.rest for a, _ in there]),
            known,
            {},
            np.concatenate([np.full(len(a.rest), i) for i, (a, _) in enumerate(there)]),
        )
        found = replace(_of_law(joined, [own, ()], own), basic=_are_basic(keys))
        out |= {k: found for k in doubted if found.is_adequate and _agrees(k, keys, values, alone)}
    return out


def _agrees(
    key: EffectKey,
    alike: Sequence[EffectKey],
    values: Mapping[EffectKey, Mapping[str, Estimate]],
    alone: Mapping[EffectKey, Adequacy],
) -> bool:
    """Return whether an effect has the same size as on joints of one design; otherwise it may absorb another
    cause.
    """
    others = [values[k] for k in alike if k.effect == key.effect and k != key]
    for name, own in values[key].items():
        there = [o[name] for o in others]
        if not there:
            return False
        deviation = np.hypot(own.std, np.median([o.std for o in there])) + alone[key].spread * abs(own.value)
        if abs(own.value - np.median([o.value for o in there])) > INTERVAL * deviation:
            return False
    return True


def _of_axis(axis: _Axis, keys: Sequence[EffectKey]) -> dict[EffectKey, Adequacy]:
    """Return the adequacy of all effects at one coordinate; effects of the same quantities form one law."""
    depends = [kinds.depends_on(effect_named(k.effect)) for k in keys]
    found: dict[EffectKey, Adequacy] = {}
    for own in dict.fromkeys(d for d in depends if d):
        law = [k for k, d in zip(keys, depends, strict=True) if d == own]
        found |= dict.fromkeys(law, replace(_of_law(axis, depends, own), basic=_are_basic(law)))
    return found


def _are_basic(law: Sequence[EffectKey]) -> bool:
    return all(effect_named(key.effect).search.basic for key in law)


def _of_law(axis: _Axis, depends: Sequence[tuple[str, ...]], own: tuple[str, ...]) -> Adequacy:
    """The adequacy of the law of some quantities, whose parts are columns of the laws they depend on."""
    alike = np.array([d == own for d in depends])
    related = np.array([bool(set(d) & set(own)) for d in depends])
    law = axis.laws[:, alike].sum(axis=1)
    beside = {**{q: x for q, x in axis.own.items() if q not in own}, **axis.others}
    others = [splines([x], [x]) for x in beside.values() if np.ptp(x) > 0.0]
    quantities = [axis.own[q] for q in own]
    free = [(splines(quantities, quantities), axis.laws[:, related].sum(axis=1))]
    free += [((law[:, None] * basis, penalty), law) for basis, penalty in others]
    laws = np.column_stack([law, axis.laws[:, ~alike]])
    return against_free_functions(laws, axis.rest, free, others, axis.recording)
