"""All measures of two recordings of one robot, hardware and simulator; the hardware again is the floor."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError, Recording

from .bootstrap import Interval, resampled
from .cycle import cycle_gap, cycles_of
from .measures import Gait, Measure
from .strides import Strides, duty_factor, strides_alike
from .swing import LOADED, Limbs, predict_swing
from .tracking import tracking

_LEAST = 0.1  # m/s, rad/s: a mean speed below which nothing was asked for
_PERIODS = 1e-3  # by which two recordings' row periods may differ, as a share
_PARTS = {"whole": "", "bias": ", bias", "slow": ", below 1 Hz", "ripple": ", ripple"}


def compare_gaits(
    hardware: Recording,
    simulator: Recording,
    again: Recording | None = None,
    limbs: Limbs | None = None,
    *,
    command: Sequence[float] | None = None,
    start_s: float = 0.0,
) -> Gait:
    """Measures of a hardware recording against a simulator's, of the same command from the same moment.

    Args:
        hardware, simulator: in the same coordinates, with the same axes and row period.
        again: another run of the hardware with the same command.
        limbs: of the model, for the prediction of the swing leg on the hardware's recording.
        command: forward [m/s] and turning speed [rad/s] asked for; by default the hardware's means.
        start_s: what comes earlier is left out [s].

    Raises:
        InputError: recordings of different axes, coordinates or periods.
    """
    runs = [hardware, simulator, *([again] if again else [])]
    _alike(runs)
    first = round(start_s / hardware.period)
    if first >= min(map(len, runs)) - 10:
        raise InputError(f"nothing is left after {start_s:g} s", file=hardware.source, remedy="start earlier")
    cut = [r.rows(slice(first, None)) for r in runs]
    measures: list[Measure] = []
    lacking: list[str] = []

    def attempt(make: Callable[[], list[Measure]]) -> None:
        try:
            measures.extend(make())
        except InputError as error:
            lacking.append(str(error))

    asked = _command(cut[0], command)
    attempt(lambda: _tracked(cut, np.array(asked)))
    strides: list[Strides] = []
    attempt(lambda: _strides(cut, strides))
    if strides:
        attempt(lambda: _duty(cut, strides))
        attempt(lambda: _cycle(cut, strides, "joint angles over the stride", "mrad", _angles))
        attempt(lambda: _cycle(cut, strides, "torque over the stride", "N m", _torques))
        attempt(lambda: _cycle(cut, strides, "foot force over the stride", "N", _forces))
    if limbs is not None:
        attempt(lambda: _predicted(limbs, cut[0]))
    return Gait(
        hardware.name, simulator.name, again.name if again else None, asked, tuple(measures), tuple(lacking)
    )


def base_speeds(recording: Recording) -> np.ndarray:
    """Forward speed and yaw rate of the base in its own frame (N, 2) [m/s, rad/s].

    Raises:
        InputError: the recording does not have the base's rates.
    """
    turn = Rotation.from_quat(np.roll(_extra(recording, "base_orientation", "E_phi"), -1, axis=1))
    linear = turn.inv().apply(_extra(recording, "base_velocity", "E_phi"))
    return np.stack([linear[:, 0], _extra(recording, "base_angular_velocity", "E_phi")[:, 2]], axis=1)


def _alike(runs: Sequence[Recording]) -> None:
    one = runs[0]
    for other in runs[1:]:
        if other.axes != one.axes or other.coordinates != one.coordinates:
            raise InputError(
                f"its axes or coordinates differ from those of {one.name}", file=other.source,
                remedy="give two recordings of one robot",
            )  # fmt: skip
        if abs(other.period / one.period - 1.0) > _PERIODS:
            raise InputError(
                f"rows of {1e3 * other.period:.3g} ms, and {1e3 * one.period:.3g} ms in {one.name}",
                file=other.source, remedy="resample one of them",
            )  # fmt: skip


def _command(hardware: Recording, given: Sequence[float] | None) -> tuple[float, float]:
    if given is not None:
        return float(given[0]), float(given[1])
    try:
        forward, yaw = base_speeds(hardware).mean(axis=0)
    except InputError:
        return 0.0, 0.0
    return tuple(float(v) if abs(v) >= _LEAST else 0.0 for v in (forward, yaw))  # pyright: ignore[reportReturnType]


def _tracked(runs: Sequence[Recording], command: np.ndarray) -> list[Measure]:
    speeds = [base_speeds(r) for r in runs]
    if not command.any():
        raise InputError(
            "E_phi is relative to the speed, which is zero here", file=runs[0].source,
            remedy="give --command, or look at the other measures",
        )  # fmt: skip
    gaps = [tracking(speeds[0], other, command, runs[0].period) for other in speeds[1:]]
    return [
        Measure(
            f"{name}{words}", "%", getattr(gaps[0], kind)[part],
            getattr(gaps[1], kind)[part] if len(gaps) > 1 else None,
        )
        for kind, name in (("phase", "E_phi"), ("rmse", "E_RMSE")) for part, words in _PARTS.items()
    ]  # fmt: skip


def _strides(runs: Sequence[Recording], found: list[Strides]) -> list[Measure]:
    """Stride frequency; `found` gets the strides of each run, all seen in the hardware's busiest joint."""
    axis = int(np.argmax(runs[0].velocity.std(axis=0)))
    each: list[Strides] = []
    for run, own in zip(
        runs, strides_alike([r.position[:, axis] for r in runs], runs[0].period), strict=True
    ):
        if own is None:
            raise InputError(
                f"no strides are seen in {run.axes[axis]}", file=run.source or run.name,
                remedy="give a steady gait of several strides",
            )  # fmt: skip
        each.append(own)
    found.extend(each)

    def faster(other: Strides) -> Interval:
        """By how much its strides are quicker than the hardware's [%]."""
        both = each[0].seconds[:, None], other.seconds[:, None]
        return resampled(lambda a, b: 100.0 * (a[..., 0] / b[..., 0] - 1.0), *both)

    gap, *floor = map(faster, each[1:])
    one, two = each[0].frequency, each[1].frequency
    return [Measure("stride frequency", "%", gap, floor[0] if floor else None, one, two, "Hz")]


