"""Which combinations of a tree's parameters its joint torques can show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .tree import SerialTree

_SEED, _MOTIONS = 7, 200
_NONE = 1e-9  # a share that is nothing but rounding


@dataclass(frozen=True)
class BaseParameters:
    """The smallest set of parameters with the same torques: ``Y @ parameters == Y[:, columns] @ values``.

    Attributes:
        names: what each stands for, e.g. ``thigh.Iyy + 0.0306 shank.m``, length b.
        columns: the regressor's columns that stay, (b,).
        combination: (b, p), with ``values = combination @ parameters``.
    """

    names: tuple[str, ...]
    columns: np.ndarray
    combination: np.ndarray


def base_parameters(tree: SerialTree, tolerance: float = 1e-9) -> BaseParameters:
    """Numerical base parameters by QR over random motions: a column that depends on those before it goes.

    Source: Gautier, "Numerical calculation of the base inertial parameters of robots", J. Robotic Systems
    8(4), 1991.

    Args:
        tree: the tree.
        tolerance: diagonal of R, relative to its largest, below which a column depends on the others.
    """
    generator = np.random.default_rng(_SEED)
    q, v, a = (generator.uniform(-2.0, 2.0, (_MOTIONS, tree.size)) for _ in range(3))
    stacked = tree.regressor(q, v, a).reshape(-1, len(tree.parameter_names))
    diagonal = np.abs(np.diag(np.linalg.qr(stacked, mode="r")))
    columns = np.flatnonzero(diagonal > tolerance * diagonal.max())
    combination = np.linalg.lstsq(stacked[:, columns], stacked, rcond=None)[0]
    combination[np.abs(combination) < _NONE] = 0.0
    names = tuple(
        _name(row, int(c), tree.parameter_names) for row, c in zip(combination, columns, strict=True)
    )
    return BaseParameters(names, columns, combination)


def _name(row: np.ndarray, own: int, names: tuple[str, ...]) -> str:
    text = names[own]
    for c in np.flatnonzero(row):
        if c != own:
            size = "" if np.isclose(abs(row[c]), 1.0) else f"{abs(row[c]):.4g} "
            text += f" {'+' if row[c] > 0 else '-'} {size}{names[c]}"
    return text
