"""Small linear systems in a loop, and recordings of them; truth is known at every frequency."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.signal import lfilter

from workbench.core import Excitation, Recording
from workbench.frf import Design, multisine

#: A resonance with one row's delay: numerator and denominator in powers of 1/z.
PLANT = ((0.0, 0.05, 0.04), (1.0, -1.6, 0.8))
RATE = 500.0


def truth(frequency: np.ndarray, plant: tuple[tuple[float, ...], ...] = PLANT) -> np.ndarray:
    """Response of a plant at frequencies [Hz], (F,)."""
    back = np.exp(-2j * np.pi * np.asarray(frequency) / RATE)
    b, a = (np.polyval(c[::-1], back) for c in plant)
    return b / a


def siso_loop(
    reference: np.ndarray, noise: np.ndarray, gain: float, plant: tuple[tuple[float, ...], ...] = PLANT
) -> tuple[np.ndarray, np.ndarray]:
    """u = r - gain y, y = G u + e with white e: ``(u, y)``, exactly, each (N,)."""
    b, a = (np.array(c) for c in plant)
    closed = a + gain * b
    y = lfilter(b, closed, reference) + lfilter(a, closed, noise)
    return reference - gain * y, y


def recording(
    output: np.ndarray,
    input: np.ndarray,
    reference: np.ndarray | None = None,
    *,
    rate: float = RATE,
    design: Design | None = None,
    experiment: int = 0,
    **changes: Any,
) -> Recording:
    """A recording: velocity `output`, torque `input`, feedforward `reference`; each (N,) or (N, n)."""
    y, u = (np.asarray(x, float).reshape(len(output), -1) for x in (output, input))
    signals = {"position": np.cumsum(y, axis=0) / rate, "velocity": y, "torque_measured": u}
    if reference is not None:
        signals["torque_feedforward"] = np.asarray(reference, float).reshape(len(output), -1)
    n = y.shape[1]
    made = Recording(
        name=f"made_{experiment}",
        axes=tuple("abcdefghijklmnop"[:n]),
        coordinates="actuator",
        time=np.arange(len(y)) / rate,
        signals=signals,
        units=("rad",) * n,
        excitation=Excitation() if design is None else design.excitation(experiment),
    )
    return replace(made, **changes)


def design(**changes: Any) -> Design:
    """A multisine of one axis, 1 to 100 Hz in one second."""
    base: dict[str, Any] = {
        "f_min_hz": 1,
        "f_max_hz": 100,
        "period_s": 1.0,
        "rate_hz": RATE,
        "periods": 6,
        "transient_periods": 1,
    }
    return multisine(**{"axes": ["a"], **base, **changes})


def loop_recordings(
    d: Design, noise: float, gain: float = 0.0, seed: int = 0, keep_reference: bool = True
) -> list[Recording]:
    """A one-axis design played in the loop, one recording an experiment."""
    generator = np.random.default_rng(seed)
    out = []
    for e in range(len(d.trials)):
        r = d.play(e)[1]["torque_feedforward"][:, 0]
        u, y = siso_loop(r, noise * generator.normal(size=len(r)), gain)
        out.append(recording(y, u, r if keep_reference else None, design=d, experiment=e))
    return out


def mimo_plant(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A stable discrete state-space plant (a, b, c) with n inputs, n outputs and 2 n states."""
    generator = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(generator.normal(size=(2 * n, 2 * n)))
    poles = np.kron(np.diag(generator.uniform(0.6, 0.9, n)), [[0.8, -0.6], [0.6, 0.8]])
    return turn @ poles @ turn.T, generator.normal(size=(2 * n, n)), generator.normal(size=(n, 2 * n))


def mimo_truth(plant: tuple[np.ndarray, ...], frequency: np.ndarray) -> np.ndarray:
    """Its response, (F, n, n)."""
    a, b, c = plant
    z = np.exp(2j * np.pi * np.asarray(frequency) / RATE)
    return c @ np.linalg.solve(z[:, None, None] * np.eye(len(a)) - a, np.broadcast_to(b, (len(z), *b.shape)))


def mimo_recordings(
    d: Design, plant: tuple[np.ndarray, ...], noise: float, gain: float = 0.05, seed: int = 0
) -> list[Recording]:
    """A design played with the feedback u = r - gain y on every axis, one recording an experiment."""
    generator = np.random.default_rng(seed)
    a, b, c = plant
    count = len(d.trials)
    r = np.stack([d.play(e)[1]["torque_feedforward"] for e in range(count)])
    e = noise * generator.normal(size=r.shape)
    y, u = np.empty_like(r), np.empty_like(r)
    state = np.zeros((count, len(a)))
    for k in range(r.shape[1]):
        y[:, k] = state @ c.T + e[:, k]
        u[:, k] = r[:, k] - gain * y[:, k]
        state = state @ a.T + u[:, k] @ b.T
    return [recording(y[i], u[i], r[i], design=d, experiment=i) for i in range(count)]
