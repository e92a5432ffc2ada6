"""The equation of motion of a variant: mass, velocity terms, gravity and damping, by MuJoCo."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.effects import Plant, compile_plant
from workbench.models import Model
from workbench.serial_tree import beside_the_links

from .closed_forms import residual_velocity_torque
from .variants import PER_STEP, linkage_inertia, with_variant


@dataclass(frozen=True)
class Dynamics:
    """``mass @ a + bias + damping @ v = gravity + torque`` in serial coordinates, over N states.

    Attributes:
        mass: (N, n, n) [kg m^2], rotors included.
        bias: Coriolis and centrifugal torque (N, n) [N m].
        gravity: torque of gravity, gravity compensation included, (N, n) [N m].
        damping: (n, n) [N m s/rad].
    """

    mass: np.ndarray
    bias: np.ndarray
    gravity: np.ndarray
    damping: np.ndarray


def reduced(plant: Plant, q: np.ndarray, v: np.ndarray) -> Dynamics:
    """Return the equation of motion of a compiled model; `q`, `v` (N, n) in serial coordinates."""
    return compiled_dynamics(plant.mujoco, plant.model.joints, q, v)


def compiled_dynamics(m: mujoco.MjModel, joints: Sequence[str], q: np.ndarray, v: np.ndarray) -> Dynamics:
    """Return the same for any MuJoCo model with hinges and slides.

    Args:
        m: compiled model; left as it is.
        joints: names of its n joints that q is over; others stay where the model starts.
        q: positions (N, n) [rad or m].
        v: rates (N, n).
    """
    heavy, weightless = copy.copy(m), copy.copy(m)
    for model in (heavy, weightless):
        model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    weightless.opt.gravity[:] = 0.0
    places = np.array([m.joint(name).qposadr[0] for name in joints])
    dofs = np.array([m.joint(name).dofadr[0] for name in joints])
    q, v = np.atleast_2d(np.asarray(q, float)), np.atleast_2d(np.asarray(v, float))
    mass = np.empty((len(q), len(dofs), len(dofs)))
    bias, gravity = np.empty((len(q), len(dofs))), np.empty((len(q), len(dofs)))
    at_rest, moving, full = mujoco.MjData(heavy), mujoco.MjData(weightless), np.zeros((m.nv, m.nv))
    for i in range(len(q)):
        at_rest.qpos[places], moving.qpos[places], moving.qvel[dofs] = q[i], q[i], v[i]
        mujoco.mj_forward(heavy, at_rest)
        mujoco.mj_forward(weightless, moving)
        mujoco.mj_fullM(weightless, moving, full)
        mass[i] = full[np.ix_(dofs, dofs)]
        bias[i] = moving.qfrc_bias[dofs]
        gravity[i] = at_rest.qfrc_gravcomp[dofs] - at_rest.qfrc_bias[dofs]
    _, damping = beside_the_links(m, tuple(joints))
    return Dynamics(mass, bias, gravity, damping)


def variant_dynamics(model: Model, variant: str, q: np.ndarray, v: np.ndarray) -> Dynamics:
    """Return the equation of motion of a variant that has one in serial coordinates.

    Args:
        model: any model of the mechanism.
        variant: a plain variant, or ``s3n_full_paper``.
        q, v: states (N, n), serial coordinates.

    Raises:
        InputError: another variant: ``explicit`` is no equation but an iteration, and ``constraint`` moves
            in other coordinates.
    """
    if variant in ("explicit", "constraint"):
        raise InputError(f"'{variant}' has no mass matrix in serial coordinates", remedy="run it instead")
    plain = with_variant(model, PER_STEP.get(variant, variant))
    out = reduced(compile_plant(plain), q, v)
    if variant != "s3n_full_paper":
        return out
    q, v = np.atleast_2d(q), np.atleast_2d(v)
    return replace(out, bias=out.bias - residual_velocity_torque(linkage_inertia(plain).M12, q, v))
