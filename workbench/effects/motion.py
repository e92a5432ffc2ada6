"""A motion on which effects are evaluated: positions, speeds, accelerations, torques, at rows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from workbench.models import Model, Placement

from .lag import lagged_line

_ROWS = 10_000  # of all recordings, enough to see how a drive's torque is limited


@dataclass(frozen=True)
class Line:
    """The path of a command through the drives to the torque sensor, at N rows of n axes, actuator
    coordinates.

    Attributes:
        step: row step [s].
        command: ``torque_command`` as it stands at each row, (N, n).
        speed: of the drives, (N, n).
        delay: [s].
        limit, stall, no_load, lag: of the chain, (n,) each; infinite and zero where there is none.
        full_braking: whether torque against the motion keeps the stall torque.
        measured: what was measured at the tap, (N, n), or None.
    """

    step: float
    command: np.ndarray
    speed: np.ndarray
    delay: float
    limit: np.ndarray
    stall: np.ndarray
    no_load: np.ndarray
    full_braking: bool
    lag: np.ndarray
    measured: np.ndarray | None = None

    @property
    def off_command(self) -> np.ndarray | None:
        """Return the measured torque minus what the command becomes, (N, n); None if it was not measured."""
        return None if self.measured is None else self.measured - self.passed[0]

    @cached_property
    def passed(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the torque at the sensor: just after the time of each row, and its mean over the step, (N,
        n) each.
        """
        newer, older, fraction = late(self.command, self.step, self.delay)
        limits = torque_bounds(self.speed, self.limit, self.stall, self.no_load, self.full_braking)
        at = np.clip(older if fraction else newer, *limits)
        newer, older = np.clip(newer, *limits), np.clip(older, *limits)
        mean = (1.0 - fraction) * newer + fraction * older
        for i in np.flatnonzero(self.lag):
            at[:, i], mean[:, i] = lagged_line(older[:, i], newer[:, i], fraction, self.lag[i] / self.step)
        return at, mean


@dataclass(frozen=True)
class Contact:
    """Feet on the ground along N rows, F feet.

    Attributes:
        depth: of the foot in the ground as the model has it, (N, F) [m]; negative in the air.
        sinking: its rate, (N, F) [m/s].
        slip: speed along the ground of the point that touches, (N, F) [m/s].
        pressed: measured force of the ground on the foot, normal to it, (N, F) [N].
        dragged: size of the force along it, (N, F) [N].
        force_noise: standard deviation of a measured force [N]; `slip_noise`: of the slip [m/s].
    """

    depth: np.ndarray
    sinking: np.ndarray
    slip: np.ndarray
    pressed: np.ndarray
    dragged: np.ndarray
    force_noise: float
    slip_noise: float


@dataclass(frozen=True)
class LinkMotion:
    """The body of a joint, or a site, along N rows, world frame.

    Attributes:
        move, turn: Jacobians of its origin and of its rotation by q_p, (N, 3, n) each.
        rotation: its frame, (N, 3, 3).
        rise: acceleration of its origin, (N, 3) [m/s^2]; `spin_up`: of its rotation, (N, 3) [rad/s^2].
    """

    move: np.ndarray
    turn: np.ndarray
    rotation: np.ndarray
    rise: np.ndarray
    spin_up: np.ndarray


