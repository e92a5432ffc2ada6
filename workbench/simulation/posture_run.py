"""A mechanism whose transmission changes with the posture, run round the loop of a recording.

The equation of motion is the closed chain's own, as series over its limits (`s3n.PostureDependent`), and
not a fitted file. Loops are PD in joint or in drive coordinates, or none. Time goes in pieces of half a
millisecond at most; a torque that comes late acts in its share of a piece. Several runs of one recording go
side by side: without noise, and with draws of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import InputError, Recording, SimulationError
from workbench.core.drive_map import NEWTON, THERE
from workbench.models import Model
from workbench.recordings.quantisation import quantisation_step
from workbench.s3n import PostureDependent, drive_map
from workbench.s3n.posture import BEYOND

from .control import SensorNoise
from .experiment import Experiment, prepare, whole_and_part
from .initial_state import initial_state
from .posture_drives import drives_of
from .posture_start import refined
from .posture_step import advance, asked, shown

_FASTEST = 1e4  # rad/s
_PIECE = 0.5e-3  # s


class PosturePlant:
    """The mechanism of a model and its drives.

    Args:
        model: names its closed chain and limits.

    Raises:
        InputError: an effect in it that these runs do not have, or a closed chain without limits.
    """

    def __init__(self, model: Model) -> None:
        self.drives = drives_of(model)
        self.model, self.chain = model, PostureDependent(model)
        found = drive_map(model, self.chain)
        assert found is not None
        self.map = found
        self.polynomials = found.middle, found.half, found.powers, found.factors

    def acceleration(self, q: np.ndarray, v: np.ndarray, torque: np.ndarray) -> np.ndarray:
        """Return accelerations of the joints (B, n) for drive torques (B, n) [N m].

        Raises:
            SimulationError: far outside the limits.
        """
        v, found = v.copy(), np.zeros_like(v)
        self.advance(q.copy(), v, found, torque[None], 0.0)
        return found

    def advance(self, q: np.ndarray, v: np.ndarray, last: np.ndarray, torques: np.ndarray, h: float) -> None:
        """Move states of the joints on, in place.

        Args:
            q: positions (B, n) [rad or m].
            v: speeds (B, n) [rad/s or m/s].
            last: accelerations of the piece before (B, n).
            torques: of the drives in each piece (pieces, B, n) [N m].
            h: length of a piece [s].

        Raises:
            SimulationError: far outside the limits.
        """
        series, sizes = self.chain.series
        lost = advance(series, sizes, self.chain.box, self.drives, BEYOND, h, q, v, last, torques)
        if lost >= 0:
            self.chain.nearest_inside(q[[lost]])  # which says what is wrong there


def run_posture(
    plant: PosturePlant, recording: Recording, noise: Sequence[SensorNoise | None], late: float = 0.0
) -> list[Recording]:
    """Return runs of one recording, one per draw of noise; None simulates without noise.

    Args:
        plant: the mechanism.
        recording: in drive coordinates, its loop known.
        noise: of each run's sensors.
        late: what torques come later than the model says [s].

    Raises:
        InputError: a recording in joint coordinates, or a cascade.
        SimulationError: the mechanism leaves its workspace, or runs away.
    """
    e = prepare(recording, plant.model)
    _refuse(e, recording)
    start = _start(plant, e)
    if start[1].any():  # logged in the middle of a motion
        start = refined(
            start, recording, lambda starts: _run(plant, e, starts, [None] * len(starts), late)[0]
        )
    logged = _run(plant, e, np.tile(start, (len(noise), 1, 1)), noise, late)
    names = ("position", "velocity", "torque_command", "torque_measured")
    return [recording.with_signals(**dict(zip(names, each, strict=True))) for each in logged.swapaxes(0, 1)]


def _run(
    plant: PosturePlant, e: Experiment, starts: np.ndarray, noise: Sequence[SensorNoise | None], late: float
) -> np.ndarray:
    """Return positions, speeds, commands and torques (4, B, N, n) of runs from starts (B, 2, n) of drives."""
    recording, count = e.recording, len(noise)
    rows, n = recording.position.shape
    sensors = _Sensors(noise, recording)
    q = plant.map.joints(starts[:, 0])
    v = plant.map.joint_speed(q, starts[:, 1])
    pieces = max(1, round(e.step / _PIECE))
    h, last = e.step / pieces, np.zeros_like(q)
    whole, share = whole_and_part((e.delay(plant.model.actuators.delay_s, plant.model) + late) / h)
    waiting = [np.tile(e.before, (count, 1))] * (whole + 2)
    limit, ticks = np.array(plant.model.actuators.torque_limit), set((e.ticks // e.stride).tolist())
    wish, logged = waiting[0], np.zeros((4, count, rows, n))
    for row in range(rows):
        read, rate = sensors.read(row, *shown(*plant.polynomials, q, v))
        if row in ticks:
            wish = sensors.sent(np.clip(_asked(plant, e, row, read, rate, q), -limit, limit))
        acting = []
        for k in range(e.stride * pieces):
            waiting = [*waiting[1:], wish]
            if k == 0:  # a sensor of torque shows what acts as the row begins
                logged[:, :, row] = read, rate, wish, sensors.torque(row, waiting[0 if share else 1])
            acting.append(share * waiting[0] + (1.0 - share) * waiting[1])
        if row < rows - 1:
            plant.advance(q, v, last, np.array(acting), h)
        if not np.abs(v).max() < _FASTEST:
            raise SimulationError(
                f"model '{plant.model.name}' becomes unstable in the loop of '{recording.name}'"
            )
    return logged


class _Sensors:
    """Noise of B runs, drawn beforehand, and what a bus leaves of commands."""

    def __init__(self, noise: Sequence[SensorNoise | None], recording: Recording) -> None:
        self._noise = noise
        rows, n = recording.position.shape
        command = recording.get("torque_command")
        steps = [quantisation_step(x) for x in command.T] if command is not None else [0.0] * n
        noisy = np.array([each is not None for each in noise])
        self._steps = np.where(noisy[:, None], steps, 0.0)
        self._draws = [np.zeros((3, rows, n)) if each is None else each.draws(rows) for each in noise]

    def read(self, row: int, position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions and speeds (B, n) as they are shown."""
        position, velocity = position.copy(), velocity.copy()
        for b, (noise, draw) in enumerate(zip(self._noise, self._draws, strict=True)):
            if noise is not None:
                position[b] = noise.read_position(position[b], draw[0, row])
                velocity[b] += noise.velocity_std * draw[1, row]
        return position, velocity

    def sent(self, torque: np.ndarray) -> np.ndarray:
        """Commands (B, n) rounded as those of the recording are, which is noise too."""
        safe = np.where(self._steps > 0.0, self._steps, 1.0)
        return np.where(self._steps > 0.0, np.round(torque / safe) * safe, torque)

    def torque(self, row: int, torque: np.ndarray) -> np.ndarray:
        """Torques (B, n) as they are shown."""
        torque = torque.copy()
        for b, (noise, draw) in enumerate(zip(self._noise, self._draws, strict=True)):
            if noise is not None:
                torque[b] += noise.torque_std * draw[2, row]
        return torque


