"""A recording as instructions: what to replay, when the controller samples, and where the run starts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.interpolate import CubicSpline

from workbench.core import Controller, InputError, Recording
from workbench.models import Model, joint_kinds
from workbench.recordings.resample import looks_held

from .feedforward import feedforward_of_drives
from .initial_state import initial_state
from .steps import steps_of

_FIRST, _CLEARLY = 8, 3.0  # rows that show how torques scatter; deviations by which two are not the same
#: Signal of what the ground's force on the feet is to the drives [N m or N], of recordings on the ground.
GROUND_TORQUE = "ground_torque"


@dataclass(frozen=True)
class Experiment:
    """One recording prepared for simulation on a grid of K substeps.

    Attributes:
        recording: what is replayed.
        controller: the loop, from the recording, or from the model where the recording says nothing.
        step: substep [s]; `stride` substeps make a row.
        stride: substeps per row.
        ticks: substeps at which the controller samples, ascending, first 0.
        reference, reference_rate: (N, n) in controller coordinates (zeros for an open loop).
        feedforward: (N, n) in actuator coordinates.
        replayed: (N, n) torque command in actuator coordinates for an open loop, else None.
        behind: which delays the replayed torque has behind it already: ``"none"``, the model's own
            (``"motor"``), or ``"all"`` (it was measured at the drive).
        start: initial q_s and its rate, (2, n).
        before: torques on their way to the drives as the recording begins, (n,) in actuator coordinates.
        to_actuator: (n, n), recording coordinates to actuator coordinates for positions.
        transmission: (n, n), q_p = J q_s.
    """

    recording: Recording
    controller: Controller
    step: float
    stride: int
    ticks: np.ndarray
    reference: np.ndarray
    reference_rate: np.ndarray
    feedforward: np.ndarray
    replayed: np.ndarray | None
    start: np.ndarray
    before: np.ndarray
    to_actuator: np.ndarray
    transmission: np.ndarray
    behind: Literal["none", "motor", "all"] = "none"

    @property
    def substeps(self) -> int:
        """Return the number of substeps K from the first row to the last."""
        return (len(self.recording) - 1) * self.stride

    @property
    def ticks_between_rows(self) -> bool:
        """Return whether the controller also samples between rows of the log."""
        return bool(np.any(self.ticks % self.stride))

    def at_ticks(self, rows: np.ndarray, held: bool | None = None) -> np.ndarray:
        """Return a signal (N, n) as read at T ticks (T, n): interpolated if smooth, constant if held.

        Where `held` does not say which it is, the signal does.
        """
        whole, rest = np.divmod(self.ticks, self.stride)
        held = looks_held(rows) if held is None else held
        if not rest.any() or held or len(rows) < 4:
            return rows[whole]
        return CubicSpline(np.arange(len(rows)), rows)(self.ticks / self.stride)

    def delay(self, total: float, model: Model) -> float:
        """Return the part of the chain's `total` delay [s] from replayed torque to mechanism."""
        gone = {"none": 0.0, "motor": model.actuators.delay_s, "all": total}[self.behind]
        return max(total - gone, 0.0)


def whole_and_part(steps: float) -> tuple[int, float]:
    """Return a delay in steps as a whole number and a fraction; a rounding error is no fraction."""
    whole = int(np.floor(steps + 1e-9))
    return whole, float(steps - whole) if steps - whole > 1e-9 else 0.0


