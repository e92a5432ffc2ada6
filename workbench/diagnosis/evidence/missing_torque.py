"""The residual torque along the measured motion, and the quantities that it may depend on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from workbench.comparison import is_free
from workbench.comparison.inverse import lowpass, torque_at_tap
from workbench.core import Recording
from workbench.effects import axis_units, compile_plant
from workbench.models import Model
from workbench.recordings import NoiseLevels
from workbench.simulation import Track, edge_rows, required_torque, scored_torque, smooth_track

_STEP_S = 0.01  # between the rows that are looked at


@dataclass(frozen=True, eq=False)
class Missing:
    """The residual torque along the measured motion, recordings concatenated.

    Attributes:
        torque: measured less required torque, (N, n), each recording's mean taken off [N m or N].
        position, speed: of the motion, (N, n).
        acceleration: of it, (N, n), zero where nothing drives the machine; load: the torque that the model
            needs for it, (N, n), zero on axes that nothing drives.
        time: since the start of each recording, (N,) [s].
        temperature: (N, n) [K], or None where one recording has none.
        start: rows at which recordings start.
        step: between rows [s].
        axes, units: of the columns.
    """

    torque: np.ndarray
    position: np.ndarray
    speed: np.ndarray
    acceleration: np.ndarray
    load: np.ndarray
    time: np.ndarray
    temperature: np.ndarray | None
    start: tuple[int, ...]
    step: float
    axes: tuple[str, ...]
    units: tuple[str, ...]

    def in_joints(self, transmission: np.ndarray) -> Missing:
        """The same in joint coordinates: tau_s = J^T tau_p, q_p = J q_s (paper, Eq. 4)."""
        back = np.linalg.inv(transmission).T
        return replace(
            self,
            torque=self.torque @ transmission,
            load=self.load @ transmission,
            position=self.position @ back,
            speed=self.speed @ back,
            acceleration=self.acceleration @ back,
        )


def missing_torque(
    model: Model, measured: Sequence[Recording], simulated: Sequence[Recording], levels: NoiseLevels
) -> Missing | None:
    """Return the torque residual by inverse dynamics, at one row every few milliseconds; actuator
    coordinates.

    Args:
        model: that lacks something.
        measured: recordings; those without a torque are left out.
        simulated: the model's run of each, which the motion is smoothed about.
        levels: of the sensors' noise.

    Returns:
        None where no recording has a torque.
    """
    plant, parts, warm = compile_plant(model), [], []
    for recording, run in zip(measured, simulated, strict=True):
        if scored_torque(recording) is None or len(recording) < 100:
            continue
        to_actuator = recording.to_actuator(model.transmission)
        # what nothing drives begins anew at each swing
        free = is_free(recording)
        about = None if free else run
        track = smooth_track(recording, about, to_actuator, levels.position_std, levels.velocity_std)
        tap = torque_at_tap(plant, recording, track, to_actuator)
        stride = max(1, round(_STEP_S / recording.period))
        edge = edge_rows(len(recording), recording.period)
        rows = slice(edge, len(recording) - edge, stride)
        thin = Track(
            *(lowpass(x, recording)[rows] for x in (track.position, track.velocity, track.acceleration))
        )
        needed = required_torque(plant, thin)
        rest = lowpass(tap, recording)[rows] - needed
        good = recording.valid[rows]
        heat = recording.get("temperature")
        warm.append(None if heat is None else heat[rows][good])
        pushed = np.zeros_like(needed) if free else thin.acceleration
        load = np.where(np.any(tap, axis=0), needed, 0.0)  # what is lacking where nothing drives, is all load
        columns = (rest - rest[good].mean(axis=0), thin.position, thin.velocity, pushed, load)
        parts.append((*(c[good] for c in columns), recording.time[rows][good], stride * recording.period))
    if not parts:
        return None
    stacked = [np.concatenate([p[k] for p in parts]) for k in range(6)]
    heated = None if any(w is None for w in warm) else np.concatenate([w for w in warm if w is not None])
    start = np.cumsum([0, *(len(p[0]) for p in parts[:-1])])
    return Missing(
        *stacked,
        temperature=heated,
        start=tuple(int(k) for k in start),
        step=parts[0][6],
        axes=model.axes,
        units=tuple(axis_units(model)),
    )
