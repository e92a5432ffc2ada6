"""All drives of a configuration and the machines that they turn, simulated row by row."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from workbench.can import CanConfig, Frame
from workbench.can.imu import Triple, WorkbenchImu
from workbench.core import InputError

from .hidden import HiddenEffect
from .live import ROW, LiveLeg, LiveShaft, Look, Plant
from .live_own import LiveOwn
from .quadruped import FORCE_NOISE, GRAVITY_NOISE, GYRO_NOISE, LiveQuadruped
from .quadruped import ROW as QUADRUPED_ROW
from .speaking import side_of
from .virtual_leg import Sensors
from .virtual_motor import VirtualMotor

IMU = ""  # who says what is no axis's
_STEADY = 0.1  # s that drives hold at full torque before a stand lets go
_DOWN = np.array([0.0, 0.0, -1.0])

#: Full scale of drives whose ranges are to be read from them.
_OWN = (12.5, 45.0, 25.0)


class MotorBank:
    """Virtual motors: legs on their stands and single actuators, or one quadruped with its inertial unit.

    A quadruped is held by its stand until all its drives have been on for as long as they start softly, any
    other machine than the reference leg as long as none of its drives is on.

    Args:
        config: the buses and drives.
        hidden: effects in every leg.
        seed: of sensor noise; each machine draws its own.
        sensors: noise and resolution.
        row: one cycle of the drives' control [s]; None for the rig's own.
        make: the plant that a mechanism's motors turn, of its model's name, a seed and the row; where it is
            left out, the reference leg.

    Attributes:
        robot: the quadruped, if it is one.

    Raises:
        InputError: a mechanism that is no leg, or a quadruped of other than 12 axes.
    """

    def __init__(
        self,
        config: CanConfig,
        hidden: Sequence[HiddenEffect] = (),
        seed: int = 0,
        sensors: Sensors | None = None,
        row: float | None = None,
        make: Callable[[str, int, float], Plant] | None = None,
    ) -> None:
        quadruped = config.bench.rig == "quadruped"
        self.row = row or (QUADRUPED_ROW if quadruped else ROW)
        self.motors = {
            m.axis: VirtualMotor(m.axis, side_of(m, _OWN if m.reads_ranges else None), m.sign, m.offset)
            for m in config.motor
        }
        for m in config.motor:
            if "watchdog" not in self.motors[m.axis].drive.parameters:  # set with the vendor's tool
                self.motors[m.axis].parameters["watchdog"] = m.watchdog_s
        self._plants: list[tuple[Plant, list[VirtualMotor]]] = []
        self.robot: LiveQuadruped | None = None
        self._imu, self._sample, self._on = None, 0.0, 0
        self._noise = np.random.default_rng([seed, 47])
        if config.imu:
            if config.imu.protocol != "workbench":
                raise InputError(
                    f"the virtual unit does not speak '{config.imu.protocol}'", file=config.source,
                    column="imu.protocol", remedy='for virtual motors write "workbench"',
                )  # fmt: skip
            self._imu, self._period = WorkbenchImu(config.imu.id), config.imu.period_s
        if quadruped:
            self._stand(config, hidden, seed, sensors)
        else:
            self._single(config, hidden, seed, sensors, make)

    def _stand(
        self, config: CanConfig, hidden: Sequence[HiddenEffect], seed: int, sensors: Sensors | None
    ) -> None:
        if len(config.motor) != LiveQuadruped.axes:
            raise InputError(
                f"a quadruped has {LiveQuadruped.axes} axes, here are {len(config.motor)}",
                file=config.source, column="bench.rig", remedy="abduction, hip and knee of fl, fr, rl and rr",
            )  # fmt: skip
        if hidden:
            raise InputError("the virtual quadruped hides nothing", remedy="hide it in a leg")
        self.robot = LiveQuadruped(seed, sensors, self.row)
        self._plants.append((self.robot, list(self.motors.values())))
        self._let_go = round((config.loop.soft_start_s + _STEADY) / self.row)

    def _single(
        self, config: CanConfig, hidden: Sequence[HiddenEffect], seed: int, sensors: Sensors | None,
        make: Callable[[str, int, float], Plant] | None,
    ) -> None:  # fmt: skip
        row, free = self.row, list(config.axes)
        for k, mechanism in enumerate(config.mechanism):
            if make is not None:
                turned = make(mechanism.model, 1000 * seed + k, row)
            elif len(mechanism.axes) == 2:
                turned = LiveLeg(hidden, seed=1000 * seed + k, sensors=sensors, row=row)
            else:
                raise InputError(
                    f"'{mechanism.model}' has {len(mechanism.axes)} axes", file=config.source,
                    column="mechanism.axes",
                    remedy="virtual motors turn legs of two axes, or single actuators",
                )  # fmt: skip
            self._plants.append((turned, [self.motors[axis] for axis in mechanism.axes]))
            free = [axis for axis in free if axis not in mechanism.axes]
        for k, axis in enumerate(free):
            shaft = LiveShaft(seed=1000 * seed + 500 + k, sensors=sensors, row=row)
            self._plants.append((shaft, [self.motors[axis]]))

    def respond(self, now: float) -> list[tuple[str, Frame]]:
        """Return answers between rows, as the next row would give them when it begins: axis and frame.

        A command acts from there on, and its answer shows it, as it does in the row itself: a loop's delay is
        then the same, whenever its frames come.
        """
        said: list[tuple[str, Frame]] = []
        for plant, motors in self._plants:
            heard = [k for k, motor in enumerate(motors) if motor.has_heard]
            if not heard:
                continue
            for k in heard:
                motors[k].obey(now)
            looks = self._told(plant, motors)
            for k in heard:
                said += [(motors[k].axis, frame) for frame in motors[k].answer(looks[k], now, 0.0)]
        return said

    def _told(self, plant: Plant, motors: list[VirtualMotor]) -> list[Look]:
        """Commands the torques of the row that begins; what sensors show just behind the edge."""
        before = plant.look()
        plant.command([motor.torque(look) for motor, look in zip(motors, before, strict=True)])
        # most rows nobody is asked: what the sensors show behind the edge is not needed then
        return plant.look() if any(motor.asked for motor in motors) else before

    def work(self, now: float) -> list[tuple[str, Frame]]:
        """Simulate a row that begins now [s]; return what motors and `IMU` send: axis, frame."""
        said: list[tuple[str, Frame]] = []
        for plant, motors in self._plants:
            for motor in motors:
                motor.obey(now)
            for motor, look in zip(motors, self._told(plant, motors), strict=True):
                said += [(motor.axis, frame) for frame in motor.answer(look, now, self.row)]
            if isinstance(plant, LiveOwn):
                plant.held = not any(motor.enabled for motor in motors)
            plant.advance()
        return said + self._base(now)

    def _base(self, now: float) -> list[tuple[str, Frame]]:
        """What the inertial unit says; without a robot it lies still. Lets the robot go when it is time."""
        robot = self.robot
        if robot and robot.held:
            self._on = self._on + 1 if all(motor.enabled for motor in self.motors.values()) else 0
            robot.held = self._on < self._let_go
        if self._imu is None or now < self._sample - 0.5 * self.row:
            return []
        self._sample = max(self._sample, now - self._period) + self._period
        felt = robot.feel() if robot else self._rest()
        angular, gravity, force = map(_triple, felt)
        return [(IMU, frame) for frame in self._imu.encode(angular, gravity, force)]

    def _rest(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What a unit on a stand shows: its noise."""
        noise = self._noise.standard_normal((3, 3))
        turn, fall, push = GYRO_NOISE * noise[0], GRAVITY_NOISE * noise[1], FORCE_NOISE * noise[2]
        return turn, _DOWN + fall, push - _DOWN


def _triple(values: np.ndarray) -> Triple:
    x, y, z = values.tolist()
    return x, y, z
