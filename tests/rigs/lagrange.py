"""The leg's equation of motion from masses and Jacobians by hand, to hold the rig against."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

THIGH, SHANK, CRANK, MOTOR1, MOTOR2, STAND = range(6)
NAMES = {"thigh": THIGH, "shank": SHANK, "crank": CRANK, "motor 1": MOTOR1, "motor 2": MOTOR2, "stand": STAND}
ROW = 1e-3  # s
HELD = 20  # rows for which a torque is held

#: Mass [kg], central inertia [kg m^2], angle, and mass centre as lengths [m] along the angles' directions.
BODIES = (
    (1.8, 0.012655833, THIGH, {THIGH: 0.08}),
    (0.23, 0.002381967, SHANK, {THIGH: 0.175, SHANK: 0.141006211}),
    (0.05, 0.0003, CRANK, {CRANK: -0.03}),
    (0.05, 0.000127604, THIGH, {CRANK: -0.06, THIGH: 0.0875}),
)
Body = tuple[float, float, int, Mapping[int, float]]


@dataclass(frozen=True)
class Leg:
    """Bodies, rotors and what lies between them.

    Attributes:
        free: names of the coordinates that move on their own, in order; others follow their neighbours.
        torque: generalised torque beyond gravity and inertia, of q (6,), v (6,), t -> (6,).
        stand: mass of the stand [kg].
        rotors: inertia of the rotors [kg m^2].
        bodies: as `BODIES`.
    """

    free: tuple[str, ...]
    torque: Callable[[np.ndarray, np.ndarray, float], np.ndarray]
    stand: float = 0.0
    rotors: tuple[float, float] = (0.0162, 0.0162)
    bodies: tuple[Body, ...] = BODIES
    spread: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        neighbour = {"crank": "shank", "motor 1": "thigh", "motor 2": "crank"}
        spread = np.zeros((6, len(self.free)))
        for name, index in NAMES.items():
            own: str | None = name
            while own is not None and own not in self.free:
                own = neighbour.get(own)
            if own is not None:
                spread[index, self.free.index(own)] = 1.0
        object.__setattr__(self, "spread", spread)

    def acceleration(self, q: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        """Of the free coordinates (n,), from all six."""
        mass, force = np.zeros((6, 6)), self.torque(q, v, t)
        mass[MOTOR1, MOTOR1], mass[MOTOR2, MOTOR2] = self.rotors
        mass[STAND, STAND] = self.stand
        for m, inertia, angle, reach in self.bodies:
            jacobian, curve = np.zeros((2, 6)), np.zeros(2)  # x, z
            jacobian[0, STAND] = 1.0
            for i, r in reach.items():
                jacobian[:, i] = r * np.array([np.cos(q[i]), np.sin(q[i])])
                curve += r * v[i] ** 2 * np.array([-np.sin(q[i]), np.cos(q[i])])
            mass += m * jacobian.T @ jacobian
            mass[angle, angle] += inertia
            force = force + jacobian.T @ (m * (np.array([0.0, -9.81]) - curve))
        s = self.spread
        return np.linalg.solve(s.T @ mass @ s, s.T @ force)

    def integrate(self, start: np.ndarray, rows: int) -> np.ndarray:
        """All six coordinates and speeds at every row (rows + 1, 12), from the free ones (2 n,); tightly.

        In stretches of `HELD` rows, because torques jump there.
        """
        n, s = len(self.free), self.spread

        def slope(t: float, y: np.ndarray) -> np.ndarray:
            return np.concatenate([y[n:], self.acceleration(s @ y[:n], s @ y[n:], t)])

        states = [np.asarray(start, float)[None]]
        for first in range(0, rows, HELD):
            times = np.arange(first, min(first + HELD, rows) + 1) * ROW
            times[-1] -= 1e-12
            solution = solve_ivp(
                slope, times[[0, -1]], states[-1][-1], "DOP853", times, rtol=1e-10, atol=1e-12
            )
            states.append(solution.y.T[1:])
        return np.array([np.concatenate([s @ y[:n], s @ y[n:]]) for y in np.concatenate(states)])
