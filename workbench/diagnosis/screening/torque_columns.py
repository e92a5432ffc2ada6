"""Columns of the regression: what every effect would add to the torque, filtered as the residual is."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.comparison import nearest_in_time
from workbench.core import EffectKey
from workbench.effects import Compliance, OnGround, SignalStage, Values, effect_named, kinds, places
from workbench.models import Model, Placement, alike_axes

from ..data import Data
from ..fitting.normal_equations import Normal, scaled_inverse, total
from ..hypothesis import Fit
from .equations import Entry, limits_of
from .needed_torque import kept_rows, needing
from .propagation import propagate_sensitivities
from .screen import sizes_of, strength_of
from .sensitivity import Linearisation, SensitivityColumn
from .torque_regression import Regression

_BLOCK = 64  # columns that are filtered together


def regression_of(
    start: Fit, data: Data, wanted: Callable[[EffectKey], bool] = lambda key: True
) -> Regression:
    """Return a regression over all effects that are torques along the motion, in all places and shapes.

    Args:
        start: the model as it is.
        data: recordings that are replayed along their measured motion, and weights.
        wanted: whether an effect in a place is one of them.
    """
    model = start.hypothesis.model
    linearisation = Linearisation.of(model, data, start.simulated, len(data.recordings))
    columns: list[SensitivityColumn] = []
    entries: list[Entry] = []
    gains: list[Entry] = []
    motions, sizes = needing(linearisation), sizes_of(linearisation)
    for key in filter(wanted, places(model)):
        effect, place = effect_named(key.effect), Placement.of(model, key)
        acts = effect.stage in kinds.TORQUES and not isinstance(effect, Compliance | OnGround)
        if not acts or kinds.free_parameters(effect, model) == 0 or not data.replay.shows(key.effect):
            continue
        shapes = effect.parameters.shapes(linearisation.motions, model, place)
        if len(shapes) == 0:
            continue
        is_gain = effect.stage is SignalStage.MOTOR and _is_a_gain(key, linearisation, shapes[0])
        if is_gain and shapes[0]:
            continue
        repeats = effect.search.repeats
        kin = [a.values for a in model.effects if key.same_place(a.key)]
        for shape in shapes:
            if repeats and place and kin and not repeats(linearisation.motions, place, shape, kin):
                continue
            linear, fixed = linearisation.columns(key, shape, motions)
            if fixed is None and linear:
                numbers = list(range(len(columns), len(columns) + len(linear)))
                kind = gains if is_gain else entries
                kind.append(Entry(key, shape, numbers, None, strength_of(linear, sizes)))
                columns += linear
    own: dict[EffectKey, int] = {}
    for applied in model.effects:
        effect = effect_named(applied.key.effect)
        gives_way = isinstance(effect, Compliance)
        if (
            effect.stage in kinds.TORQUES
            and not gives_way
            and not kinds.by_finite_difference(effect)
            and effect.parameters
        ):
            own[applied.key] = len(columns)
            columns.append(linearisation.total(applied, applied.values))
    alike = _alike(entries, len(columns), model)
    rows = torque_rows(linearisation, columns, data, [[m.linear[0] for m in e.alike] for e in alike])
    held = rows.normals(range(data.training, len(linearisation.runs)) if data.tests_on_holdout else ())
    limits = {entry: limits_of(linearisation.model, entry) for entry in (*entries, *gains)}
    return Regression(
        linearisation,
        tuple(entries),
        tuple(gains),
        own,
        rows.folds(data),
        tuple(total(own) for own in zip(*held, strict=True)) if held else None,
        data.least()[1] * data.weight[1] ** 2,
        data.least(data.tests_on_holdout)[1] * data.weight[1] ** 2,
        limits | {e: _common([limits[m] for m in e.alike]) for e in alike},
        alike,
    )


@dataclass(frozen=True, eq=False)
class TorqueRows:
    """What columns add to the torque, and the residual torque, on the rows of each recording that are kept.

    Attributes:
        rows: numbers of the rows, (M,) per recording.
        columns: weighted and filtered, (M, n, C) per recording.
        residuals: weighted, (M, n) per recording.
    """

    rows: list[np.ndarray]
    columns: list[np.ndarray]
    residuals: list[np.ndarray]

    def normals(self, recordings: Iterable[int]) -> list[tuple[Normal, ...]]:
        """Return the normal equations of each axis, of some recordings."""
        return [_by_axis(self.columns[i], self.residuals[i]) for i in recordings]

    def folds(self, data: Data) -> tuple[tuple[Normal, ...], ...]:
        """Return the normal equations of each axis, fold by fold."""
        out = []
        for fold in data.folds:
            i, whole = fold.recording, np.zeros(len(data.recordings[fold.recording]), bool)
            whole[fold.rows] = True
            own = whole[self.rows[i]]
            out.append(_by_axis(self.columns[i][own], self.residuals[i][own]))
        return tuple(out)


def torque_rows(
    linearisation: Linearisation,
    columns: Sequence[SensitivityColumn],
    data: Data,
    together: Sequence[Sequence[int]] = (),
) -> TorqueRows:
    """Return columns and residual torque along the motions, without what a log's lateness takes up of them.

    `together`: numbers of columns whose sum is a further column each.
    """
    rows = [kept_rows(linearisation, i) for i in range(len(linearisation.runs))]
    pieces = [
        np.concatenate([x, *(x[..., list(own)].sum(-1, keepdims=True) for own in together)], -1)
        for x in _filtered(linearisation, columns, rows, data)
    ]
    residuals = [
        (data.residual(i, run) * data.weight)[own, 1]
        for i, (own, run) in enumerate(zip(rows, linearisation.runs, strict=True))
    ]
    _timed(linearisation, rows, pieces, residuals, data)
    return TorqueRows(rows, pieces, residuals)


def _filtered(
    linearisation: Linearisation, columns: Sequence[SensitivityColumn], rows: Sequence[np.ndarray], data: Data
) -> list[np.ndarray]:
    """Return what columns add to the torque of each recording, filtered, on some of its rows (M, n, C)."""
    out = [[np.zeros((len(own), linearisation.model.size, 0))] for own in rows]
    for k in range(0, len(columns), _BLOCK):
        (parts,) = propagate_sensitivities([linearisation], [columns[k : k + _BLOCK]], data)
        for there, part, own in zip(out, parts, rows, strict=True):
            there.append(part[own, 1])
    return [np.concatenate(there, axis=-1) for there in out]


def _timed(
    linearisation: Linearisation,
    rows: Sequence[np.ndarray],
    pieces: Sequence[np.ndarray],
    rests: Sequence[np.ndarray],
    data: Data,
) -> None:
    """Take what a shift of the torque in time would take up off columns (M, n, C) and residuals (M, n).

    A log may show its torque late by a part of a row. By how much is told beside all laws that may be
    missing: a weight that is wrong looks like many rows. What is many rows beside them is no part of the log.
    All recordings of a machine show it alike, and a slow one alone hardly tells it.
    """
    weight = data.weight[1]
    beyond = [loop.beyond_time() for loop in linearisation.loops]
    whole, late = (
        [x[own] * weight for x, own in zip(part, rows, strict=True)] for part in zip(*beyond, strict=True)
    )
    for axis in range(linearisation.model.size):
        there = [i for i, own in enumerate(late) if own[:, axis].any()]
        if not there:
            continue
        own, y = (np.concatenate([part[i][:, axis] for i in there]) for part in (late, whole))
        x = np.concatenate([pieces[i][:, axis] for i in there])
        both = np.column_stack([own, x[:, np.any(x, axis=0)]])
        shift = (scaled_inverse(both.T @ both) @ (both.T @ y))[0]
        for i in there if shift == nearest_in_time(shift) else ():
            own, x = late[i][:, axis], pieces[i][:, axis]
            rests[i][:, axis] = whole[i][:, axis] - own * (own @ whole[i][:, axis] / (own @ own))
            x -= own[:, None] * (own @ x / (own @ own))


def _alike(entries: Sequence[Entry], first: int, model: Model) -> tuple[Entry, ...]:
    """Return the basic effects of drives that joints of one design share, with columns from `first` on."""
    drives = {
        (e.key.effect, e.key.axis): e
        for e in entries
        if effect_named(e.key.effect).search.basic and e.key.location == "actuator" and len(e.linear) == 1
    }
    out: list[Entry] = []
    for effect in dict.fromkeys(effect for effect, _ in drives):
        for axes in alike_axes(model):
            own = tuple(drives[effect, axis] for axis in axes if (effect, axis) in drives)
            if len(own) > 1:
                numbers = [first + len(out)]
                out.append(replace(own[0], linear=numbers, strength=max(e.strength for e in own), alike=own))
    return tuple(out)


def _common(limits: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Return the bounds that all of some coefficients keep."""
    return np.max([low for low, _ in limits], axis=0), np.min([high for _, high in limits], axis=0)


def _is_a_gain(key: EffectKey, linearisation: Linearisation, shape: Values) -> bool:
    """Whether an effect scales the measured torque: scaling it down always shrinks the residual as well."""
    effect, place = effect_named(key.effect), Placement.of(linearisation.model, key)
    idle = replace(linearisation.motions[0], torque=np.zeros_like(linearisation.motions[0].torque))
    return not np.any(effect.response(idle, linearisation.model, place, shape).columns)


def _by_axis(columns: np.ndarray, residual: np.ndarray) -> tuple[Normal, ...]:
    """Return normal equations of each axis, from columns (N, n, C), most of which act on one axis, and
    residuals (N, n).
    """
    out = []
    for k in range(residual.shape[1]):
        x, y = columns[:, k], residual[:, k]
        there = np.flatnonzero(np.any(x, axis=0))
        gram, right = np.zeros((x.shape[1],) * 2), np.zeros(x.shape[1])
        own = x[:, there]
        gram[np.ix_(there, there)], right[there] = own.T @ own, own.T @ y
        out.append(Normal(gram, right, float(y @ y), len(y)))
    return tuple(out)
