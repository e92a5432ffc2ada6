"""The inertia that links, joints and drives must carry so that a tree has a mechanism's inertia and weight.

With each drive on a tendon whose length is its position, the omitted links add what a choice of these adds:
point masses on the links (any density is a sum of them), more rotor inertia on the drives (a crank turns with
its drive), rotor inertia on combinations of joints, and springs whose torque depends on one drive or joint,
for weight that hangs on a crank. All of them enter linearly and no inertia may be negative, so that the best
choice is one nonnegative least-squares problem, and a body with these masses can be built.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .posture_frames import Frames
from .posture_length import strongest

_POINTS, _ROTORS = 120, 60  # to choose from: a link, and in all
_DEGREE = 3  # of a spring's torque
_SPRINGS = 1e-3  # price of a spring's torque: a link carries the weight where one can
_TOTAL = 0.02  # weight of the sum of the masses
_THICK = 0.05  # of the mechanism's size: extent of a link out of the plane that it moves in


@dataclass(frozen=True)
class Body:
    """Mass [kg], centre (3,) [m] and inertia about it (3, 3) [kg m^2], in the body's frame."""

    mass: float
    centre: np.ndarray
    inertia: np.ndarray


@dataclass(frozen=True)
class Carried:
    """The inertia that links, joints and drives are chosen to carry, and the springs beside it.

    Attributes:
        links: of the bodies that carry the joints, the world left out.
        rotors: inertia on combinations of joints (n, n) [kg m^2].
        drives: inertia that the drives carry beside their own (n,) [kg m^2].
        springs: coefficients of 1, x, x^2 and x^3 of each spring's torque (S, 4), x its coordinate.
    """

    links: tuple[Body, ...]
    rotors: np.ndarray
    drives: np.ndarray
    springs: np.ndarray


@dataclass(frozen=True)
class Wanted:
    """Inertia and weight to be carried, at N postures.

    Attributes:
        frames: of the bodies.
        mass: inertia (N, n, n) [kg m^2].
        whole: the whole mass matrix (N, n, n), in whose metric errors count.
        gravity: torque of the weights (N, n) [N m].
        down: gravity (3,) [m/s^2].
        drives: gradients of the drives' tendons (n, N, n).
        coordinates: of the springs (S, N), and `along`, their gradients (S, N, n).
        total: mass of all links [kg].
        size: of the mechanism [m].
    """

    frames: Frames
    mass: np.ndarray
    whole: np.ndarray
    gravity: np.ndarray
    down: np.ndarray
    drives: np.ndarray
    coordinates: np.ndarray
    along: np.ndarray
    total: float
    size: float


def carry(wanted: Wanted) -> Carried:
    """Return the bodies, rotors and springs that come nearest to the wanted inertia and weight."""
    w, f = wanted, wanted.frames
    generator = np.random.default_rng(3)
    n, links = w.mass.shape[1], range(1, len(f.bodies))
    bodies = np.repeat(links, _POINTS)
    points = w.size * generator.standard_normal((len(bodies), f.ways))
    _, jacobian = f.place(bodies, points)
    rows = np.concatenate([np.eye(n), generator.standard_normal((_ROTORS, n))])
    squares = [
        np.einsum("pndi,pndj->pnij", jacobian, jacobian),
        np.repeat((rows[:, :, None] * rows[:, None, :])[:, None], len(w.mass), axis=1),
        w.drives[..., :, None] * w.drives[..., None, :],
    ]
    # a spring's torque may have either sign, so each stands twice
    middle, half = _scales(w.coordinates)
    x = (w.coordinates - middle[:, None]) / half[:, None]
    terms = (x[:, None] ** np.arange(_DEGREE + 1)[:, None])[..., None] * w.along[:, None]
    terms = terms.reshape(-1, *w.gravity.shape)
    inertia = np.concatenate([*squares, np.zeros((2 * len(terms), *w.mass.shape))])
    pull = np.zeros((len(inertia), *w.gravity.shape))
    pull[: len(bodies)] = np.einsum("d,pndi->pni", w.down, jacobian)
    pull[-2 * len(terms) :] = np.concatenate([terms, -terms])
    sizes = [len(bodies), len(rows), len(w.drives), 2 * len(terms)]
    found = strongest(_columns(w, inertia, pull, sizes).T, _goal(w, sizes))
    masses, rotors, drives, springs = np.split(found, np.cumsum(sizes)[:-1])
    signed = (springs[: len(terms)] - springs[len(terms) :]).reshape(len(w.coordinates), -1)
    return Carried(
        tuple(_body(w, k, masses[bodies == k], points[bodies == k]) for k in links),
        np.einsum("r,ri,rj->ij", rotors, rows, rows),
        drives,
        np.array([_unscaled(c, m, h) for c, m, h in zip(signed, middle, half, strict=True)]),
    )


