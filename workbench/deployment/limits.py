"""Limits that safety enforces: one array per axis, from a configuration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.can import CanConfig, make_drive

_SURE, _STEPS = 0.05, 4.0  # of the torque limit; steps of a frame's torque
_TICKS = 6  # of the same words
_EARLY = 1e-6  # s, so that whoever looks at the very moment does not miss it by rounding


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits in axis coordinates; every array (n,).

    Attributes:
        low, high: of position [rad].
        velocity: [rad/s]. torque: [N m]. torque_rate: [N m/s]. temperature: [deg C].
        kp, kd: largest gains that a drive takes [N m/rad, N m s/rad].
        damping: what an axis damps with [N m s/rad].
        notice: change of torque that a drive cannot but report [N m].
        stale_s: age of feedback at which everything damps [s].
        late_s: age of an action at which everything damps [s].
        soft_start_s: over which torque fades in [s].
        tilt: of the base against gravity, beyond which it has fallen [rad].
        watchdog_s: of the least patient drive [s].
        frozen_s: of the same words, after which they must not contradict themselves [s].
        overrun: by which a position may pass its limit before everything damps [rad].
    """

    low: np.ndarray
    high: np.ndarray
    velocity: np.ndarray
    torque: np.ndarray
    torque_rate: np.ndarray
    temperature: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    damping: np.ndarray
    stale_s: float
    late_s: float
    soft_start_s: float
    overrun: float = 0.05
    tilt: float = float("inf")
    notice: np.ndarray | float = float("inf")
    frozen_s: float = 0.018
    watchdog_s: float = float("inf")


def limits_of(config: CanConfig) -> Limits:
    """Return the limits of a configuration; feedback is stale after three periods, an action after two."""
    limits = [motor.limits for motor in config.motor]

    def each(name: str) -> np.ndarray:
        return np.array([getattr(limit, name) for limit in limits], float)

    period = config.loop.period_s
    steps = [
        0.0 if motor.reads_ranges else drive.torque_step
        for motor in config.motor
        if (drive := make_drive(motor))
    ]
    return Limits(
        low=np.array([limit.position[0] for limit in limits]),
        high=np.array([limit.position[1] for limit in limits]),
        velocity=each("velocity"),
        torque=each("torque"),
        torque_rate=each("torque_rate"),
        temperature=each("temperature"),
        kp=np.array([motor.ranges.kp for motor in config.motor]),
        kd=np.array([motor.ranges.kd for motor in config.motor]),
        damping=np.full(len(limits), config.loop.damping),
        stale_s=3 * period - _EARLY,
        late_s=2 * config.loop.policy_every * period,
        soft_start_s=config.loop.soft_start_s,
        notice=np.maximum(_SURE * each("torque"), _STEPS * np.array(steps)),
        watchdog_s=min(motor.watchdog_s for motor in config.motor),
        frozen_s=_TICKS * period - _EARLY,
        tilt=(config.imu.tilt if config.imu else None) or np.inf,
    )
