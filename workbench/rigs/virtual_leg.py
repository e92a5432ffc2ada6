"""The demo's virtual hardware: a leg that is measured like a real one and may hide effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, floor
from pathlib import Path

import numpy as np

from workbench.core import Controller, Recording, SimulationError
from workbench.recordings import save_recording

from .experiments import ROW_PERIOD, Experiment, demo_experiments
from .friction import merged
from .hidden import HiddenEffect, install
from .integrate import Integrator, State
from .machine import AXES, Machine

CONTROLLER = Controller("pd", "joint", kp=(50.0, 50.0), kd=(1.5, 1.5), period_s=0.003)
_ROWS_PER_TICK = 3


@dataclass(frozen=True)
class Sensors:
    """What stands between the leg and its log.

    Attributes:
        encoder: position is rounded to this [rad]; 0 for none. Default: 14 bits a turn.
        velocity_noise: standard deviation of white noise a row [rad/s].
        torque_noise: the same for torque [N m].
    """

    encoder: float = 2 * np.pi / 2**14
    velocity_noise: float = 0.015
    torque_noise: float = 0.02


PERFECT = Sensors(0.0, 0.0, 0.0)


class VirtualLeg:
    """The reference leg on its stand, fixed base, two motors, logged at 1 kHz.

    Args:
        hidden: effects that the leg has beyond the nominal model.
        seed: of all sensor noise and random disturbances; run k of a call draws from (seed, k).
        sensors: noise and resolution; `PERFECT` logs the truth.
    """

    def __init__(
        self, hidden: Sequence[HiddenEffect] = (), seed: int = 0, sensors: Sensors | None = None
    ) -> None:
        self.hidden, self.seed, self.sensors = tuple(hidden), seed, sensors or Sensors()
        self._machine = Machine()
        for effect in self.hidden:
            install(effect, self._machine)
        if len(merged(self._machine.frictions)) > 2:
            raise SimulationError("the rig sticks at two pins at most; hide fewer dry frictions")

    def run(self, experiments: Sequence[Experiment] | None = None) -> list[Recording]:
        """Makes the experiments (default: the demo's six) and returns what was logged.

        Returns:
            One recording an experiment: position, velocity, torque_command, torque_measured,
            torque_feedforward in actuator coordinates and position_reference in joint coordinates, each
            (N, 2). Nothing in it tells what was hidden.

        Raises:
            SimulationError: the leg ran away.
        """
        chosen = demo_experiments(self.seed) if experiments is None else experiments
        return [self._record(experiment, run) for run, experiment in enumerate(chosen)]

    def record_to(
        self, folder: str | Path, experiments: Sequence[Experiment] | None = None, force: bool = False
    ) -> list[Path]:
        """Runs and writes one TOML and one csv.gz a recording into `folder`; returns the TOML files.

        Raises:
            InputError: a file is there already and `force` is not set.
        """
        written = []
        for recording in self.run(experiments):
            path = Path(folder) / f"{recording.name}.toml"
            path.parent.mkdir(parents=True, exist_ok=True)
            save_recording(recording, path, compress=True, force=force)
            written.append(path)
        return written

    def _record(self, experiment: Experiment, run: int) -> Recording:
        rows = len(experiment.reference)
        time = np.arange(rows) * ROW_PERIOD
        signals = self._simulate(experiment, time, np.random.default_rng([self.seed, run]))
        return Recording(
            name=experiment.name,
            axes=AXES,
            coordinates="actuator",
            time=time,
            signals={
                **signals,
                "torque_feedforward": experiment.feedforward,
                "position_reference": experiment.reference,
            },
            units=("rad", "rad"),
            controller=CONTROLLER,
            excitation=experiment.excitation,
            rig="leg",
        )

    def _simulate(
        self, experiment: Experiment, time: np.ndarray, generator: np.random.Generator
    ) -> dict[str, np.ndarray]:
        """The loop, row by row: log, control at ticks, then let the leg move on for one row."""
        machine, rows = self._machine, len(time)
        velocity_noise = (self.sensors.velocity_noise * generator.standard_normal((rows, 2))).tolist()
        torque_noise = self.sensors.torque_noise * generator.standard_normal((rows, 2))
        unmeasured = self._unmeasured_torque(time, generator).tolist()
        reference, feedforward = experiment.reference.tolist(), experiment.feedforward.tolist()
        position, velocity, command, torque = (np.empty((rows, 2)) for _ in range(4))
        leg = Integrator(
            machine.structure,
            (machine.damping[0], machine.damping[1]),
            machine.passive,
            merged(machine.frictions),
        )
        drive = _Drive(machine)
        hip, knee = reference[0]
        state: State = (hip, hip + knee, 0.0, 0.0)
        asked = (0.0, 0.0)
        for row in range(rows):
            q1, q2 = self._encoder(state[0]), self._encoder(state[1])
            w1, w2 = state[2] + velocity_noise[row][0], state[3] + velocity_noise[row][1]
            if row % _ROWS_PER_TICK == 0:
                asked = _control(q1, q2, w1, w2, reference[row], feedforward[row])
            drive.command(asked)
            position[row], velocity[row], command[row], torque[row] = (q1, q2), (w1, w2), asked, drive.torque
            bias1, bias2 = unmeasured[row]
            for (u1, u2), duration in drive.advance():
                u1, u2 = machine.gain[0] * u1 + bias1, machine.gain[1] * u2 + bias2
                state = leg.advance(state, u1, u2, duration)
            if not abs(state[2]) + abs(state[3]) < 1e3:
                raise SimulationError(f"the leg ran away in '{experiment.name}' at {time[row]:.3f} s")
        torque += torque_noise
        return {
            "position": position,
            "velocity": velocity,
            "torque_command": command,
            "torque_measured": torque,
        }

    def _unmeasured_torque(self, time: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        """Bias and disturbances (N, 2) [N m], held over each row, at mid-row."""
        total = np.tile(np.array(self._machine.bias), (len(time), 1))
        for axis, disturbance in self._machine.disturbances:
            total[:, axis] += disturbance(time + ROW_PERIOD / 2, generator)
        return total

    def _encoder(self, angle: float) -> float:
        step = self.sensors.encoder
        return round(angle / step) * step if step else angle


def _control(
    q1: float, q2: float, w1: float, w2: float, reference: list[float], feedforward: list[float]
) -> tuple[float, float]:
    """Joint PD of logged actuator angles and speeds: tau_p = J^-T tau_s plus feedforward [N m]."""
    (kp1, kp2), (kd1, kd2) = CONTROLLER.kp, CONTROLLER.kd
    hip = kp1 * (reference[0] - q1) - kd1 * w1
    knee = kp2 * (reference[1] - (q2 - q1)) - kd2 * (w2 - w1)
    return hip - knee + feedforward[0], knee + feedforward[1]


class _Drive:
    """Both drives from command to measured torque: delay, then limit, then current-loop lag.

    A delay is whole rows plus a rest; during the rest of each row the previous command still stands.
    """

    _PIECE = 0.25e-3  # a lagging torque is held at its mean over this long [s]

    def __init__(self, machine: Machine) -> None:
        whole = floor(machine.delay / ROW_PERIOD + 1e-6)
        self._rest = max(0.0, machine.delay - whole * ROW_PERIOD)
        if self._rest < 1e-9:
            self._rest = 0.0
        self._pending = [(0.0, 0.0)] * (whole + 2)  # clipped commands of the last rows, newest last
        self._limit, self._lag = machine.limit, machine.lag
        self._current = (0.0, 0.0)

    def command(self, torque: tuple[float, float]) -> None:
        """Takes the command of the row that begins."""
        (low1, low2) = self._limit
        self._pending.append((min(max(torque[0], -low1), low1), min(max(torque[1], -low2), low2)))
        self._pending.pop(0)

    @property
    def torque(self) -> tuple[float, float]:
        """Torque at the start of the row, just after an edge [N m]."""
        target = self._pending[0 if self._rest else 1]
        (lag1, lag2), (now1, now2) = self._lag, self._current
        return now1 if lag1 else target[0], now2 if lag2 else target[1]

    def advance(self) -> list[tuple[tuple[float, float], float]]:
        """Torques [N m] and how long each acts [s], through one row."""
        if self._rest:
            pieces = [(self._pending[0], self._rest), (self._pending[1], ROW_PERIOD - self._rest)]
        else:
            pieces = [(self._pending[1], ROW_PERIOD)]
        if not any(self._lag):
            return pieces
        lagged = []
        for target, duration in pieces:
            count = max(1, round(duration / self._PIECE))
            for _ in range(count):
                lagged.append((self._follow(target, duration / count), duration / count))
        return lagged

    def _follow(self, target: tuple[float, float], duration: float) -> tuple[float, float]:
        """Moves the lagging torques towards `target` and returns their means over `duration`."""
        means, ends = [], []
        for goal, now, lag in zip(target, self._current, self._lag, strict=True):
            kept = exp(-duration / lag) if lag else 0.0
            ends.append(goal + (now - goal) * kept)
            means.append(goal + (now - goal) * (1 - kept) * lag / duration)
        self._current = (ends[0], ends[1])
        return means[0], means[1]