def prepare(recording: Recording, model: Model) -> Experiment:
    """Return a recording prepared for simulation of a model.

    Raises:
        InputError: axes the model does not have, a loop that cannot be replayed, or steps that do not fit.
    """
    check_axes(recording, model)
    controller = recording.controller
    if (
        controller.kind == "unknown"
        and model.controller.kind != "unknown"
        and recording.get("position_reference") is not None
    ):
        controller = model.controller
    rows, n = recording.position.shape
    period = controller.period_s or recording.period
    steps = steps_of(recording, model)
    stride, step = steps.per_row, recording.period / steps.per_row
    j, identity = model.transmission, np.eye(n)
    to_actuator = recording.to_actuator(j)
    torque_to_actuator = identity if recording.coordinates == "actuator" else np.linalg.inv(j).T
    zero = np.zeros((rows, n))

    def torque(signal: str) -> np.ndarray | None:
        values = recording.get(signal)
        return None if values is None else values @ torque_to_actuator.T

    replayed, behind = None, "none"
    feedforward = recording.get("torque_feedforward")
    if feedforward is not None and not feedforward_of_drives(recording, controller, j):
        feedforward = torque("torque_feedforward")
    reference = recording.get("position_reference")
    if controller.kind == "none":
        replayed = torque("torque_command")
        behind = "motor" if recording.timing.delay == "loop" else "none"
        if replayed is None:
            replayed, behind = torque("torque_measured"), "all"
        if replayed is None:
            behind = "none"
            replayed = feedforward
        if replayed is None:
            raise InputError(
                "an open loop without any torque cannot be run", file=recording.source,
                column="torque_command",
                remedy="name the column of the torque command, one of zeros where nothing drives it",
            )  # fmt: skip
        period = recording.period
    elif controller.kind != "unknown" and reference is None:
        raise InputError(
            "a closed loop without a reference cannot be run", file=recording.source,
            column="position_reference",
            remedy="name its column, or state controller kind 'none' or 'unknown'",
        )  # fmt: skip
    count = int(np.floor((rows - 1) * stride * step / period + 1e-9)) + 1
    ticks = np.ceil(np.arange(count) * (period / step) - 1e-6).astype(int)
    ticks = ticks[np.diff(ticks, prepend=-1) > 0]
    return Experiment(
        recording=recording,
        controller=controller,
        step=step,
        stride=stride,
        ticks=ticks[ticks <= (rows - 1) * stride],
        reference=zero if reference is None else reference,
        reference_rate=zero
        if recording.get("velocity_reference") is None
        else recording.signals["velocity_reference"],
        feedforward=zero if feedforward is None else feedforward,
        replayed=replayed,
        start=initial_state(recording, controller, reference, to_actuator, j),
        before=_before(torque("torque_measured"), torque("torque_command"), n),
        to_actuator=to_actuator,
        transmission=j,
        behind=behind,
    )


def _before(measured: np.ndarray | None, command: np.ndarray | None, n: int) -> np.ndarray:
    """Torques that were commanded before the first row (n,), by signals in actuator coordinates (N, n).

    A drive was off, or its loop ran already: of nothing and the first command, what is nearer to the torque
    measured, where these are clearly not the same. Where none was measured, drives begin from nothing.
    """
    if measured is None:
        return np.zeros(n)
    sent = np.broadcast_to(measured[0], measured.shape) if command is None else command
    scatter = np.std((measured - sent)[:_FIRST], axis=0)
    ran = np.abs(measured[0]) > np.abs(measured[0] - sent[0])
    return np.where(ran & (np.abs(sent[0]) > _CLEARLY * scatter), sent[0], 0.0)


def scored_torque(recording: Recording) -> str | None:
    """Return the name of the torque that is compared: the measured one, else the command, else None.

    A "measured" torque that is the command itself, row for row, was not measured behind the drive. On the
    ground it is that of the ground.
    """
    if recording.get(GROUND_TORQUE) is not None:
        return GROUND_TORQUE
    command, measured = recording.get("torque_command"), recording.get("torque_measured")
    if measured is not None and (command is None or not np.array_equal(command, measured)):
        return "torque_measured"
    return None if command is None else "torque_command"


def check_axes(recording: Recording, model: Model) -> None:
    """Check that a recording's axes are the model's, in its order and of its kinds (hinge or slide).

    Raises:
        InputError: an axis is unknown, missing, out of order, or in the other kind's unit.
    """
    if tuple(recording.axes) == tuple(model.axes):
        _check_units(recording, model)
        return
    unknown = [axis for axis in recording.axes if axis not in model.axes]
    problem = (
        f"axis '{unknown[0]}' is not one of model '{model.name}'"
        if unknown
        else "axes differ from the model's"
    )
    raise InputError(
        problem, file=recording.source, column="axes",
        remedy=f"the model has {', '.join(model.axes)}, in this order",
    )  # fmt: skip


def _check_units(recording: Recording, model: Model) -> None:
    kinds = joint_kinds(model)
    for i, axis in enumerate(recording.axes):
        ways = np.abs(np.eye(model.size)[i] if recording.coordinates == "joint" else model.transmission[i])
        moved = {kind for kind, way in zip(kinds, ways, strict=True) if way > 0}
        if len(moved) > 1 or not np.isclose(ways.max(), 1.0):
            continue  # a screw's drive turns and its nut slides: the drive's unit is its own
        slides = moved == {"slide"}
        if slides != (recording.units[i] == "m"):
            moves = "moves along a line" if slides else "turns"
            taken = "a length" if recording.units[i] == "m" else "an angle"
            example = '"m" or "mm"' if slides else '"rad" or "deg"'
            raise InputError(
                f"axis '{axis}' of model '{model.name}' {moves}, but its position is recorded as {taken}",
                file=recording.source, column="units.position",
                remedy=f"give one unit per axis, {example} for this one",
            )  # fmt: skip
