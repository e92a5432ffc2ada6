"""Drive positions as polynomials of joint positions, where the transmission changes with posture.

    q_p = f(q_s),   J(q_s) = d f / d q_s,   q_p' = J q_s',   tau_p = J^-T tau_s

in place of the constant J of the paper's Eq. 1. Beyond the box that the polynomials are of they go on
straight, so that a loop that strays still gets torques and angles that make sense. ``xp`` is `numpy` or
`torch`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

Array = Any
#: Newton's steps at most, and a step that is the last [rad or m]: the next would be its square.
NEWTON, THERE = 12, 1e-9


@dataclass(frozen=True, eq=False)
class DriveMap:
    """Polynomials of x = (q_s - middle) / half in a box.

    Attributes:
        middle, half: centre and half width of the box (n,) [rad or m].
        powers: of each x in each of K terms (K, n), whole numbers.
        factors: of the terms, a row per drive (n, K) [rad or m].
    """

    middle: np.ndarray
    half: np.ndarray
    powers: np.ndarray
    factors: np.ndarray

    @staticmethod
    def of(table: Mapping[str, Any]) -> DriveMap:
        """Return the map that `table` describes."""
        return DriveMap(
            np.array(table["middle"], float), np.array(table["half"], float),
            np.array(table["powers"], int), np.array(table["factors"], float),
        )  # fmt: skip

    def table(self) -> dict[str, Any]:
        """Return the map as JSON stores it."""
        return {name: getattr(self, name).tolist() for name in ("middle", "half", "powers", "factors")}

    def jacobian(self, joints: Array, xp: Any = np) -> Array:
        """Return the Jacobian J (..., n, n) at joint positions (..., n)."""
        return self._terms(self._inside(joints, xp), xp)[1]

    def drives(self, joints: Array, xp: Any = np) -> Array:
        """Return drive positions (..., n) at joint positions (..., n)."""
        inside = self._inside(joints, xp)
        value, slope = self._terms(inside, xp)
        return value + (slope @ (joints - inside)[..., None])[..., 0]

    def joints(self, drives: np.ndarray) -> np.ndarray:
        """Return joint positions (..., n) at drive positions (..., n), by Newton's method.

        Where the drives are where no joint can bring them, the best that the steps came to.
        """
        q = np.broadcast_to(self.middle, np.shape(drives)).astype(float)
        for _ in range(NEWTON):
            inside = self._inside(q, np)
            value, slope = self._terms(inside, np)
            off = value + (slope @ (q - inside)[..., None])[..., 0] - drives
            step = np.linalg.solve(slope, off[..., None])[..., 0]
            q = q - np.clip(step, -self.half, self.half)
            if np.abs(step).max(initial=0.0) < THERE:
                break
        return q

    def drive_torque(self, joints: Array, torque: Array, xp: Any = np) -> Array:
        """Return drive torques (..., n) equivalent to joint torques (..., n): J^-T tau_s [N m]."""
        return xp.linalg.solve(self.jacobian(joints, xp).mT, torque[..., None])[..., 0]

    def joint_speed(self, joints: np.ndarray, drives: np.ndarray) -> np.ndarray:
        """Return joint speeds (..., n) from drive speeds (..., n), at joint positions (..., n)."""
        return np.linalg.solve(self.jacobian(joints), drives[..., None])[..., 0]

    def _inside(self, joints: Array, xp: Any) -> Array:
        low, high = (
            self._put(self.middle - self.half, joints, xp),
            self._put(self.middle + self.half, joints, xp),
        )
        return xp.minimum(xp.maximum(joints, low), high)

    def _terms(self, joints: Array, xp: Any) -> tuple[Array, Array]:
        """Return drive positions (..., n) and J (..., n, n) inside the box."""
        half = self._put(self.half, joints, xp)
        x = (joints - self._put(self.middle, joints, xp)) / half
        most = int(self.powers.max(initial=0))
        ladder = [xp.ones_like(x)]
        for _ in range(most):
            ladder.append(ladder[-1] * x)
        n, factors, table = len(self.half), self._put(self.factors, joints, xp), xp.stack(ladder, -1)
        own = self.powers if xp is np else xp.as_tensor(self.powers, device=joints.device)
        parts = [table[..., k, own[:, k]] for k in range(n)]
        value = _product(parts) @ factors.T
        slopes = []
        for k in range(n):
            lower = table[..., k, (own[:, k] - 1).clip(0)] * own[:, k]
            others = [lower if i == k else part for i, part in enumerate(parts)]
            slopes.append((_product(others) @ factors.T) / half[k])
        return value, xp.stack(slopes, -1)

    def _put(self, values: np.ndarray, like: Array, xp: Any) -> Array:
        return values if xp is np else xp.as_tensor(values, dtype=like.dtype, device=like.device)


def _product(parts: list[Array]) -> Array:
    out = parts[0]
    for part in parts[1:]:
        out = out * part
    return out
