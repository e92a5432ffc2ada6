"""The user's own machine as virtual hardware: with its loop and its sensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp

import numpy as np

from workbench.core import Excitation, InputError, Recording

from .machine import Encoder, unmeasured
from .own_drives import OwnDrives
from .own_links import OwnLinks, reachable
from .own_machine import HiddenIn, OwnMachine, hide
from .own_motion import OwnMotion, refuse_runaway
from .virtual_leg import Sensors

_PIECE, _FINE = 0.5e-3, 0.25e-3  # s, at most; with springs and gaps the finer


@dataclass(frozen=True)
class OwnExperiment:
    """One run: commands for n axes, row by row.

    Attributes:
        name: of the recording.
        reference: in the loop's own coordinates (N, n) [rad or m], or None without a loop.
        feedforward: torque on top, at the drives (N, n) [N m].
        excitation: what it is.
        period: of the rows [s].
    """

    name: str
    reference: np.ndarray | None
    feedforward: np.ndarray
    excitation: Excitation
    period: float = 1e-3


class OwnRig:
    """Virtual hardware of a machine.

    Args:
        machine: as its files say that it is; what is hidden is put into it.
        hidden: effects that it has beyond that.
        seed: of all noise and random disturbances; run k of a call draws from (seed, k).
        sensors: noise and resolution.

    Raises:
        InputError: an effect that this machine cannot hide, or a mechanism that cannot be read.
    """

    def __init__(
        self,
        machine: OwnMachine,
        hidden: Sequence[HiddenIn] = (),
        seed: int = 0,
        sensors: Sensors | None = None,
    ) -> None:
        for effect in hidden:
            hide(effect, machine)
        self.machine, self.seed, self.sensors = machine, seed, sensors or Sensors()
        self.links = OwnLinks(machine)

    def run(self, experiment: OwnExperiment, number: int = 0) -> Recording:
        """Run one experiment, and return its recording.

        Raises:
            InputError: the loop's period is no whole number of rows, or the loop has no reference.
            SimulationError: the machine cannot begin there, leaves its workspace or runs away.
        """
        m, n = self.machine, self.machine.size
        rows, period = len(experiment.feedforward), experiment.period
        count = max(1, round(period / (_FINE if m.couplings else _PIECE)))
        piece, ticks = period / count, self._rows_per_tick(experiment)
        generator = np.random.default_rng([self.seed, number])
        noise = generator.standard_normal((2, rows, n))
        time = np.arange(rows) * period
        pushed = unmeasured([0.0] * n, m.disturbances, time + 0.5 * period, generator)
        drives, motion = OwnDrives(m, piece, generator), OwnMotion(m, self.links, piece)
        state = motion.start(self._start(experiment))
        sensing, step = Sensing(m, piece, state.motor), self.sensors.encoder
        logged = {key: np.zeros((rows, n)) for key in _LOGGED}
        asked = np.zeros(n)
        for row in range(rows):
            q, w = sensing.look()
            q = np.round(q / step) * step if step else q
            w = w + self.sensors.velocity_noise * noise[0, row]
            if row % ticks == 0:
                asked = self._control(q, w, experiment, row)
            drives.command(asked)
            log = (q, w, asked, drives.measured(state.speed) + self.sensors.torque_noise * noise[1, row])
            for key, value in zip(_LOGGED, log, strict=True):
                logged[key][row] = value
            for k in range(count):
                if k:
                    drives.command(asked)
                state = motion.advance(state, drives.acting(state.speed, pushed[row]))
                sensing.see(state.motor, state.speed)
            refuse_runaway(state, time[row], f"{m.name} in '{experiment.name}'")
        signals = {**logged, "torque_feedforward": experiment.feedforward}
        if experiment.reference is not None:
            signals["position_reference"] = experiment.reference
        return Recording(
            experiment.name, m.axes, "actuator", time, signals, self.links.units, m.controller,
            experiment.excitation, rig=f"virtual hardware of {m.name}",
        )  # fmt: skip

    def _start(self, experiment: OwnExperiment) -> np.ndarray:
        if experiment.reference is None:
            return self.links.start(None)
        first = experiment.reference[0]
        if self.machine.controller.coordinates == "actuator":
            return np.array(first, float)
        return reachable(self.links, first, self.machine.name)

    def _control(self, q: np.ndarray, w: np.ndarray, experiment: OwnExperiment, row: int) -> np.ndarray:
        """PD in the loop's coordinates, of what the sensors show, and the torque on top."""
        m, loop = self.machine, self.machine.controller
        if experiment.reference is None or loop.kind == "none":
            return experiment.feedforward[row]
        kp, kd = np.multiply(loop.kp, m.kp_scale), np.multiply(loop.kd, m.kd_scale)
        wanted = experiment.reference[row]
        if loop.coordinates == "actuator":
            return kp * (wanted - q) - kd * w + experiment.feedforward[row]
        joints, slope = self.links.joints(q)
        return slope.T @ (kp * (wanted - joints) - kd * (slope @ w)) + experiment.feedforward[row]

    def _rows_per_tick(self, experiment: OwnExperiment) -> int:
        period, loop = experiment.period, self.machine.controller
        wanted = loop.period_s or period
        rows = round(wanted / period)
        if rows < 1 or abs(rows * period - wanted) > 1e-9:
            raise InputError(
                f"a loop of {1e3 * wanted:g} ms is not a whole number of rows of {1e3 * period:g} ms",
                remedy=f"give '{experiment.name}' another rate",
            )
        return rows


_LOGGED = ("position", "velocity", "torque_command", "torque_measured")


class Sensing:
    """Readings of encoders and speeds: delayed, filtered, and with encoder errors."""

    def __init__(self, machine: OwnMachine, piece: float, motor: np.ndarray) -> None:
        self._machine, self._piece = machine, piece
        self._back = machine.sensor_delay / piece
        self._past = [(motor.copy(), np.zeros(len(motor)))] * (int(self._back) + 2)
        self._kept = np.array([exp(-piece / lag) if lag else 0.0 for lag in machine.velocity_lag])
        self._filtered = np.zeros(len(motor))

    def see(self, motor: np.ndarray, speed: np.ndarray) -> None:
        """Store where the rotors are at the end of a piece."""
        shown = np.array([_read(e, q, w)[1] for e, q, w in zip(self._encoders, motor, speed, strict=True)])
        self._filtered = shown + (self._filtered - shown) * self._kept
        self._past.append((motor.copy(), np.where(self._kept > 0.0, self._filtered, shown)))
        self._past.pop(0)

    def look(self) -> tuple[np.ndarray, np.ndarray]:
        """Return positions and speeds (n,) as in the log, without noise and resolution."""
        whole = int(self._back)
        part = self._back - whole
        (q0, w0), (q1, w1) = (
            self._past[-1 - whole],
            self._past[-2 - whole] if part else self._past[-1 - whole],
        )
        q, w = (1 - part) * q0 + part * q1, (1 - part) * w0 + part * w1
        return np.array([_read(e, x, 0.0)[0] for e, x in zip(self._encoders, q, strict=True)]), w

    @property
    def _encoders(self) -> list[Encoder]:
        return self._machine.encoders


def _read(encoder: Encoder, angle: float, speed: float) -> tuple[float, float]:
    shown, rate = encoder.scale * angle + encoder.offset, encoder.scale
    for size, phase in encoder.eccentricity:
        shown += size * np.sin(angle + phase)
        rate += size * np.cos(angle + phase)
    return shown, rate * speed
