"""Times the estimation of a 12-axis response against straightforward scipy loops that give the same numbers.

    python benchmarks/frf_speed.py                # 12 axes, 100 periods, 12 experiments
    python benchmarks/frf_speed.py --axes 2 --periods 10

Both get the same recordings in memory. The loops do what one writes first: one transform per period and
signal, one small inverse, one covariance per line. Two estimates are timed: plain averages of periods,
and noise read between the lines with leakage taken off, which is the default.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from scipy.fft import rfft as scipy_rfft

from workbench.core import Recording
from workbench.frf import estimate, multisine

T = TypeVar("T")
RATE = 500.0
ORDER = 2


def main() -> None:
    """Prints one line an estimate: seconds of ours, of the loop, and their ratio."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--axes", type=int, default=12)
    parser.add_argument("--periods", type=int, default=100)
    parser.add_argument("--period-s", type=float, default=1.0)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    recordings = made(arguments.axes, arguments.periods, arguments.period_s)
    numbers = sum(len(r) for r in recordings) * 2 * arguments.axes
    print(f"{arguments.axes} axes, {arguments.periods} periods, {numbers / 1e6:.1f} million samples")
    rows = round(arguments.period_s * RATE)
    known = np.arange(2, round(100 * arguments.period_s) + 1)
    for name, options, loop in ways(arguments.period_s, known):
        mine, frf = fastest(lambda o=options: estimate(recordings, **o), arguments.repeats)
        lines = np.round(frf.frequency * arguments.period_s).astype(int)
        theirs, (g, covariance) = fastest(
            lambda f=loop, k=lines: f(recordings, rows, k), 1 if arguments.axes > 4 else arguments.repeats
        )
        np.testing.assert_allclose(frf.response, g, rtol=1e-6, atol=1e-9 * np.abs(g).max())
        scale = np.abs(covariance).max()
        np.testing.assert_allclose(frf.covariance, covariance, rtol=1e-6, atol=1e-8 * scale)
        print(f"{name:20s} {mine:8.3f} s   loop {theirs:8.3f} s   {theirs / mine:6.1f} times faster")


def ways(period_s: float, lines: np.ndarray) -> list[tuple[str, dict[str, Any], Callable[..., Any]]]:
    """What is compared: its name, the options of `estimate`, and the loop that gives the same numbers."""
    same = {"transient_periods": 0, "reference": None, "period_s": period_s, "lines": lines}
    return [
        ("plain averages", {**same, "leakage": False}, plain_loop),
        ("noise between lines", {**same, "leakage": True}, line_loop),
    ]


def made(axes: int, periods: int, period_s: float) -> list[Recording]:
    """Experiments of coupled first-order axes with noise, one per axis."""
    names = [f"axis_{i + 1}" for i in range(axes)]
    d = multisine(
        names, f_min_hz=2 / period_s, f_max_hz=100, period_s=period_s, rate_hz=RATE, phases="random",
        periods=periods, transient_periods=0,
    )  # fmt: skip
    generator = np.random.default_rng(0)
    mix = np.eye(axes) + 0.1 * generator.normal(size=(axes, axes))
    out = []
    for e in range(axes):
        u = d.play(e)[1]["torque_feedforward"]
        spectrum = np.fft.rfft(d.experiments[e], axis=0)
        slow = 1 / (1 + 1j * np.arange(len(spectrum)) / (10 * period_s))
        y = np.fft.irfft(slow[:, None] * (spectrum @ mix.T), len(d.experiments[e]), axis=0)
        y = np.tile(y, (periods, 1)) + 0.1 * generator.normal(size=u.shape)
        out.append(
            Recording(
                name=d.trials[e].name,
                axes=tuple(names),
                coordinates="actuator",
                time=np.arange(len(u)) / RATE,
                signals={"position": y, "velocity": y, "torque_measured": u},
                units=("rad",) * axes,
                excitation=d.excitation(e),
            )
        )
    return out


