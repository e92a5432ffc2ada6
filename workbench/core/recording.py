"""A recording: one frozen table of named signals, measured or simulated, on a uniform clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, SupportsIndex, overload

import numpy as np

from .shown import Shown

FloatArray = np.ndarray

#: Signals with one column per axis and the unit kind of each.
AXIS_SIGNALS: Mapping[str, str] = MappingProxyType(
    {
        "position": "position",
        "velocity": "velocity",
        "torque_command": "torque",
        "torque_measured": "torque",
        "torque_feedforward": "torque",
        "position_reference": "position",
        "velocity_reference": "velocity",
        "link_position": "position",
        "current": "current",
        "voltage": "voltage",
        "temperature": "temperature",
    }
)


@dataclass(frozen=True)
class Controller:
    """The loop that was closed while the recording was made.

    ``pd``: torque = kp (q_ref - q) + kd (v_ref - v) in `coordinates`, kp [N m/rad], kd [N m s/rad]
    (of a linear axis N/m and N s/m).
    ``cascade_pv``: volts = kv (kp (q_ref - q) - v), clipped at `limit` [V]; torque = gain * volts,
    kp [1/s], kv [V s/m or V s/rad], gain [N/V or N m/V]. ``none``: open loop, `torque_command` is the
    input. ``unknown``: the loop cannot be simulated; only inverse dynamics can be compared.

    All per-axis values have shape (n,). `period_s` is the sample-and-hold period [s]. `velocity`: whether the
    loop's speed is that of a sensor or the difference of positions over a period; None: as the recordings
    show it.
    """

    kind: Literal["none", "pd", "cascade_pv", "unknown"] = "unknown"
    coordinates: Literal["joint", "actuator"] = "actuator"
    kp: tuple[float, ...] = ()
    kd: tuple[float, ...] = ()
    kv: tuple[float, ...] = ()
    gain: tuple[float, ...] = ()
    limit: tuple[float, ...] = ()
    period_s: float | None = None
    velocity: Literal["sensor", "difference"] | None = None


@dataclass(frozen=True)
class Excitation:
    """The excitation of the system: `kind` and the keys of the recording's ``[excitation]`` table.

    `lines`: which harmonics of the period were excited: ``"full"``, ``"odd"``, ``"odd_random"``,
    ``"every_N"`` (N apart, wherever they begin), or their numbers.
    """

    kind: str = "reference"
    mode: str | None = None
    period_s: float | None = None
    f_min_hz: float | None = None
    f_max_hz: float | None = None
    lines: str | tuple[int, ...] | None = None


@dataclass(frozen=True)
class Timing:
    """Assumptions about holds, start and delay of the log (``[timing]``).

    `feedforward_held`: the feedforward is sampled with the controller and held (else it acts per row).
    `reference_held`: at ticks of the loop between rows the reference is that of the row before (else it goes
    on smoothly); None: as the recordings show it.
    `stepped`: MuJoCo ran the model's file: with its steps, its integrator and its dry friction.
    `soft_friction`: MuJoCo ran it in fine steps: dry friction is as soft as the file makes it. Both None: as
    the recordings show it.
    `initial_at_rest`: the run starts at rest at the first reference (else the state is fitted).
    `delay`: where the loop's delay was applied: ``"motor"`` (the model's T_d applies) or ``"loop"``
    (`torque_command` already carries it).
    """

    feedforward_held: bool = True
    initial_at_rest: bool = True
    delay: Literal["motor", "loop"] = "motor"
    reference_held: bool | None = None
    stepped: bool | None = None
    soft_friction: bool | None = None

    @property
    def by_mujoco(self) -> bool:
        """Return whether MuJoCo made the recording, so that it has the soft friction of the model's file."""
        return bool(self.stepped or self.soft_friction)


