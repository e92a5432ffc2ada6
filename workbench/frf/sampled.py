"""Frequency response of a linear system as a sampled log sees it: with the hold of its input, and a delay.

A command stands still from row to row, and rows are logged at once. Between the rows' sequences the exact
response is that of the zero-order-hold equivalent, for any delay; a plain C (j w - A)^-1 B e^(-j w T), fitted
to it, returns a delay that is half a row too long. K. J. Astrom and B. Wittenmark, "Computer-Controlled
Systems", 3rd ed. 1997, sec. 2.3 (systems with time delay).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

_STEP = 1e-25  # complex step: no difference is formed, so that it may be as small as it likes


@dataclass(frozen=True, eq=False)
class System:
    """x' = a x + b u(t - delay), y = c x: a (s, s), b (s, nu), c (ny, s), delay [s]."""

    a: np.ndarray
    b: np.ndarray
    c: np.ndarray
    delay: complex | float = 0.0


def second_order(
    inertia: np.ndarray,
    damping: np.ndarray,
    stiffness: np.ndarray,
    delay: complex | float,
    outputs: np.ndarray,
) -> System:
    """Return M q'' + D q' + K q = u(t - delay) as a `System`.

    Args:
        inertia, damping, stiffness: (n, n), real or complex.
        delay: [s].
        outputs: rows over (q, q'), (ny, 2 n).
    """
    n = len(inertia)
    inverse = np.linalg.inv(inertia)
    zero, one = np.zeros((n, n)), np.eye(n)
    a = np.block([[zero, one], [-inverse @ stiffness, -inverse @ damping]])
    return System(a, np.concatenate([zero, inverse]), outputs, delay)


def response(system: System, omega: np.ndarray, hold_s: float | None) -> np.ndarray:
    """Return the response at angular frequencies [rad/s], (F, ny, nu).

    Args:
        system: real.
        omega: below pi / hold_s where there is a hold, not zero where the system integrates.
        hold_s: how long the input stands still from each row on [s], rows of both signals being logged at
            this period; None for an input that is smooth between the rows.
    """
    return _Parts(system, hold_s).evaluate(omega)[0]


def response_and_slopes(
    system: Callable[[np.ndarray], System], theta: np.ndarray, omega: np.ndarray, hold_s: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Return the response of a system that depends on parameters, and its derivatives, exact to rounding.

    The matrices' derivatives come from complex steps through the (real) matrix functions, those of the
    response from the chain rule.

    Args:
        system: parameters (p,), which may be complex, to a `System`.
        theta: parameters, (p,).
        omega, hold_s: as `response`.

    Returns:
        ``(G, dG)``: (F, ny, nu) and (p, F, ny, nu).
    """
    base = _Parts(system(theta), hold_s)
    g, inverse, entry = base.evaluate(omega)
    state = inverse @ entry
    sense = base.c @ inverse
    slopes = np.empty((len(theta), *g.shape), complex)
    for p in range(len(theta)):
        moved = theta.astype(complex)
        moved[p] += 1j * _STEP
        d = _Parts(system(moved), hold_s, base.whole).imag(_STEP)
        drift = d.entry(omega) if hold_s is not None else d.b - 1j * omega[:, None, None] * d.late * base.b
        if hold_s is None:
            drift = drift * base.wait(omega)
        slopes[p] = d.c @ state + sense @ (d.phi @ state + drift)
    return g, slopes


class _Parts:
    """A system with its hold: transition, entries of the new and the old input, delay."""

    def __init__(self, system: System, hold_s: float | None, whole: int | None = None) -> None:
        self.hold, self.c, self.b = hold_s, np.asarray(system.c), np.asarray(system.b)
        self.late = system.delay
        self.whole = 0
        if hold_s is None:
            self.phi, self.new, self.old = np.asarray(system.a), self.b, np.zeros_like(self.b)
            return
        # the delay is `whole` rows and a part of one
        floor = int(np.floor(np.real(system.delay) / hold_s + 1e-9))
        self.whole = floor if whole is None else whole
        part = system.delay - self.whole * hold_s
        before, push_before = _held(system, part)
        after, self.new = _held(system, hold_s - part)
        self.phi, self.old = after @ before, after @ push_before

    def imag(self, step: float) -> _Parts:
        """Return the derivatives along a complex step."""
        out = object.__new__(_Parts)
        out.hold, out.whole = self.hold, self.whole
        for name in ("phi", "new", "old", "c", "b", "late"):
            setattr(out, name, np.imag(getattr(self, name)) / step)
        return out

    def wait(self, omega: np.ndarray) -> np.ndarray:
        """Return the continuous delay, (F, 1, 1)."""
        return np.exp(-1j * omega * np.real(self.late))[:, None, None]

    def entry(self, omega: np.ndarray) -> np.ndarray:
        """Return what enters the state, (F, s, nu)."""
        if self.hold is None:
            return self.b * self.wait(omega)
        back = np.exp(-1j * omega * self.hold)[:, None, None]
        return (self.new + self.old * back) * back**self.whole

    def evaluate(self, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the response (F, ny, nu), (z - phi)^-1 (F, s, s) and the entry (F, s, nu)."""
        z = 1j * omega if self.hold is None else np.exp(1j * omega * self.hold)
        inverse = np.linalg.inv(z[:, None, None] * np.eye(len(self.phi)) - self.phi)
        entry = self.entry(omega)
        return self.c @ inverse @ entry, inverse, entry


def _held(system: System, time: complex | float) -> tuple[np.ndarray, np.ndarray]:
    """Return the transition over a time, and what a held input adds during it."""
    s, nu = system.b.shape
    block = np.zeros((s + nu, s + nu), np.result_type(system.a, system.b, type(time)))
    block[:s, :s], block[:s, s:] = system.a, system.b
    out = expm(block * time)
    return out[:s, :s], out[:s, s:]
