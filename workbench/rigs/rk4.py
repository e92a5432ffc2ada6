"""One step of plain float code in time."""

from __future__ import annotations

from collections.abc import Callable

from .along import Vector
from .events import State

Rate = Callable[[Vector, Vector], Vector]


def rk4(rate: Rate, state: State, h: float) -> State:
    """Return the state after one classical Runge-Kutta step.

    Args:
        rate: acceleration (n,) of coordinates and speeds.
        state: before the step.
        h: [s].
    """
    q, v = state
    half, sixth = 0.5 * h, h / 6.0
    a = rate(q, v)
    w = [x + half * y for x, y in zip(v, a, strict=True)]
    b = rate([x + half * y for x, y in zip(q, v, strict=True)], w)
    r = [x + half * y for x, y in zip(v, b, strict=True)]
    c = rate([x + half * y for x, y in zip(q, w, strict=True)], r)
    s = [x + h * y for x, y in zip(v, c, strict=True)]
    d = rate([x + h * y for x, y in zip(q, r, strict=True)], s)
    return (
        [x + sixth * (k1 + 2.0 * (k2 + k3) + k4) for x, k1, k2, k3, k4 in zip(q, v, w, r, s, strict=True)],
        [x + sixth * (k1 + 2.0 * (k2 + k3) + k4) for x, k1, k2, k3, k4 in zip(v, a, b, c, d, strict=True)],
    )
