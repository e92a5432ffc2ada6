"""The inertia that links, joints and drives must carry so that a tree has a mechanism's inertia and weight.

With each drive on a tendon whose length is its position, the omitted links add what a choice of these adds:
point masses on the links (any density is a sum of them), more rotor inertia on the drives (a crank turns with
its drive), rotor inertia on combinations of joints, and springs whose torque depends on one drive or joint,
for weight that hangs on a crank. All of them enter linearly and no inertia may be negative, so that the best
choice is one nonnegative least-squares problem, and a body with these masses can be built.

Motion does not tell all of it: a mass at a joint that only turns is not felt, and rotors can stand for links.
What it does not tell stays as the file has it: each link of the file is a choice too, and what moves masses,
centres and inertias away from it, or puts inertia on rotors, has a small price. With these the choice is
one: the same mechanism from another file, or one that differs by rounding, gives the same links.
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
_FILE = 0.01  # price of a link's way from the file's, relative to mass and size of all that moves
_ROTOR = 0.01  # price of rotor inertia, relative to what it adds to the whole


@dataclass(frozen=True)
class Body:
    """Mass [kg], centre (3,) [m] and inertia about it (3, 3) [kg m^2], in the body's frame."""

    mass: float
    centre: np.ndarray
    inertia: np.ndarray

    @property
    def moments(self) -> np.ndarray:
        """Mass, and its first and second moments about the frame's origin, as a matrix (4, 4)."""
        second = 0.5 * np.trace(self.inertia) * np.eye(3) - self.inertia
        out = np.empty((4, 4))
        out[:3, :3] = second + self.mass * np.outer(self.centre, self.centre)
        out[:3, 3] = out[3, :3] = self.mass * self.centre
        out[3, 3] = self.mass
        return out


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
        links: as the file has them, length B - 1.
        feels: inertia (B - 1, N, n, n) and `hangs`, weight (B - 1, N, n), that each of these adds.
        coordinates: of the springs (S, N), and `along`, their gradients (S, N, n).
        total: mass of all that moves [kg].
        size: of what moves [m].
    """

    frames: Frames
    mass: np.ndarray
    whole: np.ndarray
    gravity: np.ndarray
    down: np.ndarray
    drives: np.ndarray
    links: tuple[Body, ...]
    feels: np.ndarray
    hangs: np.ndarray
    coordinates: np.ndarray
    along: np.ndarray
    total: float
    size: float


def carry(wanted: Wanted) -> Carried:
    """Return the bodies, rotors and springs that come nearest to the wanted inertia and weight."""
    w, f = wanted, wanted.frames
    generator = np.random.default_rng(3)
    n, count = w.mass.shape[1], len(w.links)
    bodies = np.repeat(np.arange(count), _POINTS)
    points = w.size * generator.standard_normal((len(bodies), f.ways))
    _, jacobian = f.place(bodies + 1, points)
    rows = np.concatenate([np.eye(n), generator.standard_normal((_ROTORS, n))])
    squares = [
        w.feels,
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
    pull[:count] = w.hangs
    pull[count : count + len(bodies)] = np.einsum("d,pndi->pni", w.down, jacobian)
    pull[-2 * len(terms) :] = np.concatenate([terms, -terms])
    moments = np.array(
        [each.moments for each in w.links]
        + [_moments(f.basis[k + 1] @ point) for k, point in zip(bodies, points, strict=True)]
    )
    sizes = [count, len(bodies), len(rows) + len(w.drives), 2 * len(terms)]
    columns, goal = _problem(w, inertia, pull, sizes)
    own, towards = _towards_the_file(w, np.concatenate([np.arange(count), bodies]), moments)
    columns = np.concatenate([columns, np.pad(own, ((0, len(columns) - len(own)), (0, 0)))], axis=1)
    found = strongest(columns.T, np.concatenate([goal, towards]))
    shares, masses, turning, springs = np.split(found, np.cumsum(sizes)[:-1])
    rotors, drives = turning[: len(rows)], turning[len(rows) :]
    signed = (springs[: len(terms)] - springs[len(terms) :]).reshape(len(w.coordinates), -1)
    weights = np.concatenate([np.diag(shares), [masses * (bodies == k) for k in range(count)]], axis=1)
    return Carried(
        tuple(_body(w, each) for each in np.einsum("kp,pij->kij", weights, moments)),
        np.einsum("r,ri,rj->ij", rotors, rows, rows),
        drives,
        np.array([_unscaled(c, m, h) for c, m, h in zip(signed, middle, half, strict=True)]),
    )


def _problem(
    w: Wanted, inertia: np.ndarray, pull: np.ndarray, sizes: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Return what one unit of each choice changes (K, R): inertia, weight, mass, price; and the goal (R,)."""
    white = np.linalg.inv(np.linalg.cholesky(w.whole))
    share, count = 1.0 / np.sqrt(len(w.mass)), len(w.links)
    turned = share * (white @ inertia @ white.transpose(0, 2, 1)).reshape(len(inertia), -1)
    weight = share * pull.reshape(len(pull), -1) / _scale(w)
    mass = np.zeros((len(inertia), 1))
    total = _TOTAL / max(w.total, 1e-9)
    mass[:count, 0], mass[count : count + sizes[1]] = [total * each.mass for each in w.links], total
    price = np.zeros(len(inertia))
    turning = slice(count + sizes[1], count + sizes[1] + sizes[2])
    price[turning] = _ROTOR * np.linalg.norm(turned[turning], axis=1)
    price[turning.stop :] = _SPRINGS / _scale(w)
    paid = np.diag(price)[:, count + sizes[1] :]
    wished = share * (white @ w.mass @ white.transpose(0, 2, 1)).ravel()
    goal = [wished, share * w.gravity.ravel() / _scale(w), [_TOTAL if w.total > 0.0 else 0.0]]
    return np.concatenate([turned, weight, mass, paid], axis=1), np.concatenate(
        [*goal, np.zeros(paid.shape[1])]
    )


def _towards_the_file(w: Wanted, bodies: np.ndarray, moments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return moments of a unit of each choice on its link (P, R) and those of the file's links (R,), priced.

    Args:
        w: what is wanted.
        bodies: which link each choice is of (P,).
        moments: of one unit (P, 4, 4).
    """
    one = np.append(np.full(3, 1.0 / w.size), 1.0)
    scale = _FILE / max(w.total, 1e-9) * np.outer(one, one)
    upper = np.triu_indices(4)
    rows = (moments * scale)[:, *upper]
    out = np.zeros((len(bodies), len(w.links), rows.shape[1]))
    out[np.arange(len(bodies)), bodies] = rows
    return out.reshape(len(bodies), -1), rows[: len(w.links)].ravel()


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


def _moments(point: np.ndarray) -> np.ndarray:
    """Return the moments (4, 4) of one kilogram at a point (3,)."""
    at = np.append(point, 1.0)
    return np.outer(at, at)


def _body(w: Wanted, moments: np.ndarray) -> Body:
    """Return the body with these moments (4, 4), with so much more that MuJoCo accepts it."""
    mass, least = float(moments[3, 3]), 1e-3 * max(w.total, 1e-6)
    centre = moments[:3, 3] / max(mass, least)
    second = moments[:3, :3] - max(mass, least) * np.outer(centre, centre)
    inertia = np.trace(second) * np.eye(3) - second
    return Body(max(mass, least), centre, inertia + 1e-6 * max(mass, least) * w.size**2 * np.eye(3))
