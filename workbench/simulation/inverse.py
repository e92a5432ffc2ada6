"""The torque that a model needs for a motion."""

from __future__ import annotations

import copy

import mujoco
import numpy as np

from workbench.effects import Plant, TorqueChain, heat, smooth_sign, tendon_leads, tendon_row, wound

from .carried import carried_torque
from .native import inverse_forces, tendon_slopes
from .trajectory import Track


def required_torque(
    plant: Plant, track: Track, step: float | None = None, rigid: np.ndarray | None = None
) -> np.ndarray:
    """Return the motor torque (N, n) where it is measured that a track needs, actuator coordinates.

    Dry friction acts against the motion with its full bound; the chain's gain and bias are undone, and what
    heat takes where the rows' `step` [s] is given. `rigid`: the `rigid_torque` of this track, where known.
    """
    joint = rigid_torque(plant, track) if rigid is None else rigid
    torque = joint @ np.linalg.inv(plant.model.transmission) - laws_of_state(plant, track)
    # friction that grows with the load needs a torque to know the torque it needs
    needed = torque + dry_friction(plant, track, torque)
    if any(t.law(0.0, 1.0, *t.parameters) != t.law(0.0, 0.0, *t.parameters) for t in plant.chain.friction):
        for _ in range(3):
            needed = torque + dry_friction(plant, track, needed)
    chain = plant.chain
    cold = tap = (needed - chain.bias) / chain.gain
    if step is not None and chain.heating.any():
        for _ in range(5):
            tap = cold * chain.gain / np.maximum(gain_along(chain, tap, step), 1e-3)
    return tap


def rigid_torque(plant: Plant, track: Track) -> np.ndarray:
    """Return the serial joints' torque (N, n) that MuJoCo's model needs for a track, dry friction aside.

    Links and motors move as one: what bends is taken as rigid.
    """
    back = np.linalg.inv(plant.model.transmission)
    q, w, a = track.position @ back.T, track.velocity @ back.T, track.acceleration @ back.T
    states = plant.state_at(np.stack([q, w], axis=1))
    tree = inverse_forces(copy_without_friction(plant.mujoco), states, a @ plant.lift.T) @ plant.lift
    return tree if plant.model.carried is None else tree + carried_torque(plant, q, w, a)


def gain_along(chain: TorqueChain, torque: np.ndarray, step: float) -> np.ndarray:
    """Return the gain of the motors (N, n) along a measured torque (N, n), reduced by heating."""
    out = np.tile(chain.gain, (len(torque), 1))
    for i in np.flatnonzero(chain.heating):
        warm = heat(torque[:, i], step, chain.heat_time[i])
        out[:, i] *= np.maximum(1.0 - chain.heating[i] * warm, 0.0)
    return out


def copy_without_friction(m: mujoco.MjModel) -> mujoco.MjModel:
    """Return the same model with dry friction switched off."""
    out = copy.copy(m)
    out.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_FRICTIONLOSS)
    return out


def laws_of_state(plant: Plant, track: Track) -> np.ndarray:
    """Return the torque of the chain's state-dependent laws along a track, (N, n), actuator coordinates."""
    total = np.zeros_like(track.velocity)
    for term in plant.chain.torques:
        row = _row(plant, term.tendon)
        torque = term.law(track.position @ row, track.velocity @ row, *term.parameters)
        total += torque[:, None] * row[None, :]
    for term in plant.chain.hysteresis:
        row = _row(plant, term.tendon)
        state = wound(track.position @ row, term.stiffness / max(term.torque, 1e-12))
        total -= term.torque * state[:, None] * row[None, :]
    return total


def dry_friction(plant: Plant, track: Track, torque: np.ndarray) -> np.ndarray:
    """Return the torque against the dry friction of the model along a track, (N, n), actuator coordinates.

    `torque` (N, n) is that on the drives' shafts, which may load the friction.
    """
    m, total = plant.mujoco, np.zeros_like(track.velocity)
    leads = tendon_leads(plant.model, m)
    for ident in range(m.ntendon):
        name, loss = m.tendon(ident).name, np.full(len(total), float(m.tendon_frictionloss[ident]))
        laws = [term for term in plant.chain.friction if term.tendon == name]
        if not laws and not loss.any():
            continue
        rows = _rows(plant, track, ident)
        speed, acceleration = (np.sum(x * rows, axis=1) for x in (track.velocity, track.acceleration))
        for term in laws:
            loss = loss + term.law(speed, torque[:, int(name.partition(":")[2])], *term.parameters)
        total += (loss * smooth_sign(speed + leads.get(name, 0.0) * acceleration))[:, None] * rows
    return total


def _rows(plant: Plant, track: Track, tendon: int) -> np.ndarray:
    """Slopes of a tendon's length by the drives' coordinates: (1, n); (N, n) where it runs through space."""
    m = plant.mujoco
    if m.wrap_type[m.tendon_adr[tendon]] == int(mujoco.mjtWrap.mjWRAP_JOINT):
        return _row(plant, m.tendon(tendon).name)[None]
    back = np.linalg.inv(plant.model.transmission)
    serial = track.position @ back.T
    states = plant.state_at(np.stack([serial, 0.0 * serial], axis=1))
    return tendon_slopes(m, tendon, states[:, 0]) @ plant.lift @ back


def _row(plant: Plant, tendon: str) -> np.ndarray:
    """Coefficients (n,) of a tendon over the drives' coordinates."""
    return tendon_row(plant.mujoco, tendon) @ plant.lift @ np.linalg.inv(plant.model.transmission)
