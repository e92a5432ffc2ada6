"""Fitting a physical model to responses, each line weighted by its covariance, and judging what is left.

The maximum-likelihood estimate for circular complex normal errors: the sum over lines of d^H C^-1 d, with
d = vec(measured - model), is minimised by Levenberg-Marquardt within physical bounds. Pintelon and Schoukens
2012, ch. 9 (known noise model) and ch. 12 (sample covariances): covariances from few residuals widen the
parameters' intervals and raise the cost of a true model; both are allowed for.

Where more is left than noise leaves, the model lacks something, or the machine distorts in the same way every
period, which no covariance from periods shows. Lines are then weighted by what the model leaves there, so
that those which it cannot explain rule neither the parameters nor their intervals.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from workbench.core import Estimate, InputError
from workbench.frf.response import Frf
from workbench.frf.sampled import System, response, response_and_slopes
from workbench.frf.statistics import information_loss

from .judge import Judgement, judge
from .weights import weighted_by_rest, whitening, with_enough_residuals, without_band

_ROUNDS = 3  # of weighting lines by what is left
_BANDS = 12  # left out one by one where the model is not enough
_WORST = 10.0  # largest factor by which a line's few residuals count against it


@dataclass(frozen=True)
class Parameter:
    """One unknown: name, unit, physical bounds."""

    name: str
    unit: str
    low: float = -np.inf
    high: float = np.inf


@dataclass(frozen=True, eq=False)
class Fit:
    """A model fitted to one or several responses.

    Attributes:
        model: its name.
        parameters: name -> estimate; the deviation holds what noise does and, where the model is not
            adequate, what it leaves and how the parameters move from band to band.
        covariance: of the parameters, in their order, (p, p).
        frfs: what was fitted, with the covariances that weighted it.
        responses: of the model at each of these, (F, ny, nu).
        judgement: size and whiteness of what is left under the measured covariances.
        notes: what the reader should know.
    """

    model: str
    parameters: Mapping[str, Estimate]
    covariance: np.ndarray
    frfs: tuple[Frf, ...]
    responses: tuple[np.ndarray, ...]
    judgement: Judgement
    notes: tuple[str, ...] = ()

    @property
    def adequate(self) -> bool:
        """Return whether what is left is what noise leaves, in size and in whiteness."""
        return self.judgement.adequate

    @property
    def sentence(self) -> str:
        """Return the same in words."""
        return self.judgement.sentence


@dataclass(frozen=True, eq=False)
class Problem:
    """What is to be fitted.

    Attributes:
        model: its name.
        parameters: the unknowns.
        frfs: measured responses.
        systems: for each of these, unknowns (p,) (which may be complex) to a linear system.
        starts: first guesses, each (p,); the best end counts.
        notes: to be handed on.
    """

    model: str
    parameters: tuple[Parameter, ...]
    frfs: tuple[Frf, ...]
    systems: tuple[Callable[[np.ndarray], System], ...]
    starts: Sequence[np.ndarray]
    notes: tuple[str, ...] = ()


def solve(problem: Problem) -> Fit:
    """Fit, from every start, and judge the best end.

    Raises:
        InputError: fewer numbers than unknowns, or covariances that cannot be used.
    """
    numbers = sum(2 * f.response.size for f in problem.frfs)
    count = len(problem.parameters)
    if numbers <= count:
        remedy = "excite more lines, or fit a simpler model"
        raise InputError(f"{numbers} numbers for {count} parameters of {problem.model}", remedy=remedy)
    frfs = [with_enough_residuals(f) for f in problem.frfs]
    theta, jac, rest = _minimised(problem, frfs, problem.starts)
    judgement = judge(rest, frfs, problem.frfs, count)
    notes = list(problem.notes)
    if not judgement.size_fine:
        for _ in range(_ROUNDS):
            left = [g - f.response for g, f in zip(_responses(problem, theta), problem.frfs, strict=True)]
            frfs = [weighted_by_rest(f, d) for f, d in zip(problem.frfs, left, strict=True)]
            theta, jac, rest = _minimised(problem, frfs, [theta])
        notes.append("Lines are weighted by the model's residual there, not by noise alone.")
    inverse = np.linalg.pinv(jac.T @ jac, rcond=1e-14, hermitian=True)
    covariance = inverse @ (jac.T * _losses(frfs)) @ jac @ inverse
    if not judgement.adequate:
        covariance = covariance + _jackknife(problem, frfs, theta)
    return Fit(
        model=problem.model,
        parameters=_estimates(problem, theta, covariance),
        covariance=covariance,
        frfs=tuple(frfs),
        responses=tuple(_responses(problem, theta)),
        judgement=judgement,
        notes=(*notes, *_at_bounds(problem, theta)),
    )


def _minimised(
    problem: Problem, frfs: Sequence[Frf], starts: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray, list[np.ndarray]]:
    """The best end from all starts: unknowns (p,), Jacobian, weighted residuals (F, m) of each response."""
    whiten = [whitening(f) for f in frfs]
    low, high = (np.array([getattr(p, side) for p in problem.parameters]) for side in ("low", "high"))

    def left(theta: np.ndarray) -> np.ndarray:
        return np.concatenate([_real(r) for r in _residuals(problem, frfs, whiten, theta)[0]])

    def slopes(theta: np.ndarray) -> np.ndarray:
        blocks = _residuals(problem, frfs, whiten, theta)[1]
        return np.concatenate([np.stack([_real(column) for column in b], axis=1) for b in blocks])

    best = None
    for start in starts:
        # a little inside the bounds, on which no step can begin
        margin = 1e-6 * np.maximum(np.abs(start), 1e-9)
        inside = np.minimum(np.maximum(start, low + margin), high - margin)
        end = least_squares(
            left,
            inside,
            slopes,  # pyright: ignore[reportArgumentType]  (scipy's stub knows names of schemes only)
            bounds=(low, high),
            x_scale="jac",
            xtol=1e-10,
            ftol=1e-12,
            gtol=1e-12,
        )
        if np.isfinite(end.cost) and (best is None or end.cost < best.cost):
            best = end
    if best is None:
        raise InputError(
            f"the fit of {problem.model} fails from every start", remedy="give other first guesses"
        )
    return best.x, np.asarray(best.jac), _residuals(problem, frfs, whiten, best.x)[0]


def _real(values: np.ndarray) -> np.ndarray:
    """Real numbers of unit variance from circular complex ones of unit variance, flat."""
    return np.sqrt(2.0) * np.concatenate([values.real.ravel(), values.imag.ravel()])


def _responses(problem: Problem, theta: np.ndarray) -> list[np.ndarray]:
    return [
        response(system(theta), f.omega, f.hold_s)
        for system, f in zip(problem.systems, problem.frfs, strict=True)
    ]


def _residuals(
    problem: Problem, frfs: Sequence[Frf], whiten: Sequence[np.ndarray], theta: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Weighted residuals (F, m) of each response, and their derivatives (p, F, m)."""
    rest, slopes = [], []
    for frf, w, system in zip(frfs, whiten, problem.systems, strict=True):
        g, dg = response_and_slopes(system, theta, frf.omega, frf.hold_s)
        d = (g - frf.response).reshape(len(frf), -1)
        rest.append(np.einsum("fij,fj->fi", w, d))
        slopes.append(np.einsum("fij,pfj->pfi", w, dg.reshape(len(theta), len(frf), -1)))
    return rest, slopes


