"""Errors of a normalised tree on a free base: total mass, weight, and coupling with the base.

On a fixed base the normalised tree is exact. A free base also feels the links' mass and where it is: the tree
has the serial tree's masses and what the linkage's inertia needed, not the mechanism's own, and gravity
compensation takes weight off the machine. The numbers here say how much, against the closed chain of the SDF.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.models import Model

from .loop import close_loops, free_base, loop_spec, mechanism_of, tree_projection
from .normalise import normalise

_POSTURES = 4  # a serial joint
_PREFIX = "tree:"


@dataclass(frozen=True)
class FloatingBaseError:
    """A leg on a free base: the closed chain's numbers, and how far the normalised tree is from them.

    The base's frame is the tree's root; errors are the largest over the postures, as a share of the closed
    chain's largest entry of the same kind.

    Attributes:
        mass, true_mass: total mass of the links [kg].
        weight, true_weight: what gravity pulls on, as a mass [kg].
        coupling: forces and moments on the base per acceleration of the joints (6 x n).
        inertia: forces and moments on the base per acceleration of the base (6 x 6).
        moment: moment of gravity about the base's origin.
        postures: serial coordinates, (P, n).
    """

    mass: float
    true_mass: float
    weight: float
    true_weight: float
    coupling: float
    inertia: float
    moment: float
    postures: np.ndarray


def floating_base_error(model: Model, variant: str | None = None) -> FloatingBaseError:
    """Return how far the normalised tree is from the closed chain, both on a free base.

    Args:
        model: a model that names its closed chain.
        variant: a plain variant in place of the model's own.

    Raises:
        InputError: the model names no closed chain, or not as an SDF tree.
        SimulationError: a loop cannot be closed within the limits.
    """
    mechanism = mechanism_of(model)
    tree = _on_a_free_base(normalise(replace(model, ground=None), variant).xml)  # ground is no part of it
    chain = loop_spec(model, floating=True).compile()
    cut_open = loop_spec(model).compile()
    limits = mechanism.limits or ((-1.0, 1.0),) * model.size
    axes = [np.linspace(low, high, _POSTURES) for low, high in limits]
    postures = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    found, true = [], []
    for q in postures:
        theta, _ = close_loops(cut_open, model, q, np.zeros_like(q))
        along = np.zeros((chain.nv, 6 + model.size))
        along[:6, :6] = np.eye(6)
        along[6:, 6:] = tree_projection(cut_open, model, theta)
        true.append(_on_the_base(chain, theta, along))
        places = np.zeros(tree.nq - 7)
        along = np.zeros((tree.nv, 6 + model.size))
        along[:6, :6] = np.eye(6)
        for i, name in enumerate(model.joints):
            joint = tree.joint(_PREFIX + name)
            places[joint.qposadr[0] - 7] = q[i]
            along[joint.dofadr[0], 6 + i] = 1.0
        found.append(_on_the_base(tree, places, along))
    mass, weight, coupling, inertia, moment = (np.array(x) for x in zip(*found, strict=True))
    mass_t, weight_t, coupling_t, inertia_t, moment_t = (np.array(x) for x in zip(*true, strict=True))
    return FloatingBaseError(
        float(mass[0]),
        float(mass_t[0]),
        float(weight[0]),
        float(weight_t[0]),
        _share(coupling, coupling_t),
        _share(inertia, inertia_t),
        _share(moment, moment_t),
        postures,
    )


def _share(found: np.ndarray, true: np.ndarray) -> float:
    return float(np.abs(found - true).max() / np.abs(true).max())


def _on_a_free_base(xml: str) -> mujoco.MjModel:
    """Return the tree of an MJCF text on a free body of almost no mass; its names begin with `_PREFIX`."""
    outer = mujoco.MjSpec()
    base = free_base(outer)
    inner = mujoco.MjSpec.from_string(xml)
    for kind in (inner.keys, inner.sensors):
        for element in list(kind):
            inner.delete(element)
    for name in ("gravity", "timestep", "integrator"):
        setattr(outer.option, name, getattr(inner.option, name))
    outer.attach(inner, frame=base.add_frame(), prefix=_PREFIX)
    return outer.compile()


def _on_the_base(
    m: mujoco.MjModel, joints: np.ndarray, along: np.ndarray
) -> tuple[float, float, np.ndarray, np.ndarray, np.ndarray]:
    """Mass, weight [kg], coupling (6, n), inertia (6, 6) and gravity's moment (3,) at one posture."""
    data, full = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    data.qpos[:7], data.qpos[7:] = [0, 0, 0, 1, 0, 0, 0], joints
    m.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, full)
    mass = along.T @ full @ along
    pull = data.qfrc_gravcomp[:6] - data.qfrc_bias[:6]
    g = m.opt.gravity
    weight = float(pull[:3] @ g / (g @ g))
    return float(mass[0, 0]), weight, mass[:6, 6:], mass[:6, :6], pull[3:]