@dataclass(frozen=True)
class Motion:
    """N rows of n axes in actuator coordinates, SI, uniform step `step` [s].

    Attributes:
        position, velocity, acceleration: true motion of the drives, (N, n).
        torque: motor torque at the tap of ``torque_measured``, the mean over the row's step, (N, n).
        line: how the command came to be that torque.
        gain: the chain's gain behind the tap, (N, n): that of the motor, less what heat takes.
        known: where the torque that drives lack is known, (N, n): away from the ends, and where no dry
            friction of the model may hold.
        transmission: J with q_p = J q_s, (n, n).
        link: number of a serial joint -> motion of its body.
        site: name of a site -> its motion.
        required: motor torque at the tap that a model needs for this motion, (N, n).
        inertia: mass matrix of links and rotors, (N, n, n); `rotor`: inertia and damping of each drive's own
            rotor, (n,) each.
        momentum: momentum of the whole machine by the drives' speeds, (N, 3, n), and its mass [kg].
        law: number of a controller's axis -> torque command that its gains on position error and on
            velocity ask for, (2, N, n), actuator coordinates, held from tick to tick.
        gravity: (3,) [m/s^2].
        axis_units: ``rad`` or ``m`` per axis.
        contact: what feet do on the ground, where that was measured.
        leads: of the tendons of places, how long before a reversal dry friction turns [s]; none: it does not.
    """

    step: float
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    line: Line
    gain: np.ndarray
    known: np.ndarray
    transmission: np.ndarray
    link: Callable[[int], LinkMotion]
    site: Callable[[str], LinkMotion]
    required: Callable[[Model], np.ndarray]
    inertia: Callable[[], np.ndarray]
    rotor: tuple[np.ndarray, np.ndarray]
    momentum: Callable[[], tuple[np.ndarray, float]]
    law: Callable[[int], np.ndarray]
    gravity: np.ndarray
    axis_units: tuple[str, ...]
    contact: Contact | None = None
    leads: Mapping[str, float] = field(default_factory=dict)

    @property
    def command(self) -> np.ndarray:
        """Return ``torque_command`` at each row, (N, n), without the delay of the chain."""
        return self.line.command

    def along(self, place: Placement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position, speed and acceleration (N,) of the coordinate of a placement."""
        row = place.row @ np.linalg.inv(self.transmission)
        return self.position @ row, self.velocity @ row, self.acceleration @ row

    def sliding(self, place: Placement) -> np.ndarray:
        """Return the speed (N,) of the coordinate of a placement that dry friction acts against."""
        _, speed, acceleration = self.along(place)
        return speed + self.leads.get(place.tendon, 0.0) * acceleration


def torque_bounds(
    speed: np.ndarray, limit: np.ndarray, stall: np.ndarray, no_load: np.ndarray, full_braking: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Return lowest and highest torque of drives at a speed; arrays broadcast, infinite without a limit.

    What is left at a speed falls from the stall torque at rest to nothing at the no-load speed; with
    `full_braking`, only of the torque that drives the motion.
    """
    if not np.isfinite(stall).any():
        return -limit, limit
    with np.errstate(invalid="ignore"):  # infinity times zero where there is no such limit
        left = np.where(np.isfinite(stall), stall * np.clip(1.0 - np.abs(speed) / no_load, 0.0, 1.0), np.inf)
    if not full_braking:
        top = np.minimum(limit, left)
        return -top, top
    low, high = (np.where(side * speed > 0, left, stall) for side in (-1.0, 1.0))
    return -np.minimum(limit, low), np.minimum(limit, high)


def at_tap(motions: Sequence[Motion], axis: int) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """Return the inputs of the drive limits, some rows of all motions, (M,) each: commanded torque, speed,
    given torque.

    The last is None where torque was not measured.
    """
    part = slice(None, None, max(1, sum(len(m.position) for m in motions) // _ROWS))
    asked, speed, given = [], [], []
    for m in motions:
        newer, older, fraction = late(m.line.command, m.step, m.line.delay)
        asked.append((older if fraction else newer)[part, axis])
        speed.append(m.velocity[part, axis])
        given.append(None if m.line.measured is None else m.line.measured[part, axis])
    known = [g for g in given if g is not None]
    measured = np.concatenate(known) if len(known) == len(given) else None
    return np.concatenate(asked), np.concatenate(speed), measured


def held(command: np.ndarray, step: float, delay: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a command that is held from row to row, after a pure delay.

    Args:
        command: value from each row until the next, (..., N, n); zero before the first row.
        step: row step [s].
        delay: [s], not negative; any fraction of a step.

    Returns:
        ``(at, mean)``, each like `command`: the torque just after each row's time, and its mean over
        the step that follows (which gives a held torque's impulse exactly).
    """
    newer, older, fraction = late(command, step, delay)
    if fraction == 0.0:
        return newer, newer
    return older, (1.0 - fraction) * newer + fraction * older


def late(command: np.ndarray, step: float, delay: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Return a held command after a delay: the value in the later part of each step, the value before, and
    the duration.

    The last is a share of the step, 0 where nothing changes inside it.
    """
    steps = delay / step
    whole = int(np.floor(steps + 1e-9))
    fraction = max(steps - whole, 0.0) if steps - whole > 1e-9 else 0.0
    newer = _shift(command, whole)
    return newer, _shift(command, whole + 1) if fraction else newer, fraction


def _shift(values: np.ndarray, rows: int) -> np.ndarray:
    if rows == 0:
        return values
    out = np.zeros_like(values)
    out[..., rows:, :] = values[..., :-rows, :]
    return out
