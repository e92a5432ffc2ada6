"""What is written into a serial tree so that it moves like a posture-dependent mechanism by itself.

Each drive is a tendon whose length is the drive's position as nearly as a sum of distances can be
(`posture_length`), with the rotor as its armature. Links, rotors and springs carry the rest
(`posture_links`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import mujoco
import numpy as np

from workbench.models import Inertial, Model, load_mjcf

from .dynamics import compiled_dynamics
from .posture import PostureDependent
from .posture_closure import LoopClosure
from .posture_frames import Frames, frames
from .posture_length import Branches, Goal, fit_length
from .posture_links import Body, Carried, Wanted, carry

_NODES = {1: 40, 2: 12, 3: 7}  # postures an angle that are fitted
CONSTANT = 1e-9  # largest change of a row of J that counts as none
_ENOUGH, _STARTS = 0.01, 3  # a drive's tendon that is this good is taken, else the best of some


@dataclass(frozen=True)
class Fit:
    """Numbers that are written into the tree.

    Attributes:
        chain: the mechanism.
        tendons: of the drives, None where J's row is constant, length n.
        rows: J at the middle of the workspace (n, n).
        offsets: length of each drive's tendon less the drive's position (n,).
        carried: by links, joints, drives and springs.
        springs: (``drive`` or ``joint``, which) of each spring.
        bodies: names of the bodies that branches refer to, and `basis`, what their points' coordinates mean.
    """

    chain: PostureDependent
    tendons: tuple[Branches | None, ...]
    rows: np.ndarray
    offsets: np.ndarray
    carried: Carried
    springs: tuple[tuple[str, int], ...]
    bodies: tuple[str, ...]
    basis: np.ndarray


def fit(chain: PostureDependent, branches: int = 8) -> Fit:
    """Return the numbers that fit a tree to a mechanism over its workspace; takes some seconds.

    Args:
        chain: the mechanism.
        branches: distances that add up to a drive's position, at most.
    """
    model, (q, slopes) = chain.model, _nodes(chain.box)
    m = load_mjcf(model.serial).compile()
    f, real = frames(m, model, q), chain.dynamics(q)
    closure = LoopClosure(model)
    size, total = closure.moving()
    metric = np.linalg.inv(np.linalg.cholesky(real.mass))
    tendons = tuple(
        None
        if np.ptp(real.jacobian[:, i], axis=0).max() <= CONSTANT
        else _length(Goal(f, real.jacobian[:, i], metric, slopes, size), branches)
        for i in range(model.size)
    )
    rows = chain.jacobian(chain.box.mean(axis=1)[None])[0]
    gradients = np.array(
        [np.tile(rows[i], (len(q), 1)) if t is None else t.gradient(f) for i, t in enumerate(tendons)]
    )
    lengths = np.array([rows[i] @ q.T if t is None else t.length(f) for i, t in enumerate(tendons)])
    springs = [("drive", i) for i in range(model.size)]
    springs += [("joint", k) for k in range(model.size) if not _is_drive(rows, tendons, k)]
    along = [
        gradients[k] if kind == "drive" else np.tile(np.eye(model.size)[k], (len(q), 1))
        for kind, k in springs
    ]
    coordinates = [lengths[k] if kind == "drive" else q[:, k] for kind, k in springs]
    links = tuple(_link(m, name) for name in f.bodies[1:])
    feels, hangs = _by_link(m, f, links)
    mass, gravity = _beside_the_links(m, model, f, q, feels, hangs)
    rotors = np.einsum("ani,a,anj->nij", gradients, chain.inertia, gradients)
    carried = carry(
        Wanted(
            f, real.mass - mass - rotors, real.mass, real.gravity - gravity, m.opt.gravity.copy(), gradients,
            links, feels, hangs, np.array(coordinates), np.array(along), total + chain.added.mass, size,
        )
    )  # fmt: skip
    offsets = (lengths - real.drives.T).mean(axis=1)
    offsets[np.abs(offsets) < CONSTANT] = 0.0
    return Fit(chain, tendons, rows, offsets, carried, tuple(springs), f.bodies, f.basis)


def _length(goal: Goal, branches: int) -> Branches:
    """Return the best of some starts, or the first that is good enough."""
    best, least = None, np.inf
    for seed in range(_STARTS):
        found, error = fit_length(goal, branches, seed)
        if best is None or error < least:
            best, least = found, error
        if least < _ENOUGH:
            break
    assert best is not None
    return best


def _is_drive(rows: np.ndarray, tendons: tuple[Branches | None, ...], joint: int) -> bool:
    """Return whether a joint is a drive, up to a constant factor."""
    alone = [np.count_nonzero(np.abs(row) > CONSTANT) == 1 and abs(row[joint]) > CONSTANT for row in rows]
    return any(only and t is None for only, t in zip(alone, tendons, strict=True))


def _nodes(box: np.ndarray) -> tuple[np.ndarray, tuple[np.ndarray, ...]]:
    """Return Chebyshev nodes (N, n), denser where errors are largest; n differentiation matrices (N, N)."""
    count = _NODES[len(box)]
    x = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    axes = [(low + high) / 2.0 + (high - low) / 2.0 * x for low, high in box]
    slopes = []
    for axis in range(len(box)):
        factors = [_slope(axes[k]) if k == axis else np.eye(count) for k in range(len(box))]
        slopes.append(reduce(np.kron, factors))
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(box)), tuple(slopes)


def _slope(x: np.ndarray) -> np.ndarray:
    """Return the differentiation matrix (K, K) through values at `x` (K,), by barycentric weights."""
    apart = x[:, None] - x + np.eye(len(x))
    weights = 1.0 / apart.prod(axis=1)
    out = weights / weights[:, None] / apart
    np.fill_diagonal(out, 0.0)
    return out - np.diag(out.sum(axis=1))


def _link(m: mujoco.MjModel, name: str) -> Body:
    own = Inertial.of(m, m.body(name).id)
    return Body(own.mass, own.centre, own.tensor)


def _by_link(m: mujoco.MjModel, f: Frames, links: tuple[Body, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Return inertia (B - 1, N, n, n) and weight (B - 1, N, n) of each body that carries a joint."""
    feels, hangs = [], []
    for k, link in enumerate(links, 1):
        linear = _centre_jacobian(f, k, link.centre)
        about = f.rotation[k].transpose(0, 2, 1) @ link.inertia @ f.rotation[k]
        feels.append(about + link.mass * linear.transpose(0, 2, 1) @ linear)
        hangs.append(link.mass * np.einsum("d,ndi->ni", m.opt.gravity, linear))
    return np.array(feels), np.array(hangs)


def _beside_the_links(
    m: mujoco.MjModel, model: Model, f: Frames, q: np.ndarray, feels: np.ndarray, hangs: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return inertia (N, n, n) and weight (N, n) of the parts that the fit does not change.

    That is everything but the inertials of the bodies that carry the joints: armatures of the MJCF's own, and
    bodies fixed to the links.
    """
    whole = compiled_dynamics(m, model.joints, q, np.zeros_like(q))
    carried = 1.0 - np.array([m.body_gravcomp[m.body(name).id] for name in f.bodies[1:]])
    return whole.mass - feels.sum(axis=0), whole.gravity - np.einsum("b,bni->ni", carried, hangs)


def _centre_jacobian(f: Frames, body: int, centre: np.ndarray) -> np.ndarray:
    """Return d centre / d q (N, 3, n) in the body's axes, without what a planar mechanism cannot feel."""
    _, jacobian = f.place(np.array([body]), (centre @ f.basis[body])[None])
    return jacobian[0]
