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
    [rad/s] and torque [N m], and the encoder's step [rad or m].
    """

    name: str
    links: tuple[Link, ...]
    tip: tuple[float, float, float]
    kp: tuple[float, ...]
    kd: tuple[float, ...]
    posture: tuple[float, ...]
    reach: tuple[float, ...]
    noise: tuple[float, float, float] = (0.008, 0.05, 2 * np.pi / 2**16)

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of all joints."""
        return tuple(link.name for link in self.links)

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
    own, place = np.array(link.centre), np.array(at, float)
    total = link.mass + mass
    centre = (link.mass * own + mass * place) / total
    inertia = np.array(link.inertia)
    for part, spot in ((link.mass, own), (mass, place)):
        arm = spot - centre
        inertia = inertia + part * (arm @ arm - arm**2)
    return replace(link, mass=total, centre=tuple(centre), inertia=tuple(inertia))


def mjcf(machine: Machine) -> str:
    """The machine as an MJCF file."""
    lines = [
        f'<mujoco model="{machine.name}">',
        '  <compiler angle="radian"/>',
        f'  <option gravity="0 0 -{GRAVITY}" integrator="implicitfast"/>',
        "  <worldbody>",
    ]
    for depth, link in enumerate(machine.links):
        kind = ' type="slide"' if link.slides else ""
        lines += [
            f'{"  " * (depth + 2)}<body name="{link.name}_link" pos="{_row(link.offset)}">',
            f'{"  " * (depth + 3)}<joint name="{link.name}"{kind} axis="{_row(link.axis)}" '
            f'damping="{link.damping:.9g}" frictionloss="{link.friction:.9g}" '
            f'armature="{link.armature:.9g}"/>',
            f'{"  " * (depth + 3)}<inertial pos="{_row(link.centre)}" mass="{link.mass:.9g}" '
            f'diaginertia="{_row(link.inertia)}"/>',
        ]
    depth = len(machine.links)
    lines.append(f'{"  " * (depth + 2)}<site name="tip" pos="{_row(machine.tip)}"/>')
    lines += [f"{'  ' * (d + 2)}</body>" for d in reversed(range(depth))]
    motors = "".join(f'<motor name="{x.name}" joint="{x.name}"/>' for x in machine.links if x.driven)
    return "\n".join([*lines, "  </worldbody>", f"  <actuator>{motors}</actuator>", "</mujoco>", ""])


def _row(values: Sequence[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)
