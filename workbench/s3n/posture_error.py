"""The error of a plain MJCF of a posture-dependent mechanism, over the whole workspace."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np

from .dynamics import compiled_dynamics
from .posture import PostureDependent
from .posture_closure import say

_GRID = {1: 200, 2: 21, 3: 9}  # postures an angle, limits included
_SPEED = 5.0  # rad/s or m/s, of the velocity terms
_LEAST = 1e-3  # of inertia times speed squared: velocity terms that count as none
_SEED = 5


@dataclass(frozen=True)
class PostureError:
    """Errors over a grid of the workspace, its limits included.

    Attributes:
        inertia_max, inertia_rms: relative error of the inertia in the direction where it is worst, and over
            all directions: eigenvalues of M^-1 M' less one (kinetic energies compared).
        inertia_at: where the largest is, in words.
        gravity_max, gravity_rms: of the torque of gravity [N m]; the second relative to that torque.
        velocity_rms: of the velocity terms at random speeds, relative.
        torque_max: torque of a drive's motor that goes astray, relative; None without motors.
        position_max: of the drives' positions as the file has them [rad]; None without motors.
    """

    inertia_max: float
    inertia_rms: float
    inertia_at: str
    gravity_max: float
    gravity_rms: float
    velocity_rms: float
    torque_max: float | None = None
    position_max: float | None = None


def posture_error(
    chain: PostureDependent, m: mujoco.MjModel, offsets: np.ndarray | None = None
) -> PostureError:
    """Return the error of a compiled tree with the joints of the model.

    Args:
        chain: what is right; totals.
        m: compiled tree, its motors (if it has any) in the order of the model's axes; left as it is.
        offsets: length of each motor's transmission less the drive's position (n,), where there are motors.
    """
    joints = chain.model.joints
    q = workspace_grid(chain.box)
    v = np.random.default_rng(_SEED).uniform(-_SPEED, _SPEED, q.shape)
    real, ours = chain.dynamics(q, v), compiled_dynamics(m, joints, q, v)
    relative = relative_inertia(ours.mass, real.mass)
    worst = np.abs(relative).max(axis=1)
    held, lengths, moments = _at_rest(m, joints, q, len(q[0]) if offsets is not None else 0)
    pull = held - real.gravity
    astray = position = None
    if offsets is not None:
        astray = float(np.abs((moments - real.jacobian) @ np.linalg.inv(real.jacobian)).max())
        position = float(np.abs(lengths - offsets - real.drives).max())
    return PostureError(
        float(worst.max()),
        float(np.sqrt(np.mean(relative**2))),
        say(chain.model, q[int(worst.argmax())]),
        float(np.abs(pull).max()),
        _share(pull, real.gravity),
        _share(
            ours.bias - real.bias, real.bias, _LEAST * float(np.abs(real.mass).max() * np.abs(v).max() ** 2)
        ),
        astray,
        position,
    )


def workspace_grid(box: np.ndarray) -> np.ndarray:
    """Postures (N, n) on an even grid over the limits (n, 2)."""
    axes = [np.linspace(low, high, _GRID[len(box)]) for low, high in box]
    return np.array(list(product(*axes)))


def relative_inertia(mass: np.ndarray, real: np.ndarray) -> np.ndarray:
    """Return relative errors of the inertia by direction (N, n): eigenvalues of M^-1 M' minus one."""
    white = np.linalg.inv(np.linalg.cholesky(real))
    return np.linalg.eigvalsh(white @ (mass - real) @ white.transpose(0, 2, 1))


def _share(off: np.ndarray, whole: np.ndarray, least: float = 0.0) -> float:
    """Return the root mean square of an error relative to that of the total, or to `least` if larger."""
    scale = max(float(np.sqrt(np.mean(whole**2))), least)
    return float(np.sqrt(np.mean(off**2))) / scale if scale > 0.0 else float(np.abs(off).max(initial=0.0))


def _at_rest(
    m: mujoco.MjModel, joints: tuple[str, ...], q: np.ndarray, motors: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque of weights and springs (N, n), lengths (N, k) and moments (N, k, n) of the first k motors."""
    data = mujoco.MjData(m)
    places = [m.joint(name).qposadr[0] for name in joints]
    dofs = [m.joint(name).dofadr[0] for name in joints]
    torque, lengths = np.empty_like(q), np.empty((len(q), motors))
    moments = np.empty((len(q), motors, len(dofs)))
    for i, row in enumerate(q):
        data.qpos[places] = row
        mujoco.mj_forward(m, data)
        torque[i] = (data.qfrc_passive - data.qfrc_bias)[dofs]
        if motors:
            full = np.zeros((m.nu, m.nv))
            mujoco.mju_sparse2dense(
                full, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
            )
            lengths[i], moments[i] = data.actuator_length[:motors], full[:motors, dofs]
    return torque, lengths, moments
