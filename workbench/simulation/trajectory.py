"""The true motion: the simulation, corrected by the measurement."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import Recording

#: Names in `Recording.extra` of the motion that a simulation made, where its sensors show another.
TRUE_MOTION = ("true_position", "true_velocity")
_SMOOTH = 15  # lines over which the spectrum of the correction is averaged


@dataclass(frozen=True)
class Track:
    """Position, velocity, acceleration at rows, each (N, n), actuator coordinates."""

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray


def smooth_track(
    measured: Recording,
    simulated: Recording | None,
    to_actuator: np.ndarray,
    position_std: np.ndarray,
    velocity_std: np.ndarray,
    band_hz: float | None = None,
) -> Track:
    """Return the estimated motion: a simulation plus the smoothed difference from the measurement.

    Position and velocity are fused by their noise at each frequency, and a Wiener filter keeps of the
    difference what stands above the noise. The smaller the difference, the less noise gets in: a right
    model leaves its own noise-free motion. Without a simulation the measurement itself is smoothed.
    What a simulation's sensors show is held against the measurement, the motion it made is corrected.

    Args:
        measured, simulated: recordings in the same coordinates; `simulated` None for no prior motion.
        to_actuator: positions of the recording to actuator coordinates, (n, n).
        position_std, velocity_std: sensor noise (n,), recording's coordinates; NaN velocity: not measured.
        band_hz: keep all of the acceleration up to this frequency, noise and what it hides, and fade it out
            over as much again; for what is filtered more tightly afterwards.
    """
    step = measured.period
    position_std = np.nan_to_num(position_std)  # of an axis that never moves nothing is known
    zero = np.zeros_like(measured.position)
    base_q = zero if simulated is None else np.nan_to_num(simulated.position)
    base_w = zero if simulated is None else np.nan_to_num(simulated.velocity)
    velocity = None if "velocity" in measured.derived else measured.get("velocity")
    dq, dw, da = np.empty_like(zero), np.empty_like(zero), np.empty_like(zero)
    for i in range(zero.shape[1]):
        rate = None if velocity is None or not np.isfinite(velocity_std[i]) else velocity[:, i] - base_w[:, i]
        dq[:, i], dw[:, i], da[:, i] = _fuse(
            measured.position[:, i] - base_q[:, i], rate, position_std[i], velocity_std[i], step, band_hz
        )
    if simulated is not None and TRUE_MOTION[0] in simulated.extra:
        base_q, base_w = (np.nan_to_num(simulated.extra[name]) for name in TRUE_MOTION)
    q, w = base_q + dq, base_w + dw
    a = np.gradient(base_w, step, axis=0) + da
    return Track(q @ to_actuator.T, w @ to_actuator.T, a @ to_actuator.T)


def _fuse(
    position: np.ndarray,
    velocity: np.ndarray | None,
    position_std: float,
    velocity_std: float,
    step: float,
    band_hz: float | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rows = len(position)
    pad = min(rows - 1, max(50, rows // 20))
    # an odd reflection about the ends keeps slope and value there; faded out, it leaves no step where the
    # Fourier transform joins the last row to the first, whose leakage would drown the noise
    centre = 0.5 * (position[0] + position[-1])
    fade, slope = _fade(rows, pad, step)
    away = _extend(position, pad) - centre
    long = away * fade
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(long), step)
    noise = np.full(len(omega), max(position_std, 1e-15) ** 2)
    spectrum = np.fft.rfft(long)
    if velocity is not None:
        from_rate = np.fft.rfft(_extend_even(velocity, pad) * fade + away * slope)
        weight = omega**2 * noise / max(velocity_std, 1e-15) ** 2
        integral = np.divide(from_rate, 1j * omega, out=np.zeros_like(from_rate), where=omega > 0)
        spectrum = (spectrum + weight * integral) / (1.0 + weight)
        noise = noise / (1.0 + weight)
    power = np.abs(spectrum) ** 2 / len(long)
    level = np.convolve(
        np.pad(power, _SMOOTH, mode="edge"), np.ones(2 * _SMOOTH + 1) / (2 * _SMOOTH + 1), "valid"
    )
    gain = np.clip(1.0 - noise / np.maximum(level, 1e-300), 0.0, 1.0)
    # a lone bin that noise lifted above its level is not motion
    gain = np.where(level < 1.5 * noise, 0.0, gain)
    gains = [gain, gain, gain]
    if band_hz is not None:
        part = np.clip(omega / (2.0 * np.pi * band_hz) - 1.0, 0.0, 1.0)
        gains[2] = np.cos(0.5 * np.pi * part) ** 2
    q, w, a = (
        np.fft.irfft(g * spectrum * (1j * omega) ** k, len(long))[pad : pad + rows]
        for k, g in enumerate(gains)
    )
    return q + centre, w, a


def _fade(rows: int, pad: int, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Weight 1 over the rows and falling smoothly to 0 over the reflections, and its slope [1/s]."""
    part = (np.arange(pad) + 1) / (pad + 1)
    rise, steep = np.sin(0.5 * np.pi * part) ** 2, 0.5 * np.pi * np.sin(np.pi * part) / ((pad + 1) * step)
    weight = np.concatenate([rise, np.ones(rows), rise[::-1]])
    return weight, np.concatenate([steep, np.zeros(rows), -steep[::-1]])


def _extend(x: np.ndarray, pad: int) -> np.ndarray:
    return np.concatenate([2 * x[0] - x[pad:0:-1], x, 2 * x[-1] - x[-2 : -pad - 2 : -1]])


def _extend_even(x: np.ndarray, pad: int) -> np.ndarray:
    return np.concatenate([x[pad:0:-1], x, x[-2 : -pad - 2 : -1]])


def joint_columns(m: mujoco.MjModel, joints: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return addresses of joints in qpos and qvel."""
    return (
        np.array([m.joint(name).qposadr[0] for name in joints]),
        np.array([m.joint(name).dofadr[0] for name in joints]),
    )


def interpolate(rows: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Return (len(rows), ...) values at ascending `rows`, interpolated at all rows 0..count-1."""
    at = np.arange(count)
    left = np.clip(np.searchsorted(rows, at, side="right") - 1, 0, len(rows) - 2)
    part = (at - rows[left]) / (rows[left + 1] - rows[left])
    part = part.reshape(-1, *([1] * (values.ndim - 1)))
    return values[left] * (1.0 - part) + values[left + 1] * part
