"""A machine as a row of links, each on the one before, as numbers that compiled code takes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

GRAVITY = 9.81  # m/s^2, down along z


@dataclass(frozen=True)
class Link:
    """One link and the joint that carries it; SI, vectors in the link's own frame unless said.

    Attributes:
        name: of the joint, and so of the axis.
        axis: of the joint, unit vector.
        offset: of the joint in the frame of the link before, at rest.
        mass, centre, inertia: of the link; inertia about its centre along x, y, z.
        armature, damping, friction: of the joint.
        slides: along the axis, rather than turning about it.
        driven: by a motor.
    """

    name: str
    axis: tuple[float, float, float]
    offset: tuple[float, float, float]
    mass: float
    centre: tuple[float, float, float]
    inertia: tuple[float, float, float]
    armature: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    slides: bool = False
    driven: bool = True


@dataclass(frozen=True)
class Machine:
    """Links, the tip in the last link's frame, gains of its loop (N m/rad, N m s/rad), a posture, a reach.

    `posture` and `reach` are of the axes [rad or m]: where it moves about, and how far. `noise`: of speed
    [rad/s] and torque [N m], and the encoder's step [rad or m]. Where drives turn with several joints,
    `drives` are their names and `couple` their angles over those of the joints; gains, posture, reach and the
    links' armature, damping and friction are then the drives'.
    """

    name: str
    links: tuple[Link, ...]
    tip: tuple[float, float, float]
    kp: tuple[float, ...]
    kd: tuple[float, ...]
    posture: tuple[float, ...]
    reach: tuple[float, ...]
    noise: tuple[float, float, float] = (0.008, 0.05, 2 * np.pi / 2**16)
    drives: tuple[str, ...] = ()
    couple: tuple[tuple[float, ...], ...] = ()

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of all drives, which are those of the joints where each has its own."""
        return self.drives or tuple(link.name for link in self.links)

    def index(self, axis: str) -> int:
        """Number of an axis."""
        return self.axes.index(axis)

    def with_link(self, axis: str, **changes: object) -> Machine:
        """The machine with one link or joint changed."""
        links = [replace(x, **changes) if x.name == axis else x for x in self.links]  # pyright: ignore
        return replace(self, links=tuple(links))


class Numbers(NamedTuple):
    """All links as arrays, each one row a link."""

    slides: np.ndarray
    axis: np.ndarray
    offset: np.ndarray
    mass: np.ndarray
    centre: np.ndarray
    inertia: np.ndarray
    armature: np.ndarray
    damping: np.ndarray
    friction: np.ndarray


def numbers(links: Sequence[Link]) -> Numbers:
    """The links as arrays."""
    return Numbers(
        np.array([link.slides for link in links]),
        *(
            np.array([getattr(link, key) for link in links], float)
            for key in ("axis", "offset", "mass", "centre", "inertia", "armature", "damping", "friction")
        ),
    )


def loaded(link: Link, mass: float, at: Sequence[float]) -> Link:
    """The link with a point mass [kg] on it, at a place in its frame [m]."""
    own, place = link.centre, tuple(map(float, at))
    total = link.mass + mass
    centre = tuple((link.mass * a + mass * b) / total for a, b in zip(own, place, strict=True))
    inertia = link.inertia
    for part, spot in ((link.mass, own), (mass, place)):
        x, y, z = ((a - c) ** 2 for a, c in zip(spot, centre, strict=True))
        inertia = (inertia[0] + part * (y + z), inertia[1] + part * (x + z), inertia[2] + part * (x + y))
    return replace(link, mass=total, centre=centre, inertia=inertia)