def _duty(runs: Sequence[Recording], strides: Sequence[Strides]) -> list[Measure]:
    each = [duty_factor(_loads(r, "the duty factor") > LOADED, s) for r, s in zip(runs, strides, strict=True)]
    gap, *floor = (_less(each[0], other) for other in each[1:])
    return [Measure("duty factor", "", gap, floor[0] if floor else None, each[0], each[1])]


def _less(one: Interval, other: Interval) -> Interval:
    """How much the second of two independent numbers is above the first."""
    low = np.hypot(other.value - other.low, one.high - one.value)
    high = np.hypot(other.high - other.value, one.value - one.low)
    gap = other.value - one.value
    return Interval(gap, gap - float(low), gap + float(high))


def _cycle(
    runs: Sequence[Recording], strides: Sequence[Strides], name: str, unit: str,
    signal: Callable[[Recording], np.ndarray],
) -> list[Measure]:  # fmt: skip
    each = [cycles_of(signal(r), s) for r, s in zip(runs, strides, strict=True)]
    gap, *floor = (cycle_gap(each[0], other) for other in each[1:])
    return [Measure(name, unit, gap, floor[0] if floor else None)]


def _angles(recording: Recording) -> np.ndarray:
    return 1e3 * recording.position


def _torques(recording: Recording) -> np.ndarray:
    torque = recording.get("torque_measured")
    if torque is None:
        raise InputError(
            "the torque over the stride needs torque_measured", file=recording.source or recording.name,
            remedy="name its columns",
        )  # fmt: skip
    return torque


def _forces(recording: Recording) -> np.ndarray:
    return _loads(recording, "the foot force over the stride")


def _loads(recording: Recording, what: str) -> np.ndarray:
    """Size of the force on each foot (N, F) [N]."""
    force = _extra(recording, "ground_force", what)
    return np.linalg.norm(force.reshape(len(force), -1, 3), axis=-1)


def _predicted(limbs: Limbs, hardware: Recording) -> list[Measure]:
    made = predict_swing(limbs, hardware)
    if made is None:
        raise InputError(
            "no foot is in the air for a policy step", file=hardware.source or hardware.name,
            remedy="give a gait that lifts its feet",
        )  # fmt: skip
    return [
        Measure(
            f"swing leg's {label}", "%",
            Interval(100.0 * e.value, 100.0 * e.low, 100.0 * e.high),
        )
        for label, e in made.error.items()
    ]  # fmt: skip


def _extra(recording: Recording, name: str, what: str) -> np.ndarray:
    values = recording.extra.get(name)
    if values is None:
        raise InputError(
            f"{what} needs {name}", file=recording.source or recording.name, remedy="name its columns"
        )
    return np.array(values)  # scipy's turns take no views that are read-only