def _jackknife(problem: Problem, frfs: Sequence[Frf], theta: np.ndarray) -> np.ndarray:
    """Covariance of the unknowns by leaving out bands of neighbouring lines, (p, p)."""
    bands = min(_BANDS, min(len(f) for f in frfs) // 4)
    if bands < 3:
        return np.zeros((len(theta), len(theta)))
    ends = np.stack(
        [_minimised(problem, [without_band(f, k, bands) for f in frfs], [theta])[0] for k in range(bands)]
    )
    moves = ends - ends.mean(axis=0)
    return (bands - 1) / bands * moves.T @ moves


def _losses(frfs: Sequence[Frf]) -> np.ndarray:
    """What every weighted residual's own weight costs in certainty, in the order of `_real`."""
    parts = []
    for f in frfs:
        loss = np.minimum(information_loss(f.dof, f.wishart_size), _WORST)
        parts.append(np.tile(np.repeat(loss, f.covariance.shape[1]), 2))
    return np.concatenate(parts)


def _estimates(problem: Problem, theta: np.ndarray, covariance: np.ndarray) -> dict[str, Estimate]:
    deviation = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return {
        p.name: Estimate(float(v), float(s), p.unit)
        for p, v, s in zip(problem.parameters, theta, deviation, strict=True)
    }


def _at_bounds(problem: Problem, theta: np.ndarray) -> list[str]:
    """Parameters that lie where physics ends: their intervals are one-sided at best."""
    return [
        f"{p.name} lies at its physical bound."
        for p, v in zip(problem.parameters, theta, strict=True)
        if (np.isfinite(p.low) and v - p.low < 1e-6 * max(abs(v), 1e-6))
        or (np.isfinite(p.high) and p.high - v < 1e-6 * abs(p.high))
    ]
