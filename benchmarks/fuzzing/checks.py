"""What must hold of whatever was accepted."""

from __future__ import annotations

from typing import Any

import numpy as np


class Wrong(Exception):
    """What was accepted is not valid."""


def finite(what: str, *values: Any) -> None:
    """Raises `Wrong` where one of the arrays holds NaN or infinity."""
    for value in values:
        if not np.isfinite(np.asarray(value, float)).all():
            raise Wrong(f"{what} is not finite")


def check_recording(recording: Any) -> None:
    """A recording that every command may rely on."""
    rows, n = len(recording.time), len(recording.axes)
    step = np.diff(recording.time)
    if rows < 2 or not np.all(step > 0) or np.ptp(step) > 1e-6 * step.mean() + 1e-9:
        raise Wrong("the clock is not uniform")
    for name, values in recording.signals.items():
        if values.shape != (rows, n):
            raise Wrong(f"{name} has shape {values.shape}")
        finite(name, values)
    for name, values in recording.extra.items():
        finite(name, values)
    finite("the controller", *(getattr(recording.controller, k) for k in ("kp", "kd", "kv", "gain")))


def check_table(table: Any) -> None:
    """Columns of one length."""
    lengths = {len(v) for v in table.columns.values()}
    if len(lengths) != 1 or any(np.asarray(v).dtype.kind != "f" for v in table.columns.values()):
        raise Wrong(f"columns of {sorted(lengths)} rows")


def check_model(read: Any) -> None:
    """Numbers everywhere, and a tree that moves."""
    model, plant = read
    a = model.actuators
    finite("the model", model.transmission, a.inertia, a.damping, a.delay_s)
    if np.isnan(a.torque_limit).any():
        raise Wrong("a torque limit is NaN")
    if plant.mujoco.nv < model.size:
        raise Wrong("fewer freedoms than axes")
    finite("the compiled model", plant.mujoco.body_mass, plant.mujoco.dof_armature, plant.drives)


def check_design(design: Any) -> None:
    """A design with rows."""
    finite("the design", design.experiments, design.hold, np.abs(design.spectrum), design.rate_hz)
    if design.rows < 1:
        raise Wrong("no rows")


def check_bundle(read: Any) -> None:
    """Numbers in its control."""
    c = read.control
    finite("the bundle", c.transmission, c.posture, c.kp, c.kd, c.action_scale, c.control_period_s)
