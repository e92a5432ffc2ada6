"""Whether a mass, or a constant torque, is certain although something else is unknown.

A mass is a law of all axes that move it. Nobody knows the mean of an unknown torque, so that a constant one
is certain only where nothing else is unknown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..data import Data
from ..evidence.shape import splines
from ..hypothesis import Fit
from ..policy import POLICY
from ..screening.needed_torque import kept_rows
from ..screening.sensitivity import Linearisation
from .free_functions import Adequacy, Free, against_free_functions


@dataclass(frozen=True, eq=False)
class MultiAxisLaw:
    """The coordinates on which a law acts, row by row: laws (M, A, E) with this law first, residual and
    motion (M, A).

    `links`: (M, A, L), what errors of the links' own masses do there, where these are another explanation.
    `noise`: (A,), mean squares of the rest that noise makes.
    """

    laws: np.ndarray
    links: np.ndarray
    rest: np.ndarray
    noise: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    recording: np.ndarray


def multi_axis_law(
    linearisation: Linearisation,
    found: Fit,
    data: Data,
    acts: Sequence[np.ndarray],
    which: int,
    count: int,
) -> MultiAxisLaw:
    """Return the torque that a mass needs from all drives that move it; the first `count` of `acts` form one
    law, others are links.
    """
    rows = [kept_rows(linearisation, i) for i in range(len(linearisation.runs))]
    columns = np.concatenate([part[own] for part, own in zip(acts, rows, strict=True)])
    power = np.sum(columns[:, :, which] ** 2, axis=0)
    axes = np.flatnonzero(power > POLICY.mass_acts * power.sum())
    order = [which, *(k for k in range(count) if k != which and columns[:, axes, k].any())]
    rest = [
        (data.residual(i, run)[own, 1] * data.weight[1])[:, axes]
        for i, (run, own) in enumerate(zip(found.simulated, rows, strict=True))
    ]
    motions = list(zip(linearisation.motions, rows, strict=True))
    return MultiAxisLaw(
        columns[:, axes][:, :, order],
        columns[:, axes][:, :, count:],
        np.concatenate(rest),
        (data.least()[1] * data.weight[1] ** 2)[axes],
        np.concatenate([m.position[own][:, axes] for m, own in motions]),
        np.concatenate([m.velocity[own][:, axes] for m, own in motions]),
        np.concatenate([m.acceleration[own][:, axes] for m, own in motions]),
        np.concatenate([np.full(len(own), i) for i, own in enumerate(rows)]),
    )


def adequacy_of_mass(s: MultiAxisLaw) -> Adequacy:
    """Return the adequacy of a law on several coordinates, decided by positions and accelerations, or by a
    constant.
    """
    if _is_constant(s.laws[:, :, 0]) and (np.mean(s.rest**2, axis=0) > POLICY.at_noise * s.noise).any():
        return Adequacy(0.0, 0.0, 0.0)
    count, axes = s.rest.shape
    time = np.repeat(np.arange(count, dtype=float)[:, None], axes, axis=1)

    def apart(values: np.ndarray) -> Free:
        """Return one free function for each coordinate, of its own quantity (M, A)."""
        bases, penalties = zip(*(splines([x], [x]) for x in values.T), strict=True)
        sizes = np.cumsum([0, *(b.shape[1] for b in bases)])
        whole, penalty = np.zeros((count, axes, sizes[-1])), np.zeros((sizes[-1],) * 2)
        for k, (basis, own) in enumerate(zip(bases, penalties, strict=True)):
            part = slice(sizes[k], sizes[k + 1])
            whole[:, k, part], penalty[part, part] = basis, own
        return whole.reshape(count * axes, -1), penalty

    law, rest = s.laws[:, :, 0].ravel(), s.rest.ravel()
    varying = [apart(x) for x in (s.speed, time)]
    free = [(apart(s.position), law), *(((law[:, None] * basis, p), law) for basis, p in varying)]
    if s.links.any():
        basis = s.links[:, :, s.links.any(axis=(0, 1))].reshape(count * axes, -1)
        basis = basis / np.sqrt(np.mean(basis**2, axis=0))
        free.append(((basis, np.eye(basis.shape[1])), law))
    beside = [apart(x) for x in (s.speed, s.acceleration, time)]
    return against_free_functions(
        s.laws.reshape(count * axes, -1), rest, free, beside, np.repeat(s.recording, axes)
    )


def _is_constant(law: np.ndarray) -> bool:
    """Whether a law is one constant torque wherever it has weight; variation below a tie is ignored."""
    acting = law[law != 0.0]
    return len(acting) > 0 and float(np.std(acting)) < POLICY.tie * abs(float(np.mean(acting)))
