"""Asks every drive before anything moves: identity, mode, ranges, watchdog, each read back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from workbench.can import CanConfig, Frame, Parameter, make_drive, range_problems
from workbench.can.messages import ParameterName, burst
from workbench.core import WorkbenchError

from .feedback import Feedback
from .network import Network

_PATIENCE, _TRIES = 0.1, 10  # s, times
_OPERATION = 1.0
_RANGES: tuple[ParameterName, ...] = ("position", "velocity", "torque")


class VerifyError(WorkbenchError):
    """A drive that differs from the configuration, or does not answer."""

    exit_code = 1


@dataclass(frozen=True)
class Verified:
    """Answers of a drive.

    Attributes:
        axis: it turns.
        told: parameters by name, read back.
        trusted: what could not be read, and who says so.
    """

    axis: str
    told: dict[str, float]
    trusted: str

    @property
    def line(self) -> str:
        """Return what the drive said of itself, with units, and what was taken on trust."""
        units = {"position": "rad", "velocity": "rad/s", "torque": "N m"}
        said = [f"{name} ±{self.told[name]:g} {unit}" for name, unit in units.items() if name in self.told]
        if "watchdog" in self.told:
            said.insert(0, f"watchdog {1e3 * self.told['watchdog']:g} ms")
        trusted = f"; not read: {self.trusted}" if self.trusted else ""
        return f"{self.axis} answers{': ' if said else ''}{', '.join(said)}{trusted}"


def verify(config: CanConfig, network: Network, feedback: Feedback) -> list[Verified]:
    """Read, set and read back the settings of every drive; drives stay disabled.

    Args:
        config: what they should say.
        network: the buses.
        feedback: gets drives with the ranges that were read.

    Raises:
        VerifyError: a drive says nothing, or something else.
    """
    return [_verify(index, config, network, feedback) for index in range(len(config.motor))]


def _verify(index: int, config: CanConfig, network: Network, feedback: Feedback) -> Verified:
    motor, drive = config.motor[index], feedback.drives[index]
    stamp = feedback.stamp[index]
    heard = _ask(network, feedback, motor.bus, drive.act("disable"), lambda: feedback.stamp[index] > stamp)
    if not heard:
        raise VerifyError(
            f"'{motor.axis}' does not answer on {motor.bus}: check power, wiring, id and reply_id"
        )
    told: dict[str, float] = {}

    def read(name: ParameterName) -> float:
        feedback.forget(index, name)
        request = drive.read(name)
        if not _ask(
            network, feedback, motor.bus, request, lambda: feedback.parameter(index, name) is not None
        ):
            raise VerifyError(f"'{motor.axis}' does not report its {name}")
        value = feedback.parameter(index, name)
        assert value is not None
        told[name] = value
        return value

    if "mode" in drive.parameters and read("mode") != _OPERATION:
        raise VerifyError(
            f"'{motor.axis}' is in mode {told['mode']:g}: set mode 1, in which it follows setpoints"
        )
    if "watchdog" in drive.parameters:
        for frame in burst(drive.write(Parameter("watchdog", motor.watchdog_s))):
            network.send(motor.bus, frame)
        if abs(read("watchdog") - motor.watchdog_s) > 1e-4:
            raise VerifyError(
                f"the watchdog of '{motor.axis}' reads {1e3 * told['watchdog']:.4g} ms after "
                f"{1e3 * motor.watchdog_s:.4g} ms were written"
            )
    if "torque" in drive.parameters:
        ranges = tuple(read(name) for name in _RANGES)
        _check_ranges(index, config, (ranges[0], ranges[1], ranges[2]))
        feedback.replace(index, make_drive(motor, (ranges[0], ranges[1], ranges[2])))
    missing = {"watchdog", "mode", "torque"} - set(drive.parameters)
    trusted = (
        f"{', '.join(sorted(missing))} as stated by {motor.watchdog_source or motor.ranges.source}"
        if missing
        else ""
    )
    return Verified(motor.axis, told, trusted)


def _check_ranges(index: int, config: CanConfig, read: tuple[float, float, float]) -> None:
    motor = config.motor[index]
    for name, value in zip(_RANGES, read, strict=True):
        wanted = getattr(motor.ranges, name)
        if wanted is not None and abs(value - wanted) > 1e-3 * wanted:
            raise VerifyError(
                f"'{motor.axis}' reports a {name} range of {value:g}, the configuration says {wanted:g}"
            )
    for key, problem, remedy in range_problems(motor, read, config):
        raise VerifyError(f"{key}: {problem}; {remedy}")


def _ask(
    network: Network,
    feedback: Feedback,
    bus: str,
    frames: Frame | tuple[Frame, ...],
    answered: Callable[[], bool],
) -> bool:
    """Sends until there is an answer."""
    for _ in range(_TRIES):
        for frame in burst(frames):
            network.send(bus, frame)
        until = network.now() + _PATIENCE
        while network.now() < until - 1e-9:
            for arrival in network.receive(until):
                feedback.take(arrival, network.now())
            if answered():
                return True
    return False
