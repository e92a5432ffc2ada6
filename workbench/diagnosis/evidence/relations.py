"""Relations of the residual torque to speed, its sign, load, position, reversals, acceleration, time and
heat.

Each relation alone is a least-squares fit of one quantity (or a sine and cosine of the position) to the
residual torque; how much it explains is held against the same residual with its blocks shuffled, which keeps
what neighbouring rows share and breaks the relation (P. Good, "Permutation, Parametric, and Bootstrap Tests
of Hypotheses", 3rd ed. 2005). The largest share over all relations of each shuffle counts, so that asking
many questions makes no answer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.units import torque_unit

from ..policy import POLICY
from .missing_torque import Missing

_BLOCK_S = 1.0  # and shuffled in blocks of this
_SHUFFLES = 199
_AFTER_S = 0.06  # what counts as just after a reversal
_ORDERS = range(1, 33)  # of a revolution


@dataclass(frozen=True)
class Relation:
    """The relation of the residual torque of an axis to one quantity.

    Attributes:
        quantity: in words.
        size: the residual's change with it, `unit`.
        share: of the residual's power that it explains.
        p: chance that shuffled blocks show as large a share in any quantity.
    """

    quantity: str
    size: float
    unit: str
    share: float
    p: float


@dataclass(frozen=True, eq=False)
class _Column:
    """A quantity along all recordings: its name and one or two columns (N, 1 or 2)."""

    quantity: str
    unit: str
    values: np.ndarray


def relations(missing: Missing, axis: str) -> tuple[Relation, ...]:
    """Return the one or two quantities with which the residual torque of an axis correlates most.

    Args:
        missing: see `missing_torque`.
        axis: name.

    Returns:
        At most two, the larger first; the second explains part of what the first leaves. Empty where
        nothing is significant against shuffled blocks.
    """
    block = round(_BLOCK_S / missing.step)
    k = missing.axes.index(axis)
    count = len(missing.torque) // block * block
    residual = missing.torque[:count, k]
    if count < 12 * block or not np.any(residual):
        return ()
    made = [(c, _orthonormal(c.values[:count])) for c in _columns(missing, k)]
    bases = [(c, b) for c, b in made if b is not None]
    rng = np.random.default_rng(0)
    orders = np.array([rng.permutation(count // block) for _ in range(_SHUFFLES)])
    found: list[Relation] = []
    while len(found) < 2 and bases:
        column, basis, share, p = _strongest(residual, bases, orders, block)
        if p > POLICY.relation_chance or share < (POLICY.relation_second if found else POLICY.relation_first):
            break
        found.append(Relation(column.quantity, _size(column, residual, count), column.unit, share, p))
        residual = residual - basis @ (basis.T @ residual)
        # a quantity that correlates with the first explains part of the same: only what is new in it counts
        bases = [(c, _without(b, basis)) for c, b in bases if c is not column]
    return tuple(found)


def relation_lines(axis: str, found: Sequence[Relation]) -> list[str]:
    """Return one line for each relation."""
    return [
        f"the residual torque at {axis} is proportional to {r.quantity}{_amount(r)}, which explains "
        f"{100 * r.share:.0f} % of {'it' if k == 0 else 'what is left'} (p {_chance(r.p)})"
        for k, r in enumerate(found)
    ]


def _amount(r: Relation) -> str:
    return f" (slope {r.size:.2g} {r.unit})".replace("-", "−") if np.isfinite(r.size) else ""


def _chance(p: float) -> str:
    return f"= {p:.2g}" if p > 1.5 / (_SHUFFLES + 1) else f"≤ {1 / (_SHUFFLES + 1):.2g}"


def _strongest(
    residual: np.ndarray, bases: Sequence[tuple[_Column, np.ndarray]], orders: np.ndarray, block: int
) -> tuple[_Column, np.ndarray, float, float]:
    """Return the quantity that explains most, its basis, its share, and the probability of such a share by
    chance.
    """
    power = float(residual @ residual)
    owner = np.repeat(np.arange(len(bases)), [b.shape[1] for _, b in bases])
    stacked = np.concatenate([b for _, b in bases], axis=1)
    shares = np.bincount(owner, (stacked.T @ residual) ** 2, len(bases)) / power
    best = int(np.argmax(shares))
    # a shuffle of the residual's blocks against all quantities: blocks times their correlation
    blocks = stacked.reshape(len(residual) // block, block, -1)
    products = np.einsum("blc,al->bac", blocks, residual.reshape(-1, block))  # block of basis, of residual
    places = np.arange(len(blocks))
    largest = np.array(
        [np.max(np.bincount(owner, products[places, order].sum(axis=0) ** 2, len(bases))) for order in orders]
    )
    chance = (1 + np.count_nonzero(largest / power >= shares[best])) / (1 + len(orders))
    return bases[best][0], bases[best][1], float(shares[best]), float(chance)


def _columns(m: Missing, k: int) -> list[_Column]:
    """Return the quantities of one axis, without each recording's mean."""
    unit = m.units[k]
    torque = torque_unit(unit)
    at, speed, load = m.position[:, k], m.speed[:, k], m.load[:, k]
    sign = np.tanh(speed / (0.02 * float(np.sqrt(np.mean(speed**2))) + 1e-12))
    per = f"{torque} per {torque}"
    columns = [
        _Column("the sign of speed", torque, sign[:, None]),
        _Column("speed", f"{torque} s/{unit}", speed[:, None]),
        _Column("the load", per, load[:, None]),
        _Column("load times the sign of speed", per, (np.abs(load) * sign)[:, None]),
        _Column("position", f"{torque}/{unit}", at[:, None]),
        _Column("the time just after reversals", torque, _after_reversals(sign, m)[:, None]),
        _Column("acceleration", f"{torque} s²/{unit}", m.acceleration[:, k, None]),
        _Column("time", f"{torque}/s", m.time[:, None]),
    ]
    if unit == "rad":
        columns += [
            _Column(
                f"a sine of position, {n} periods per revolution",
                torque,
                np.stack([np.cos(n * at), np.sin(n * at)], 1),
            )
            for n in _ORDERS
            if n * np.ptp(at) > POLICY.order_turn * 2 * np.pi
        ]
    if m.temperature is not None:
        columns.append(_Column("temperature", f"{torque}/K", m.temperature[:, k, None]))
    out = []
    for c in columns:
        parts = np.split(c.values, m.start[1:])
        out.append(_Column(c.quantity, c.unit, np.concatenate([p - p.mean(axis=0) for p in parts])))
    return out


