"""Everything that effects need to know of a motion, from a recording and its track."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from workbench.core import Recording
from workbench.effects import Line, Motion, Plant, axis_units, compile_plant, rotor_inertia, tendon_leads
from workbench.inspection.torque import command_limits
from workbench.models import Model, axis_tendon, rotors

from .carried import carried_inertia
from .clamped import before_clamp
from .experiment import Experiment, prepare, scored_torque
from .inverse import gain_along, required_torque
from .known_rows import known_rows
from .native import com_slopes, mass_matrices
from .postures import link_motions, site_motion
from .steps import as_made
from .trajectory import Track, interpolate

_EVERY_S = 0.004  # inverse dynamics is smooth within this time


def motion_of(track: Track, recording: Recording, plant: Plant, to_actuator: np.ndarray) -> Motion:
    """Return what the model `plant` and the recording state of a track."""
    model, chain, step = plant.model, plant.chain, recording.period
    measured, back = recording.get("torque_measured"), np.linalg.inv(to_actuator)
    rows, at_tap = _commanded(recording, plant, track, to_actuator)
    logged = recording.get("torque_command") is not None
    law_only = not (logged or at_tap)
    delayed = not at_tap and not (logged and recording.timing.delay == "loop")
    line = Line(
        step=step,
        command=rows,
        speed=track.velocity,
        delay=chain.delay_s if delayed else 0.0,
        limit=chain.limit,
        stall=chain.stall,
        no_load=chain.no_load,
        full_braking=chain.full_braking,
        lag=np.zeros_like(chain.lag) if at_tap else chain.lag,
        # the law along a track may be wrong: it is no end of a channel whose other end was measured
        measured=measured @ back
        if scored_torque(recording) == "torque_measured" and measured is not None and not law_only
        else None,
    )
    torque = line.passed[1] if logged or measured is None else measured @ back

    known_models: dict[int, tuple[Model, np.ndarray]] = {}

    def required(other: Model) -> np.ndarray:
        if id(other) not in known_models:
            known_models[id(other)] = other, _required(as_made(other, recording), track, step)
        return known_models[id(other)][1]

    links = cache(lambda: link_motions(plant, track, step))
    return Motion(
        step=step,
        position=track.position,
        velocity=track.velocity,
        acceleration=track.acceleration,
        torque=torque,
        line=line,
        gain=gain_along(chain, torque, step),
        known=known_rows(plant, track.velocity, step),
        transmission=model.transmission,
        link=lambda joint: links()[joint],
        site=cache(lambda name: site_motion(plant, track, step, name)),
        required=required,
        inertia=cache(lambda: mass_matrix(plant, track)),
        rotor=rotor_of(plant),
        momentum=cache(lambda: momentum_of(plant, track)),
        law=lambda axis: gain_shares(recording, plant, track, axis),
        gravity=np.array(plant.links.opt.gravity),
        axis_units=axis_units(model),
        leads=tendon_leads(as_made(model, recording), plant.mujoco),
    )


def _commanded(
    recording: Recording, plant: Plant, track: Track, to_actuator: np.ndarray
) -> tuple[np.ndarray, bool]:
    """Torque command (N, n) at each row, actuator coordinates, and whether it is one at the tap already.

    Where no command was logged it is what the stated loop asks for along the track: a delay moves that, and
    not the measured torque, whose noise has steps from row to row that no command had. Where no loop is
    stated either, the measured torque is all that is known.
    """
    command, back = recording.get("torque_command"), np.linalg.inv(to_actuator)
    limits = command_limits(recording) if command is not None else ()
    law = law_along(recording, plant, track) if command is None or limits else None
    if command is None:
        measured = recording.get("torque_measured")
        known = np.zeros_like(track.position) if measured is None else measured @ back
        return (known, True) if law is None else (law, False)
    return (command if law is None else before_clamp(command, law @ to_actuator, limits)) @ back, False


def _required(model: Model, track: Track, step: float) -> np.ndarray:
    """Torque (N, n) at the tap that a model needs for a track.

    What posture and speed ask for is worked out at some rows, and what the acceleration does at all.
    """
    plant, stride = compile_plant(model), max(1, round(_EVERY_S / step))
    rows = np.unique(np.append(np.arange(0, len(track.position), stride), len(track.position) - 1))
    some = Track(track.position[rows], track.velocity[rows], np.zeros((len(rows), model.size)))
    even = interpolate(rows, required_torque(plant, some, stride * step), len(track.position))
    pushed = np.einsum("kij,kj->ki", mass_matrix(plant, track), track.acceleration)
    return even + pushed / plant.chain.gain


def rotor_of(plant: Plant) -> tuple[np.ndarray, np.ndarray]:
    """Return inertia and damping (n,) of each drive, including identified corrections."""
    m, model = plant.mujoco, plant.model
    tendons = [m.tendon(axis_tendon(i)).id for i in range(model.size)]
    own = 0.0 if model.has("actuator_inertia_coupling") else rotors(model)[1]
    # less than the tendon has was taken from a joint, so that the tendon alone does not tell
    inertia = np.array([rotor_inertia(model, i) for i in range(model.size)])
    return inertia, m.tendon_damping[tendons] + own


def mass_matrix(plant: Plant, track: Track) -> np.ndarray:
    """Return the mass matrix (N, n, n), actuator coordinates, along a track, links and rotors as one."""
    back = np.linalg.inv(plant.model.transmission)
    masses = _along(plant, track, lambda at: plant.lift.T @ mass_matrices(plant.mujoco, at) @ plant.lift)
    tree = back.T @ masses @ back
    return tree if plant.model.carried is None else tree + carried_inertia(plant, track.position)


def momentum_of(plant: Plant, track: Track) -> tuple[np.ndarray, float]:
    """Return the momentum of all bodies per drive speed (N, 3, n), and their mass [kg]."""
    mass, back = float(plant.mujoco.body_subtreemass[0]), np.linalg.inv(plant.model.transmission)
    return mass * _along(plant, track, lambda at: com_slopes(plant.mujoco, at) @ plant.lift) @ back, mass


def _along(plant: Plant, track: Track, of: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
    """Matrices that depend on the posture, at all rows; worked out at every fourth."""
    count = len(track.position)
    rows = np.unique(np.append(np.arange(0, count, 4), count - 1))
    joints = track.position[rows] @ np.linalg.inv(plant.model.transmission).T
    return interpolate(rows, of(plant.state_at(np.stack([joints, joints], axis=1))[:, 0]), count)


def law_along(recording: Recording, plant: Plant, track: Track) -> np.ndarray | None:
    """Return a stated loop's torque command (N, n) along a track, actuator coordinates, no limits.

    None where no loop is stated, or one that has a limit of its own.
    """
    if recording.get("position_reference") is None:
        return None
    e = prepare(recording, plant.model)
    if e.controller.kind not in ("pd", "cascade_pv") or e.controller.limit:
        return None
    shares = [_shares(e, plant.model.transmission, track, axis) for axis in range(plant.model.size)]
    # a cascade's gain on velocity multiplies all it asks for
    asked = [own.sum(axis=0) if e.controller.kind == "pd" else own[1] for own in shares]
    return np.sum(asked, axis=0) + e.feedforward


def gain_shares(recording: Recording, plant: Plant, track: Track, axis: int) -> np.ndarray:
    """Return parts of the torque command by the stated gains of one controller axis, (2, N, n).

    First the share that grows with the gain on position (kp), then that with the gain on velocity (kd of a
    PD loop, kv of a cascade), in actuator coordinates, held from tick to tick; zero for an open loop.
    """
    return _shares(prepare(recording, plant.model), plant.model.transmission, track, axis)


def _shares(e: Experiment, j: np.ndarray, track: Track, axis: int) -> np.ndarray:
    c, rows = e.controller, len(track.position)
    out = np.zeros((2, rows, len(j)))
    if c.kind not in ("pd", "cascade_pv"):
        return out
    joint = c.coordinates == "joint"
    back = np.linalg.inv(j)
    sense = (back if joint else np.eye(len(j)))[axis]
    drive = (back.T if joint else np.eye(len(j)))[:, axis]
    ticks = np.minimum(np.ceil(e.ticks / e.stride - 1e-9).astype(int), rows - 1)
    ticks = ticks[np.diff(ticks, prepend=-1) > 0]
    away = e.reference[ticks, axis] - track.position[ticks] @ sense
    rate = e.reference_rate[ticks, axis] - track.velocity[ticks] @ sense
    if c.kind == "pd":
        shares = np.stack([c.kp[axis] * away, c.kd[axis] * rate])
    else:
        whole = c.gain[axis] * c.kv[axis]
        shares = np.stack([whole * c.kp[axis] * away, whole * (c.kp[axis] * away + rate)])
    last = np.searchsorted(ticks, np.arange(rows), side="right") - 1
    return shares[:, last, None] * drive