def plain_loop(
    recordings: Sequence[Recording], rows: int, lines: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Response (F, n, n) and covariance from plain averages, one period, axis and line after another."""
    n, experiments = recordings[0].velocity.shape[1], len(recordings)
    periods = len(recordings[0]) // rows
    y = np.empty((experiments, periods, n, len(lines)), complex)
    u = np.empty_like(y)
    for e, r in enumerate(recordings):
        for p in range(periods):
            block = slice(p * rows, (p + 1) * rows)
            for i in range(n):
                y[e, p, i] = rfft(r.velocity[block, i])[lines] * 2 / rows
                u[e, p, i] = rfft(r.signals["torque_measured"][block, i])[lines] * 2 / rows
    g = np.empty((len(lines), n, n), complex)
    covariance = np.empty((len(lines), n * n, n * n), complex)
    for k in range(len(lines)):
        inverse = np.linalg.inv(u[..., k].mean(axis=1).T)
        g[k] = y[..., k].mean(axis=1).T @ inverse
        noise = np.zeros((n, n), complex)
        for e in range(experiments):
            v = y[e, :, :, k].T - g[k] @ u[e, :, :, k].T
            noise += np.cov(v) / experiments
        covariance[k] = np.kron(noise / periods, inverse.T @ inverse.conj())
    return g, covariance


def line_loop(recordings: Sequence[Recording], rows: int, lines: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same with leakage taken off and the noise read between the lines."""
    n, experiments = recordings[0].velocity.shape[1], len(recordings)
    size = len(recordings[0])
    periods = size // rows
    wide = min(max(2 * (periods - 1), 12), 48)
    means = np.empty((experiments, len(lines), 2 * n), complex)
    noises = np.empty((experiments, len(lines), 2 * n, 2 * n), complex)
    free = [b for b in range(1, (size - 1) // 2 + 1) if b % periods]
    for e, r in enumerate(recordings):
        signals = np.hstack([r.velocity, r.signals["torque_measured"]])
        spectrum = np.stack([rfft(column) * 2 / size for column in signals.T], axis=1)
        for k, line in enumerate(lines):
            here = line * periods
            first = min(max(int(np.searchsorted(free, here)) - wide // 2, 0), len(free) - wide)
            bins = np.array(free[first : first + wide])
            away = (bins - here) / np.abs(bins - here).max()
            basis = np.vander(away, ORDER + 1, increasing=True)
            fitted, *_ = np.linalg.lstsq(basis, spectrum[bins], rcond=None)
            rest = spectrum[bins] - basis @ fitted
            means[e, k] = spectrum[here] - fitted[0]
            wider = 1 + np.linalg.inv(basis.T @ basis)[0, 0]
            noises[e, k] = wider * periods * (rest.T @ rest.conj()) / (wide - ORDER - 1)
    g = np.empty((len(lines), n, n), complex)
    covariance = np.empty((len(lines), n * n, n * n), complex)
    for k in range(len(lines)):
        inverse = np.linalg.inv(means[:, k, n:].T)
        g[k] = means[:, k, :n].T @ inverse
        out = np.hstack([np.eye(n), -g[k]])
        noise = sum(out @ noises[e, k] @ out.conj().T for e in range(experiments)) / experiments
        covariance[k] = np.kron(noise / periods, inverse.T @ inverse.conj())
    return g, covariance


def rfft(signal: np.ndarray) -> np.ndarray:
    """Scipy's transform of one column."""
    return np.asarray(scipy_rfft(signal))


def fastest(run: Callable[[], T], repeats: int) -> tuple[float, T]:
    """Seconds of the fastest run, and what it gave."""
    best, result = np.inf, None
    for _ in range(repeats):
        start = time.perf_counter()
        result = run()
        best = min(best, time.perf_counter() - start)
    assert result is not None
    return best, result


if __name__ == "__main__":
    main()
