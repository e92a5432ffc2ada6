"""One recording on the ground, prepared for simulation in short windows from measured states."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from workbench.core import Controller, InputError, Recording
from workbench.effects import FEWEST_SLIPS, Contact, Plant, effect_named, kinds, ratio_in_slip
from workbench.models import Model
from workbench.recordings import NoiseLevels
from workbench.recordings.resample import looks_held
from workbench.simulation import GROUND_TORQUE, Windows, scored_torque, shoot

from .feet import Feet
from .floating import floats
from .starts import choose_starts, half_rows, local_state

FORCE = "ground_force"
_LIGHT = 0.25  # of what a foot carries at most
_PRESSED, _LEAST = 6.0, 0.02  # of the force's noise, of its largest: a foot that touches


def on_ground(recording: Recording) -> bool:
    """Return whether a recording was made on the ground: it has a ground force or a floating base."""
    return FORCE in recording.extra or floats(recording)


def check_ground(model: Model, recording: Recording) -> None:
    """Refuse a recording on the ground that this model cannot simulate.

    Raises:
        InputError: the model has no ground, or other feet; no torque was recorded; or an effect has a state
            that no sensor shows.
    """

    def refuse(problem: str, column: str, remedy: str) -> InputError:
        return InputError(problem, file=recording.source, column=column, remedy=remedy)

    measured = recording.extra.get(FORCE)
    if model.ground is None:
        raise refuse(
            f"the recording is on the ground, but model '{model.name}' has no ground",
            f"columns.{'base_position' if measured is None else FORCE}",
            "add a [ground] table to the model (docs/models.md), or leave these columns out",
        )  # fmt: skip
    forces, feet = 0 if measured is None else measured.shape[1], len(model.ground.feet)
    if measured is not None and forces != 3 * feet:
        raise refuse(
            f"{forces} columns, and model '{model.name}' has {feet} feet", f"columns.{FORCE}",
            "give fx, fy, fz for every foot, in the order of ground.feet",
        )  # fmt: skip
    if scored_torque(recording) is None:
        raise refuse(
            "no torque was recorded", "columns.torque_measured",
            "on the ground a model runs under the logged torque: name its column",
        )  # fmt: skip
    for applied in model.effects:
        if kinds.has_hidden_state(effect_named(applied.key.effect)):
            raise refuse(
                f"{applied.key} has a state that no sensor shows", "effects",
                f"on the ground, models start from measured states: leave {applied.key} out",
            )  # fmt: skip


@dataclass(frozen=True)
class Standing:
    """One recording on the ground, prepared for any model.

    Attributes:
        recording: with what the ground's force is to the drives as a signal, rows outside of windows masked.
        windows: from measured states.
        to_actuator: (n, n), positions of the recording to actuator coordinates.
        feet: along the measured motion, by the model that was given first.
        force: as measured, (N, 3 F); zero where it was not.
        velocity_noise: (n,) of the measured states, actuator coordinates.
    """

    recording: Recording
    windows: Windows
    to_actuator: np.ndarray
    feet: Feet
    force: np.ndarray
    velocity_noise: np.ndarray

    def run(self, plant: Plant | None) -> Recording:
        """Return the recording as a plant on its ground makes it; NaN without a plant."""
        r = self.recording
        if plant is None:
            lost = {name: np.full_like(values, np.nan) for name, values in r.signals.items()}
            return replace(r, signals=lost, notes=(), source=None)
        shots = shoot(plant, self.windows)
        back = np.linalg.inv(self.to_actuator).T
        signals = {"position": shots.position @ back, "velocity": shots.velocity @ back}
        signals["torque_command"] = signals["torque_measured"] = self.windows.torque @ self.to_actuator
        signals[GROUND_TORQUE] = self.torque(shots.force if FORCE in r.extra else np.zeros_like(shots.force))
        before = slice(0, int(self.windows.starts[0]))
        for name, values in signals.items():
            values[before] = r.signals.get(name, values)[before]
        return replace(r, signals=signals, extra={FORCE: shots.force}, derived=(), notes=(), source=None)

    def torque(self, force: np.ndarray) -> np.ndarray:
        """Return the torque (N, n) on the axes of the recording that is equivalent to forces on the feet (N,
        3 F).
        """
        return self.feet.torque(force) @ self.to_actuator


def stand(
    recording: Recording, plant: Plant, levels: NoiseLevels, stride: int, force_noise: float
) -> Standing:
    """Return a recording prepared for windows, by a plant on its ground.

    Args:
        recording: as it was read.
        plant: says where feet are.
        levels: noise of the sensors.
        stride: substeps in a row.
        force_noise: of the force on the feet [N].

    Raises:
        InputError: it is too short.
    """
    to_actuator = recording.to_actuator(plant.model.transmission)
    force = recording.extra.get(FORCE)
    starts = choose_starts(recording, force)
    if len(starts) == 0:
        raise InputError(
            f"{len(recording)} rows are too few to run windows in", file=recording.source,
            remedy="record for longer",
        )  # fmt: skip
    q, w, spread = local_state(recording, levels)
    torque = tap_torque(recording, to_actuator)
    windows = Windows(starts, q @ to_actuator.T, w @ to_actuator.T, torque, recording.period, stride)
    feet = Feet.along(plant, windows.position)
    signals, valid = dict(recording.signals), _whole(recording, starts)
    if on_ground(recording):
        light = _LIGHT if floats(recording) else 0.0  # one leg on a fixed base has no other to lean on
        half = half_rows(recording.period)
        valid &= _while_feet_are_sure(starts, half, force, force_noise, feet.depth, light)
    if force is None:
        # nor is there a torque to be held against: a signal that never moves is left out
        force = np.zeros((len(recording), 3 * len(plant.contacts)))
    signals[GROUND_TORQUE] = feet.torque(force) @ to_actuator
    noise = np.abs(to_actuator) @ spread
    contact = feet.contact(windows.velocity, force, force_noise, noise)
    notes = (*recording.notes, *_notes(contact, FORCE in recording.extra))
    # the torque that was logged drives every window, whatever loop it came from
    loop = Controller("none") if recording.controller.kind == "unknown" else recording.controller
    replayed = replace(recording, signals=signals, valid=valid, notes=notes, controller=loop)
    return Standing(replayed, windows, to_actuator, feet, force, noise)


def without_ground(recording: Recording) -> Recording:
    """Return a recording without the torque of the ground in the drives."""
    signals = {name: values for name, values in recording.signals.items() if name != GROUND_TORQUE}
    return replace(recording, signals=signals)


def tap_torque(recording: Recording, to_actuator: np.ndarray) -> np.ndarray:
    """Return the measured torque over each row, (N, n), actuator coordinates: held, or interpolated between
    two rows.
    """
    name = scored_torque(without_ground(recording))
    assert name is not None
    tap = recording.signals[name] @ np.linalg.inv(to_actuator)
    command = recording.get("torque_command")
    held = looks_held(tap) or (command is not None and looks_held(command)) or _a_tick_a_row(recording)
    return tap if held else 0.5 * (tap + np.vstack([tap[1:], tap[-1:]]))


def _a_tick_a_row(recording: Recording) -> bool:
    """Whether a loop computes at rows alone, so that its torque changes there and nowhere else."""
    period = recording.controller.period_s
    rows = 0.0 if period is None else period / recording.period
    return rows > 0.5 and abs(rows - round(rows)) < 1e-3


def _whole(recording: Recording, starts: np.ndarray) -> np.ndarray:
    """Rows (N,) of windows in which, and about whose starts, every row was measured."""
    half, rows = half_rows(recording.period), len(recording)
    out = np.zeros(rows, bool)
    for start, end in zip(starts, np.append(starts[1:], rows), strict=True):
        out[start:end] = recording.valid[max(start - half, 0) : max(end, start + half + 1)].all()
    return out


def _notes(contact: Contact, measured: bool) -> tuple[str, ...]:
    """How the recording is run, and what it says of friction where a foot never slips."""
    how = "run in short windows from measured states, under the logged torque"
    if not measured:
        return (f"{how}; without the ground's force, position alone is compared",)
    notes = [f"on the ground: {how}; 'torque' is the ground's force expressed as torque of the axes"]
    held = contact.pressed > 10.0 * contact.force_noise
    if held.any() and len(ratio_in_slip(contact)) < FEWEST_SLIPS:
        least = float(np.quantile(contact.dragged[held] / contact.pressed[held], 0.99))
        notes.append(f"no foot slips, so only a lower limit of the ground's friction is known: {least:.2f}")
    return tuple(notes)


def _while_feet_are_sure(
    starts: np.ndarray, half: int, force: np.ndarray | None, noise: float, depth: np.ndarray, light: float
) -> np.ndarray:
    """Rows (N,) up to the first in their window in which nobody can say what a foot does.

    Where in a row a foot lands decides how hard, and how it bounces; and one that hardly carries, less than
    a share `light` of what it does at most, holds, slips or lifts by next to nothing. No log tells, and all
    that follows until the next window depends on it. Windows that begin there follow a velocity that jumps.
    """
    load, least = depth, np.zeros(depth.shape[1])
    if force is not None:
        load = np.linalg.norm(force.reshape(len(force), -1, 3), axis=-1)
        least = np.maximum(_PRESSED * noise, _LEAST * load.max(axis=0))
    pressed = load > least
    doubt = np.diff(pressed.astype(int), axis=0, prepend=pressed[:1]).max(axis=1, initial=0) > 0
    doubt |= (pressed & (load < light * np.quantile(load, 0.9, axis=0))).any(axis=1)
    out = np.ones(len(doubt), bool)
    for start, end in zip(starts, np.append(starts[1:], len(out)), strict=True):
        hits = np.flatnonzero(doubt[start:end])
        # a foot touches a row before its force is seen
        last = start + max(hits[0] - 1, 0) if len(hits) else end
        out[start if doubt[max(start - half, 0) : start + half + 1].any() else last : end] = False
    return out
