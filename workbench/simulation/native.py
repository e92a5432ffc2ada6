"""MuJoCo's functions for compiled loops, and the loops over the rows of a motion."""

from __future__ import annotations

import llvmlite.binding as llvm
import mujoco
import numpy as np
from numba import types

from workbench.core.compiled import compiled
from workbench.models.engine import library

llvm.load_library_permanently(str(library()))

#: ``mj_step(model, data)`` by the addresses of both.
mj_step = types.ExternalFunction("mj_step", types.void(types.intp, types.intp))
_inverse = types.ExternalFunction("mj_inverse", types.void(types.intp, types.intp))
_slopes = types.ExternalFunction(
    "mjd_inverseFD", types.void(types.intp, types.intp, types.float64, types.uint8, *[types.intp] * 7)
)
_kinematics, _com, _tendons, _mass = (
    types.ExternalFunction(name, types.void(types.intp, types.intp))
    for name in ("mj_kinematics", "mj_comPos", "mj_tendon", "mj_makeM")
)
_dense = types.ExternalFunction("mj_fullM", types.void(*[types.intp] * 3))
_com_slopes = types.ExternalFunction("mj_jacSubtreeCom", types.void(*[types.intp] * 3, types.int32))
_STEP = 1e-6


def inverse_forces(m: mujoco.MjModel, states: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Return forces (N, nv) of MuJoCo's inverse dynamics for states (N, 2, nv) and accelerations (N, nv)."""
    data = mujoco.MjData(m)
    out = np.empty_like(acceleration)
    views = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
    _forces(m._address, data._address, views, states, acceleration, out)
    return out


def inverse_slopes(m: mujoco.MjModel, states: np.ndarray, acceleration: np.ndarray) -> np.ndarray:
    """Return these forces' derivatives by acceleration, rate, position, (3, N, nv, nv), force first."""
    data = mujoco.MjData(m)
    out = np.empty((3, len(acceleration), m.nv, m.nv))
    _derivatives(m._address, data._address, (data.qpos, data.qvel, data.qacc), states, acceleration, out)
    # MuJoCo lays these out with one row per perturbed coordinate
    return out.swapaxes(-1, -2)


def mass_matrices(m: mujoco.MjModel, positions: np.ndarray) -> np.ndarray:
    """Return mass matrices (N, nv, nv) at positions (N, nv)."""
    data = mujoco.MjData(m)
    out = np.empty((len(positions), m.nv, m.nv))
    _masses(m._address, data._address, data.qpos, positions, out)
    return out


def com_slopes(m: mujoco.MjModel, positions: np.ndarray) -> np.ndarray:
    """Return Jacobians (N, 3, nv) of the common centre of mass at positions (N, nv)."""
    data = mujoco.MjData(m)
    out = np.empty((len(positions), 3, m.nv))
    _com_jacobians(m._address, data._address, data.qpos, positions, out)
    return out


def tendon_slopes(m: mujoco.MjModel, tendon: int, positions: np.ndarray) -> np.ndarray:
    """Return derivatives (N, nv) of the length of a tendon by the joints at positions (N, nv)."""
    data, first = mujoco.MjData(m), int(m.ten_J_rowadr[tendon])
    part = slice(first, first + int(m.ten_J_rownnz[tendon]))
    found = np.empty((len(positions), part.stop - part.start))
    _tendon_rows(m._address, data._address, (data.qpos, data.ten_J[part]), positions, found)
    out = np.zeros((len(positions), m.nv))
    out[:, m.ten_J_colind[part]] = found
    return out


@compiled(nogil=True)
def _forces(model, data, views, states, acceleration, out):  # pyright: ignore
    position, rate, change, force = views
    for k in range(len(out)):
        position[:], rate[:], change[:] = states[k, 0], states[k, 1], acceleration[k]
        _inverse(model, data)
        out[k] = force


@compiled(nogil=True)
def _derivatives(model, data, views, states, acceleration, out):  # pyright: ignore
    position, rate, change = views
    for k in range(out.shape[1]):
        position[:], rate[:], change[:] = states[k, 0], states[k, 1], acceleration[k]
        by_q, by_w, by_a = out[2, k].ctypes.data, out[1, k].ctypes.data, out[0, k].ctypes.data
        _slopes(model, data, _STEP, 0, by_q, by_w, by_a, 0, 0, 0, 0)


@compiled(nogil=True)
def _pose(model, data, position, values):  # pyright: ignore
    position[:] = values
    _kinematics(model, data)
    _com(model, data)


@compiled(nogil=True)
def _masses(model, data, position, positions, out):  # pyright: ignore
    for k in range(len(out)):
        _pose(model, data, position, positions[k])
        _tendons(model, data)
        _mass(model, data)
        _dense(model, data, out[k].ctypes.data)


@compiled(nogil=True)
def _tendon_rows(model, data, views, positions, out):  # pyright: ignore
    position, row = views
    for k in range(len(out)):
        _pose(model, data, position, positions[k])
        _tendons(model, data)
        out[k] = row


@compiled(nogil=True)
def _com_jacobians(model, data, position, positions, out):  # pyright: ignore
    for k in range(len(out)):
        _pose(model, data, position, positions[k])
        _com_slopes(model, data, out[k].ctypes.data, 0)