@dataclass(frozen=True, repr=False)
class Recording(Shown):
    """One experiment, SI units, uniform clock, N rows and n axes.

    Attributes:
        name: the recording's name.
        axes: axis names, length n, the order of every column.
        coordinates: ``"actuator"`` (q_p) or ``"joint"`` (q_s): coordinates of the signals.
        time: row times [s], shape (N,), uniform, first row 0.
        signals: name of `AXIS_SIGNALS` -> array (N, n); a missing signal is absent. ``position`` is
            always there.
        units: SI unit per axis of position, ``"rad"`` or ``"m"``, length n.
        valid: rows that count, shape (N,) bool; masked ones were not measured and hold interpolated numbers,
            or were measured while a drive was off.
        derived: names of signals that were computed rather than measured (e.g. ``"velocity"``).
        notes: what the reader did to the data, one sentence each ("clock jitter of 2 % resampled").
        extra: other columns by signal name, each (N, k) (ground_force, base_...).
        source: the TOML file it came from, if any.
        steps: signal -> steps (n,) in which its sensor shows it, 0 where in none; of signals that were
            moved onto the clock, whose own numbers no longer say.
        late_s: how far from their times rows were taken, rms [s], by a clock that jitters. Signals were moved
            onto the clock; what a loop read of these rows was not. 0 where the loop is seen to keep time.
        guessed: signal -> rows (N,) bool that no row of the log shows, made of those beside; of signals whose
            rows are few enough for a loop to tick between them unseen.
        guessed_units: kinds (``"position"``, ``"torque"``...) whose units an import guessed by size.
    """

    name: str
    axes: tuple[str, ...]
    coordinates: Literal["actuator", "joint"]
    time: FloatArray
    signals: Mapping[str, FloatArray]
    units: tuple[str, ...]
    controller: Controller = field(default_factory=Controller)
    excitation: Excitation = field(default_factory=Excitation)
    timing: Timing = field(default_factory=Timing)
    rig: str = ""
    valid: FloatArray = None  # pyright: ignore[reportAssignmentType]  (None: all rows)
    derived: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    extra: Mapping[str, FloatArray] = field(default_factory=dict)
    source: Path | None = None
    steps: Mapping[str, FloatArray] = field(default_factory=dict)
    late_s: float = 0.0
    guessed: Mapping[str, FloatArray] = field(default_factory=dict)
    guessed_units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        frozen = {k: _readonly(v) for k, v in self.signals.items()}
        object.__setattr__(self, "signals", MappingProxyType(frozen))
        object.__setattr__(self, "extra", MappingProxyType({k: _readonly(v) for k, v in self.extra.items()}))
        object.__setattr__(self, "time", _readonly(self.time))
        valid = np.ones(len(self.time), bool) if self.valid is None else self.valid
        object.__setattr__(self, "valid", _readonly(np.asarray(valid, bool)))

    def __getstate__(self) -> dict[str, Any]:
        # views of tables cannot be pickled
        return {**self.__dict__, "signals": dict(self.signals), "extra": dict(self.extra)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()

    def __len__(self) -> int:
        return len(self.time)

    @property
    def period(self) -> float:
        """Return the row period [s]."""
        return float((self.time[-1] - self.time[0]) / (len(self.time) - 1))

    @property
    def duration(self) -> float:
        """Return the time from the first row to the last [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def position(self) -> FloatArray:
        """Return the measured position (N, n) [rad or m]."""
        return self.signals["position"]

    @property
    def velocity(self) -> FloatArray:
        """Return the velocity (N, n) [rad/s or m/s]; measured, unless ``"velocity"`` is in `derived`."""
        return self.signals["velocity"]

    def to_actuator(self, transmission: FloatArray) -> FloatArray:
        """The matrix (n, n) from positions in its coordinates to drive positions; `transmission`: J."""
        return np.eye(len(transmission)) if self.coordinates == "actuator" else transmission

    def get(self, signal: str) -> FloatArray | None:
        """Return a signal (N, n), or None if the recording does not have it."""
        return self.signals.get(signal)

    def with_signals(self, **signals: FloatArray) -> Recording:
        """Return a copy with these signals added or replaced, each (N, n)."""
        return replace(self, signals={**self.signals, **signals})

    def rows(self, part: slice) -> Recording:
        """Return a recording of some of the rows, with time counted from the first of them [s]."""
        return replace(
            self,
            time=self.time[part] - self.time[part][0],
            signals={name: values[part] for name, values in self.signals.items()},
            extra={name: values[part] for name, values in self.extra.items()},
            valid=self.valid[part],
            guessed={name: values[part] for name, values in self.guessed.items()},
        )


def _readonly(array: FloatArray) -> FloatArray:
    out = np.asarray(array).view()
    out.flags.writeable = False
    return out


class Recordings(Shown, list[Recording]):
    """Several recordings: a list that shells and notebooks show in a few lines."""

    @overload
    def __getitem__(self, index: SupportsIndex) -> Recording: ...
    @overload
    def __getitem__(self, index: slice) -> Recordings: ...
    def __getitem__(self, index: SupportsIndex | slice) -> Recording | Recordings:
        """Return one of them, or several of them as such a list."""
        found = super().__getitem__(index)
        return Recordings(found) if isinstance(found, list) else found
