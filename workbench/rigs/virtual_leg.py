"""The virtual hardware of the demo: a leg that is measured like a real one and may hide effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core import Controller, InputError, Recording, Recordings, SimulationError
from workbench.core.files import together
from workbench.recordings import save_recording

from .drive import Drive
from .experiments import Experiment, demo_experiments
from .hidden import HiddenEffect, install
from .machine import AXES, Machine, unmeasured
from .moving_leg import MovingLeg, moving_leg
from .sensing import Motion, Sensing, cut
from .standing_leg import Plate, StandingLeg

CONTROLLER = Controller("pd", "joint", kp=(50.0, 50.0), kd=(1.5, 1.5), period_s=0.003)


@dataclass(frozen=True)
class Sensors:
    """Errors between the leg and its log.

    Attributes:
        encoder: position is rounded to this [rad]; 0 for none. Default: 14 bits per turn.
        velocity_noise: standard deviation of white noise a row [rad/s].
        torque_noise: the same for torque [N m].
    """

    encoder: float = 2 * np.pi / 2**14
    velocity_noise: float = 0.015
    torque_noise: float = 0.02


PERFECT = Sensors(0.0, 0.0, 0.0)


class VirtualLeg:
    """The reference leg on its stand, two motors, logged at 1 kHz unless an experiment says otherwise.

    Args:
        hidden: effects that the leg has beyond the nominal model.
        seed: of all sensor noise and random disturbances; run k of a call draws from (seed, k).
        sensors: noise and resolution; `PERFECT` logs the truth.
        control_period: of the sampled loop, a whole number of rows [s].
        plate: a force plate that the foot may touch.

    Raises:
        SimulationError: these effects cannot be in one leg.
    """

    def __init__(
        self,
        hidden: Sequence[HiddenEffect] = (),
        seed: int = 0,
        sensors: Sensors | None = None,
        control_period: float = 3e-3,
        plate: Plate | None = None,
    ) -> None:
        self.hidden, self.seed, self.sensors = tuple(hidden), seed, sensors or Sensors()
        self.controller = replace(CONTROLLER, period_s=control_period)
        self._machine = Machine(plate=None if plate is None else replace(plate))
        for effect in self.hidden:
            install(effect, self._machine)
        moving_leg(self._machine)  # refuses now what it cannot integrate

    def run(self, experiments: Sequence[Experiment] | None = None) -> Recordings:
        """Run the experiments (default: the six of the demo) and return the recordings.

        Returns:
            One recording an experiment: position, velocity, torque_command, torque_measured,
            torque_feedforward in actuator coordinates and position_reference in joint coordinates, each
            (N, 2). Nothing in it tells what was hidden.

        Raises:
            InputError: the loop's period is no whole number of an experiment's rows.
            SimulationError: the leg ran away.
        """
        chosen = demo_experiments(self.seed) if experiments is None else experiments
        return Recordings(self._record(experiment, run) for run, experiment in enumerate(chosen))

    def record_to(
        self, folder: str | Path, experiments: Sequence[Experiment] | None = None, force: bool = False
    ) -> list[Path]:
        """Run, and write a TOML and a csv.gz per recording into `folder`, all or none; return the TOML files.

        Raises:
            InputError: a file is there already and `force` is not set.
        """
        recordings = self.run(experiments)
        files = [Path(folder) / f"{recording.name}.toml" for recording in recordings]
        with together():
            for recording, file in zip(recordings, files, strict=True):
                save_recording(recording, file, compress=True, force=force)
        return files

    def _record(self, experiment: Experiment, run: int) -> Recording:
        time = np.arange(len(experiment.reference)) * experiment.period
        signals = self._simulate(experiment, time, np.random.default_rng([self.seed, run]))
        extra = {"ground_force": signals.pop("ground_force")} if "ground_force" in signals else {}
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
            controller=self.controller,
            excitation=experiment.excitation,
            rig="leg",
            extra=extra,
        )

    def _simulate(
        self, experiment: Experiment, time: np.ndarray, generator: np.random.Generator
    ) -> dict[str, np.ndarray]:
        """The loop, row by row: log, control at ticks, then let the leg move on for one row."""
        machine, rows, period = self._machine, len(time), experiment.period
        ticks = self._rows_per_tick(experiment)
        velocity_noise = (self.sensors.velocity_noise * generator.standard_normal((rows, 2))).tolist()
        torque_noise = self.sensors.torque_noise * generator.standard_normal((rows, 2))
        middle = time + 0.5 * time[1]
        pushed = unmeasured(machine.bias, machine.disturbances, middle, generator).tolist()
        reference, feedforward = experiment.reference.tolist(), experiment.feedforward.tolist()
        position, velocity, command, torque, ground = [], [], [], [], []
        kp, kd = (
            np.multiply(self.controller.kp, machine.kp_scale),
            np.multiply(self.controller.kd, machine.kd_scale),
        )
        gains = (*kp.tolist(), *kd.tolist())
        leg, drive = moving_leg(machine), Drive(machine, period, generator)
        hip, knee = reference[0]
        state = leg.start(hip, hip + knee)
        seen = leg.motors(state)
        sensing = Sensing(machine, period, seen)
        watched, true = sensing.look is not None or drive.feels_speed, sensing.true
        step, asked = self.sensors.encoder, (0.0, 0.0)
        for row, bias, (noise1, noise2) in zip(range(rows), pushed, velocity_noise, strict=True):
            q1, q2, w1, w2 = seen if true else sensing.measure(seen)
            if step:
                q1, q2 = round(q1 / step) * step, round(q2 / step) * step
            w1, w2 = w1 + noise1, w2 + noise2
            if row % ticks == 0:
                asked = _control(gains, q1, q2, w1, w2, reference[row], feedforward[row])
            drive.command(asked)
            position.append((q1, q2))
            velocity.append((w1, w2))
            command.append(asked)
            torque.append(drive.torque)
            if isinstance(leg, StandingLeg):
                ground.append(leg.ground_force(state))
            if watched:
                state, seen = _watched_row(leg, drive, state, bias, sensing.look)
            else:
                for u1, u2, duration in drive.advance(bias):
                    state = leg.advance(state, u1, u2, duration)
                seen = leg.motors(state)
            if not abs(seen[2]) + abs(seen[3]) < 1e3:
                raise SimulationError(f"the leg ran away in '{experiment.name}' at {time[row]:.3f} s")
        plate = machine.plate
        return {
            **({} if plate is None else {"ground_force": _felt(ground, plate.noise, generator)}),
            "position": np.array(position),
            "velocity": np.array(velocity),
            "torque_command": np.array(command),
            "torque_measured": np.array(torque) + torque_noise,
        }

    def _rows_per_tick(self, experiment: Experiment) -> int:
        wanted = self.controller.period_s or experiment.period
        rows = round(wanted / experiment.period)
        if rows < 1 or abs(rows * experiment.period - wanted) > 1e-9:
            raise InputError(
                f"a loop of {1e3 * wanted:g} ms is not a whole number of rows of "
                f"{1e3 * experiment.period:g} ms",
                remedy=f"give '{experiment.name}' other rows: Experiment.at_period",
            )
        return rows


def _felt(forces: Sequence[Sequence[float]], noise: float, generator: np.random.Generator) -> np.ndarray:
    """What a force plate shows, (N, 3) [N]."""
    return np.array(forces) + noise * generator.standard_normal((len(forces), 3))


def _watched_row(
    leg: MovingLeg, drive: Drive, state: Any, bias: list[float], look: float | None
) -> tuple[Any, Motion]:
    """One row whose pieces matter: the state at its end, and the motion where the sensors look."""
    seen = None
    at_end = ((*piece, False) for piece in drive.advance(bias))
    for u1, u2, duration, looks in at_end if look is None else cut(drive.advance(bias), look):
        state = leg.advance(state, u1, u2, duration)
        motors = leg.motors(state)
        drive.feel(motors[2], motors[3])
        seen = motors if looks else seen
    return state, seen or leg.motors(state)


def _control(
    gains: tuple[float, ...],
    q1: float,
    q2: float,
    w1: float,
    w2: float,
    reference: list[float],
    feedforward: list[float],
) -> tuple[float, float]:
    """Joint PD of logged actuator angles and speeds: tau_p = J^-T tau_s plus feedforward [N m]."""
    kp1, kp2, kd1, kd2 = gains
    hip = kp1 * (reference[0] - q1) - kd1 * w1
    knee = kp2 * (reference[1] - (q2 - q1)) - kd2 * (w2 - w1)
    return hip - knee + feedforward[0], knee + feedforward[1]