def _after_reversals(sign: np.ndarray, m: Missing) -> np.ndarray:
    """Return the new sign of speed for some steps after each change, otherwise zero, (N,)."""
    steps = max(1, round(_AFTER_S / m.step))
    turned = np.flatnonzero(np.diff(np.sign(sign)) != 0) + 1
    out = np.zeros(len(sign))
    for k in turned:
        out[k : k + steps] = np.sign(sign[k : k + steps])
    return out


def _orthonormal(values: np.ndarray) -> np.ndarray | None:
    """Return an orthonormal basis of the span of columns; None if they are constant."""
    q, r = np.linalg.qr(values)
    scale = np.abs(np.diag(r))
    return q if scale.min() > 1e-9 * max(float(np.linalg.norm(values)), 1e-12) else None


def _without(basis: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the new part of a basis, orthonormal; zeros if there is none."""
    rest = basis - other @ (other.T @ basis)
    keep = np.linalg.norm(rest, axis=0) > POLICY.relation_new
    out = np.zeros_like(basis)
    if keep.any():
        out[:, keep] = np.linalg.qr(rest[:, keep])[0]
    return out


def _size(column: _Column, residual: np.ndarray, count: int) -> float:
    """Return the residual's slope with the quantity, or the amplitude of a sine."""
    slope = np.linalg.lstsq(column.values[:count], residual, rcond=None)[0]
    return float(slope[0]) if len(slope) == 1 else float(np.hypot(*slope))
