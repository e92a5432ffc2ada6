"""Torque of a log from its known loop: where none was logged, and between rows of a loop that is faster."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.core import Recording
from workbench.effects import compile_plant
from workbench.models import Model
from workbench.simulation import law_torque, prepare, scored_torque, smooth_track

from .inverse import cutoff_hz
from .noise import NoiseModel

_KINDS = ("pd", "cascade_pv")
_MOMENT = 1e-3  # of a row: what stands at the row itself


def with_torque_by_law(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...] | None:
    """Return the recordings, with ``torque_measured`` from the law of the loop where the log leaves it open.

    That is all of it where none was logged. A loop that is faster than its log changes the torque between
    rows, while a log shows that of its rows: what the law changes until the next row is added to it, because
    a reference that stands still between rows would look like damping and inertia on all axes. None where
    neither torque nor law is known. The motion is smoothed as it is for inverse dynamics.
    """
    if any(r.controller.kind not in _KINDS for r in recordings if scored_torque(r) is None):
        return None
    opened = [_leaves_open(model, r) for r in recordings]
    if not any(opened):
        return tuple(recordings)
    plant, levels = compile_plant(model), NoiseModel.of(recordings).levels
    out = []
    for r, leaves_open in zip(recordings, opened, strict=True):
        if not leaves_open:
            out.append(r)
            continue
        to_actuator = r.to_actuator(model.transmission)
        band = 1.5 * cutoff_hz(r)
        track = smooth_track(r, None, to_actuator, levels.position_std, levels.velocity_std, band)
        torque = law_torque(r, plant, track)
        if scored_torque(r) is None:
            made = r.with_signals(torque_measured=torque @ to_actuator)
            out.append(replace(made, derived=(*r.derived, "torque_measured")))
        else:
            change = torque - law_torque(r, plant, track, window=_MOMENT)
            out.append(r.with_signals(torque_measured=r.signals["torque_measured"] + change @ to_actuator))
    return tuple(out)


def _leaves_open(model: Model, recording: Recording) -> bool:
    """Return whether no torque was logged, or a known loop changes the measured one between rows."""
    name = scored_torque(recording)
    if name is None:
        return True
    if name != "torque_measured" or recording.controller.kind not in _KINDS:
        return False
    if recording.get("position_reference") is None:
        return False
    return prepare(recording, model).ticks_between_rows
