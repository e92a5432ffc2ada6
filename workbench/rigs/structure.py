"""The leg's equation of motion in closed form, with its five numbers read out of Drake.

A parallelogram's links move like a two-link arm in absolute angles, alpha = q2 - q1:

    [[M11, M12 cos alpha], [., M22]] a + M12 sin alpha (-v2^2, v1^2) = (-g1 sin q1, -g2 sin q2) + torque

Calling Drake a million times from Python is slow and this form is not, so the rig integrates this form.
Drake stays the source: the numbers are fitted to it over a grid of postures, and the whole form is checked
against it at random states before it is used.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from workbench.core import SimulationError
from workbench.mechanism import ClosedChain, Reduced

from .leg_file import leg_file

_TOLERANCE = 1e-9  # largest difference from Drake that counts as the same equation [SI]


@dataclass(frozen=True)
class LegStructure:
    """Inertia and gravity of the leg in actuator coordinates.

    Attributes:
        m11, m22: [kg m^2].
        m12: factor of cos alpha [kg m^2].
        g1, g2: gravity torque is -g sin q [N m].
    """

    m11: float
    m12: float
    m22: float
    g1: float
    g2: float

    def plus(self, **increments: float) -> LegStructure:
        """Return a copy with increments added, e.g. ``plus(m11=0.01)``."""
        values = {name: value + increments.pop(name, 0.0) for name, value in vars(self).items()}
        if increments:
            raise TypeError(f"no such coefficient: {', '.join(increments)}")
        return LegStructure(**values)

    def minus(self, other: LegStructure) -> LegStructure:
        """Return the difference of two structures."""
        return LegStructure(**{name: value - vars(other)[name] for name, value in vars(self).items()})

    def reduced_dynamics(self, q: np.ndarray, v: np.ndarray) -> Reduced:
        """Return the same as `ClosedChain.reduced_dynamics`, in closed form; `q`, `v` (2,) [rad, rad/s]."""
        alpha = q[1] - q[0]
        coupling = self.m12 * np.cos(alpha)
        mass = np.array([[self.m11, coupling], [coupling, self.m22]])
        bias = self.m12 * np.sin(alpha) * np.array([-(v[1] ** 2), v[0] ** 2])
        gravity = -np.array([self.g1, self.g2]) * np.sin(q)
        return Reduced(mass, bias, gravity)


@lru_cache(maxsize=64)
def leg_structure(payload: float = 0.0, longer: tuple[float, float] = (0.0, 0.0)) -> LegStructure:
    """Return the numbers of the reference leg, links only, from Drake.

    Args:
        payload: point mass [kg] at the foot, put into the Drake model.
        longer: length errors of thigh and shank [m], as `leg_file` explains.

    Raises:
        SimulationError: the closed form does not reproduce Drake.
    """
    with leg_file(longer) as file:
        return _from_drake(ClosedChain(file, payload=payload))


@lru_cache(maxsize=8)
def linkage_share(longer: tuple[float, float] = (0.0, 0.0)) -> LegStructure:
    """Return the part of crank and coupler, which drive the shank, in `leg_structure`; without the thigh.

    Everything is linear in the masses, so the leg with its shank twice as heavy tells the shank's share;
    crank and coupler have the rest, except of M11 and g1, which are taken as the thigh's.
    """
    with leg_file(longer, shank=2.0) as file:
        once = leg_structure(longer=longer)
        rest = once.minus(_from_drake(ClosedChain(file)).minus(once))
    return LegStructure(0.0, rest.m12, rest.m22, 0.0, rest.g2)


def _from_drake(chain: ClosedChain) -> LegStructure:
    structure = _identify(chain)
    _verify(structure, chain)
    return structure


def _identify(chain: ClosedChain) -> LegStructure:
    """Least squares of each coefficient over a grid of postures at rest."""
    postures = [np.array([a, b]) for a in (-1.2, -0.5, 0.4, 1.3) for b in (-1.0, 0.3, 1.1)]
    at_rest = [chain.reduced_dynamics(q, np.zeros(2)) for q in postures]
    mass = np.array([reduced.mass for reduced in at_rest])
    gravity = np.array([reduced.gravity for reduced in at_rest])
    cosine, sine = np.cos(np.diff(postures, axis=1)[:, 0]), np.sin(postures)
    g1, g2 = -np.sum(gravity * sine, axis=0) / np.sum(sine**2, axis=0)
    m12 = mass[:, 0, 1] @ cosine / (cosine @ cosine)
    m11, m22 = mass[:, 0, 0].mean(), mass[:, 1, 1].mean()
    return LegStructure(float(m11), float(m12), float(m22), float(g1), float(g2))


def _verify(structure: LegStructure, chain: ClosedChain) -> None:
    """Holds the closed form against Drake at fixed random states."""
    generator = np.random.default_rng(2024)
    for _ in range(20):
        q, v = generator.uniform(-1.5, 1.5, 2), generator.uniform(-20.0, 20.0, 2)
        drake, fast = chain.reduced_dynamics(q, v), structure.reduced_dynamics(q, v)
        pairs = zip(vars(drake).values(), vars(fast).values(), strict=True)
        worst = max(float(np.abs(a - b).max()) for a, b in pairs)
        if worst > _TOLERANCE:
            raise SimulationError(f"the closed form of the leg differs from Drake by {worst:.1e} at q = {q}")
