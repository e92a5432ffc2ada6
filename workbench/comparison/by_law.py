"""Torque of a log without torque: computed from the known loop along the measured motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from workbench.core import Recording
from workbench.effects import compile_plant
from workbench.models import Model
from workbench.simulation import law_torque, scored_torque, smooth_track

from .inverse import cutoff_hz
from .noise import NoiseModel

_KINDS = ("pd", "cascade_pv")


def with_torque_by_law(model: Model, recordings: Sequence[Recording]) -> tuple[Recording, ...] | None:
    """Return the recordings; those without a measured torque get ``torque_measured`` from the law of their
    loop.

    None where one has neither. The motion is smoothed as it is for inverse dynamics.
    """
    if all(scored_torque(r) is not None for r in recordings):
        return tuple(recordings)
    if any(r.controller.kind not in _KINDS for r in recordings if scored_torque(r) is None):
        return None
    plant, levels = compile_plant(model), NoiseModel.of(recordings).levels
    out = []
    for r in recordings:
        if scored_torque(r) is not None:
            out.append(r)
            continue
        to_actuator = r.to_actuator(model.transmission)
        band = 1.5 * cutoff_hz(r)
        track = smooth_track(r, None, to_actuator, levels.position_std, levels.velocity_std, band)
        torque = law_torque(r, plant, track) @ to_actuator
        made = r.with_signals(torque_measured=torque)
        out.append(replace(made, derived=(*r.derived, "torque_measured")))
    return tuple(out)