def refuse_joint_coordinates(recording: Recording) -> None:
    """Refuse a recording in joint coordinates if the transmission changes with the posture.

    Raises:
        InputError: it is in joint coordinates.
    """
    if recording.coordinates != "actuator":
        raise InputError(
            "it is in joint coordinates, and the transmission changes with the posture",
            file=recording.source, column="coordinates", remedy="record the drives' own positions",
        )  # fmt: skip


def _refuse(e: Experiment, recording: Recording) -> None:
    refuse_joint_coordinates(recording)
    if e.controller.kind not in ("pd", "none"):
        raise InputError(
            f"a loop of kind '{e.controller.kind}' is not run on a mechanism whose transmission changes",
            file=recording.source, column="controller.kind", remedy="state a PD loop, or none",
        )  # fmt: skip


def _asked(
    plant: PosturePlant, e: Experiment, row: int, q: np.ndarray, w: np.ndarray, near: np.ndarray
) -> np.ndarray:
    """Torques asked of the drives (B, n), of what sensors show; `near`: where the joints are (B, n)."""
    if e.replayed is not None:
        return np.broadcast_to(e.replayed[row], q.shape)
    kp, kd = np.array(e.controller.kp), np.array(e.controller.kd)
    wanted, rate = e.reference[row], e.reference_rate[row]
    if e.controller.coordinates == "actuator":
        return kp * (wanted - q) + kd * (rate - w) + e.feedforward[row]
    goal = np.stack([wanted, rate])
    return asked(*plant.polynomials, NEWTON, THERE, np.stack([kp, kd]), goal, q, w, near) + e.feedforward[row]


def _start(plant: PosturePlant, e: Experiment) -> np.ndarray:
    """Positions and speeds of the drives (2, n) as the first rows show them."""
    n, reference = plant.model.size, e.reference
    if e.controller.coordinates == "joint":
        reference = plant.map.drives(reference[:1])
    told = None if e.recording.get("position_reference") is None else reference
    stated = replace(e.controller, coordinates="actuator")
    return initial_state(e.recording, stated, told, np.eye(n), np.eye(n))
