"""Phases of a multisine, and the crest factor that they give."""

from __future__ import annotations

import numpy as np

_ROUNDS = 400  # of clipping


def schroeder_phases(lines: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
    """Return phases that spread the power of a multisine evenly over its period.

    The group delay of a line grows with the power of the lines below it, so that the signal sweeps through
    its spectrum once per period. M. R. Schroeder, "Synthesis of low-peak-factor signals and binary sequences
    with low autocorrelation", IEEE Trans. Inf. Theory 16, 1970, eq. (10), here for lines that need not be
    neighbours.

    Args:
        lines: harmonics, ascending, shape (F,).
        amplitudes: of each line, shape (F,).

    Returns:
        Phases of the cosines [rad], shape (F,), the first zero.
    """
    power = np.asarray(amplitudes, float) ** 2
    share = np.cumsum(power) / power.sum()
    steps = np.diff(lines)
    # lines on a coarser grid repeat (up to the sign) within the period: they sweep once a repetition
    spacing = np.gcd.reduce(steps) if len(steps) else 1
    return np.concatenate([[0.0], -2 * np.pi * np.cumsum(steps / spacing * share[:-1])])


def low_crest_phases(lines: np.ndarray, amplitudes: np.ndarray, rows: int) -> np.ndarray:
    """Return phases with a lower crest factor than Schroeder's where lines are sparse or irregular.

    Clips the signal, keeps the phases that the clipped signal has, restores the amplitudes, again. E. Van der
    Ouderaa, J. Schoukens and J. Renneboog, "Peak factor minimization using a time-frequency domain swapping
    algorithm", IEEE Trans. Instrum. Meas. 37, 1988.

    Args:
        lines: harmonics, ascending, shape (F,).
        amplitudes: of each line, shape (F,).
        rows: samples per period.

    Returns:
        The best phases met [rad], shape (F,); never worse than Schroeder's.
    """
    # few samples a cycle of the highest line are enough, and make it fast
    grid = min(rows, 2 ** int(np.ceil(np.log2(16 * lines[-1]))))
    grid = grid if 2 * lines[-1] < grid else rows
    best = phases = schroeder_phases(lines, amplitudes)
    lowest = np.inf
    for k in range(_ROUNDS):
        signal = synthesise(lines, amplitudes * np.exp(1j * phases), grid)
        crest = float(crest_factor(signal))
        if crest < lowest:
            lowest, best = crest, phases
        # clip hard at first to get away from where we are, then ever less
        level = np.abs(signal).max() * (0.75 + 0.24 * k / _ROUNDS)
        phases = np.angle(np.fft.rfft(np.clip(signal, -level, level))[lines])
    return best


def random_phases(count: int, generator: np.random.Generator) -> np.ndarray:
    """Return independent phases, uniform on the circle [rad], shape (count,).

    With many lines the signal is close to Gaussian noise, for which the best linear approximation of a
    nonlinear system is defined (Pintelon and Schoukens 2012, ch. 3).
    """
    return generator.uniform(0, 2 * np.pi, count)


def synthesise(lines: np.ndarray, spectrum: np.ndarray, rows: int) -> np.ndarray:
    """Return one period of a sum of cosines.

    Args:
        lines: harmonics, each below rows / 2, shape (F,).
        spectrum: amplitude times exp(j phase) of each line, shape (..., F).
        rows: samples per period.

    Returns:
        Samples, shape (..., rows).
    """
    full = np.zeros((*spectrum.shape[:-1], rows // 2 + 1), complex)
    full[..., lines] = spectrum * (rows / 2)
    return np.fft.irfft(full, rows)


def crest_factor(signal: np.ndarray) -> np.ndarray:
    """Return the largest magnitude over the root mean square, along the last axis; 0 for a zero signal.

    A sine has 1.41, a Schroeder multisine with all lines about 1.7, one with random phases about 3 to 4.
    """
    signal = np.asarray(signal, float)
    rms = np.sqrt(np.mean(signal**2, axis=-1))
    return np.divide(np.abs(signal).max(axis=-1), rms, out=np.zeros_like(rms), where=rms > 0)
