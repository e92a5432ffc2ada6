"""Least squares over bodies that can exist, as close to those of a file as the data allow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.solvers import ClarabelSolver, MathematicalProgram

from workbench.core import SimulationError
from workbench.diagnosis import Normal, total

from .rigid_body import DIRECTIONS

_LEAST = 0.05  # of what the file says, that a link keeps in each direction
TRUSTS = tuple(
    np.logspace(-1.0, 7.0, 17)
)  # in the file: one over the variance of a step, where noise has one of 1
_RIDGE = 1e-9  # of a column's square: holds what no motion shows


@dataclass(frozen=True, eq=False)
class PossibleFit:
    """A fit of links, and of other unknowns before them.

    Attributes:
        whole: unknowns from all blocks, (C,).
        each: with each block left out of the fit, (B, C).
        covariance: of the unknowns, if a file is wrong by one step in each direction, (C, C).
        left: squares on the blocks that were left out.
        trust: in the file, that was chosen.
    """

    whole: np.ndarray
    each: np.ndarray
    covariance: np.ndarray
    left: float
    trust: float

    def identifiable(self, first: int) -> float:
        """Return how many combinations of the steps from unknown `first` on the data give."""
        return len(self.whole) - first - float(np.trace(self.covariance[first:, first:]))


def fit_possible(
    blocks: Sequence[Normal],
    held: np.ndarray,
    starts: Sequence[np.ndarray],
    trusts: Sequence[float] = TRUSTS,
) -> PossibleFit:
    """Return the fit whose trust in the file predicts blocks that are left out best.

    Args:
        blocks: normal equations of blocks of rows, in units of the noise.
        held: 1 where the file has an unknown's value, which is 0; otherwise 0, (C,).
        starts: as in `nearest_possible`.
        trusts: of which the best is chosen.

    Raises:
        SimulationError: the solver finds no solution.
    """
    everything = total(blocks)
    size = np.diag(everything.gram)
    ridge = _RIDGE * np.where(size > 0.0, size, 1.0)
    best: tuple[float, float, list[np.ndarray]] | None = None
    for trust in trusts if np.any(held) else (0.0,):
        prior = np.diag(ridge + trust * held)
        each = [nearest_possible(r.gram + prior, r.right, starts) for r in (everything - b for b in blocks)]
        left = sum(b.after(x) for b, x in zip(blocks, each, strict=True))
        if best is None or left < best[0]:
            best = left, float(trust), each
    assert best is not None
    left, trust, each = best
    whole = nearest_possible(everything.gram + np.diag(ridge + trust * held), everything.right, starts)
    noise = max(left / everything.samples, 1.0)
    covariance = np.linalg.inv(everything.gram / noise + np.diag(ridge / noise + held))
    return PossibleFit(whole, np.stack(each), covariance, left, trust)


def nearest_possible(gram: np.ndarray, right: np.ndarray, starts: Sequence[np.ndarray]) -> np.ndarray:
    """Return the minimum of x' gram x / 2 - right' x over bodies that can exist, (C,).

    Args:
        gram: positive definite, (C, C).
        right: (C,).
        starts: pseudo-inertia (4, 4) of each link that belongs to steps of zero. The last unknowns are the
            steps of these links, ten each; the first ones may be anything.

    Raises:
        SimulationError: the solver finds no solution.
    """
    size = np.sqrt(np.diag(gram))
    scaled = gram / np.outer(size, size)
    free = np.linalg.solve(scaled, right / size) / size
    first, count = len(right) - len(DIRECTIONS) * len(starts), len(DIRECTIONS)
    steps = free[first:].reshape(len(starts), count)
    bodies = [start + np.tensordot(step, DIRECTIONS, 1) for start, step in zip(starts, steps, strict=True)]
    if all(np.linalg.eigvalsh(body)[0] >= _LEAST for body in bodies):
        return free
    program: Any = MathematicalProgram()
    more = program.NewContinuousVariables(len(right))
    program.AddQuadraticCost(scaled, np.zeros(len(right)), more, is_convex=True)
    for k, body in enumerate(bodies):
        own = slice(first + count * k, first + count * (k + 1))
        unit = [d / s for d, s in zip(DIRECTIONS, size[own], strict=True)]
        program.AddLinearMatrixInequalityConstraint([body - _LEAST * np.eye(4), *unit], more[own])
    found = ClarabelSolver().Solve(program)
    if not found.is_success():
        raise SimulationError(f"no bodies that can exist were found ({found.get_solution_result().name})")
    return free + found.GetSolution(more) / size