def _columns(w: Wanted, inertia: np.ndarray, pull: np.ndarray, sizes: list[int]) -> np.ndarray:
    """Return what one unit of each choice changes (K, R): inertia, weight, total mass, its penalty."""
    white = np.linalg.inv(np.linalg.cholesky(w.whole))
    share = 1.0 / np.sqrt(len(w.mass))
    turned = share * (white @ inertia @ white.transpose(0, 2, 1)).reshape(len(inertia), -1)
    weight = share * pull.reshape(len(pull), -1) / _scale(w)
    mass = np.zeros((len(inertia), 1))
    mass[: sizes[0]] = _TOTAL / max(w.total, 1e-9)
    price = np.zeros((len(inertia), sizes[3]))
    price[-sizes[3] :] = _SPRINGS / _scale(w) * np.eye(sizes[3])
    return np.concatenate([turned, weight, mass, price], axis=1)


def _goal(w: Wanted, sizes: list[int]) -> np.ndarray:
    """Return what the choices have to add up to (R,)."""
    white = np.linalg.inv(np.linalg.cholesky(w.whole))
    share = 1.0 / np.sqrt(len(w.mass))
    turned = share * (white @ w.mass @ white.transpose(0, 2, 1)).ravel()
    weight = share * w.gravity.ravel() / _scale(w)
    return np.concatenate([turned, weight, [_TOTAL if w.total > 0.0 else 0.0], np.zeros(sizes[3])])


def _scale(w: Wanted) -> float:
    """Return the torque of gravity that errors are divided by [N m]."""
    return max(float(np.sqrt(np.mean(w.gravity**2))), 1e-9)


def _scales(coordinates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return middle and half width of each spring's coordinate (S,)."""
    low, high = coordinates.min(axis=1), coordinates.max(axis=1)
    return (low + high) / 2.0, np.maximum((high - low) / 2.0, 1e-12)


def _unscaled(coefficients: np.ndarray, middle: float, half: float) -> np.ndarray:
    """Return coefficients in x of a polynomial in (x - middle) / half."""
    scaled = np.polynomial.Polynomial(coefficients, domain=[middle - half, middle + half], window=[-1.0, 1.0])
    out = np.zeros(_DEGREE + 1)
    converted = scaled.convert().coef
    out[: len(converted)] = converted
    return out


def _body(w: Wanted, number: int, masses: np.ndarray, points: np.ndarray) -> Body:
    """Return point masses as one body that MuJoCo accepts: thick enough that no inertia is zero."""
    mass = float(masses.sum())
    least = 1e-3 * max(w.total, 1e-6)
    if mass < least:
        masses, points = (
            np.append(masses, least - mass),
            np.concatenate([points, np.zeros((1, w.frames.ways))]),
        )
        mass = least
    places = points @ w.frames.basis[number].T
    centre = masses @ places / mass
    arm = places - centre
    inertia = np.einsum("p,pij->ij", masses, np.einsum("pk,pk->p", arm, arm)[:, None, None] * np.eye(3))
    inertia -= np.einsum("p,pi,pj->ij", masses, arm, arm)
    if w.frames.plane:
        basis = w.frames.basis[number]
        inertia += mass * (_THICK * w.size) ** 2 * basis @ basis.T  # about both directions in the plane
    return Body(mass, centre, inertia + 1e-6 * mass * w.size**2 * np.eye(3))
