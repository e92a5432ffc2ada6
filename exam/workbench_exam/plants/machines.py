"""The robots, drawn anew from a seed; ranges are those of machines of a few kilograms and tens of N m."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .chain import Link, Machine

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


class _Draw:
    """Random numbers about a usual one."""

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng([seed, 401])

    def about(self, usual: float, factor: float = 1.4) -> float:
        """Up to `factor` times more or less, of so few digits that every machine draws the same."""
        return float(f"{usual * factor ** self._generator.uniform(-1.0, 1.0):.6g}")

    def joint(self, armature: float, damping: float, friction: float) -> dict[str, Any]:
        """Numbers of a joint about these."""
        return {
            "armature": self.about(armature, 1.6),
            "damping": self.about(damping, 1.6),
            "friction": self.about(friction, 1.6),
        }


def _round(inertia: float) -> tuple[float, float, float]:
    """A body of nearly the same inertia about any axis, so that one of the three can be wrong in a file."""
    return (0.85 * inertia, inertia, 0.9 * inertia)


def _arm(d: _Draw) -> Machine:
    upper, fore = d.about(0.35, 1.2), d.about(0.3, 1.2)
    links = (
        Link("yaw", Z, (0, 0, 0.2), d.about(3.0), (0, 0, 0.05), (0.01, 0.01, 0.008),
             **d.joint(0.12, 0.5, 0.6)),
        Link("lift", Y, (0, 0, 0.1), m := d.about(2.4), (d.about(0.17, 1.2), 0, 0),
             _round(m * upper**2 / 13), **d.joint(0.12, 0.8, 0.9)),
        Link("bend", Y, (upper, 0, 0), m := d.about(1.3), (d.about(0.14, 1.2), 0, 0),
             _round(m * fore**2 / 7), **d.joint(0.06, 0.4, 0.4)),
    )  # fmt: skip
    return Machine(
        "field_arm", links, (fore, 0, 0), tuple(d.about(k, 1.25) for k in (130.0, 160.0, 80.0)),
        tuple(d.about(k, 1.25) for k in (6.0, 8.0, 3.0)), (0.0, -0.4, 0.6), (0.9, 0.7, 0.9),
    )  # fmt: skip


def _quadruped(d: _Draw) -> Machine:
    long = d.about(0.21, 1.15)
    links = (
        Link("abduction", X, (0.2, 0.05, 0.45), d.about(0.7), (-0.005, 0.0, 0.0), _round(0.0009),
             **d.joint(0.012, 0.15, 0.2)),
        Link("thigh", Y, (0, 0.095, 0), d.about(1.1), (-0.004, -0.02, -d.about(0.035)),
             _round(0.006), **d.joint(0.012, 0.2, 0.25)),
        Link("calf", Y, (0, 0, -long), d.about(0.25), (0.004, 0, -d.about(0.11)), _round(0.002),
             **d.joint(0.015, 0.15, 0.2)),
    )  # fmt: skip
    return Machine(
        "field_quadruped", links, (0, 0, -long), tuple(d.about(k, 1.25) for k in (30.0, 30.0, 35.0)),
        tuple(d.about(k, 1.25) for k in (0.8, 0.8, 0.9)), (0.0, 0.8, -1.5), (0.4, 0.5, 0.5),
        (0.02, 0.03, 2 * np.pi / 2**16),
    )  # fmt: skip


def _six_axis(d: _Draw) -> Machine:
    def link(name, axis, offset, mass, centre, size, joint):
        mass = d.about(mass)
        return Link(name, axis, offset, mass, centre, _round(mass * size**2), **d.joint(*joint))

    links = (
        link("base", Z, (0, 0, 0.3), 8.0, (0.02, 0, 0.05), 0.1, (0.8, 6.0, 8.0)),
        link("shoulder", Y, (0.1, 0, 0.15), 7.0, (0, 0.01, 0.2), 0.15, (0.9, 8.0, 10.0)),
        link("elbow", Y, (0, 0, 0.42), 4.0, (0.05, 0, 0.05), 0.1, (0.4, 4.0, 5.0)),
        link("roll", X, (0.15, 0, 0.05), 3.0, (0.15, 0, 0.004), 0.12, (0.1, 1.0, 1.5)),
        link("pitch", Y, (0.3, 0, 0), 1.2, (0.02, 0, 0.01), 0.05, (0.06, 0.6, 1.0)),
        link("flange", X, (0.08, 0, 0), 0.5, (0.03, 0.01, 0), 0.03, (0.03, 0.3, 0.5)),
    )
    return Machine(
        "field_six_axis", links, (0.06, 0, 0),
        tuple(d.about(k, 1.2) for k in (1500.0, 1800.0, 900.0, 150.0, 110.0, 50.0)),
        tuple(d.about(k, 1.2) for k in (75.0, 90.0, 40.0, 6.0, 4.0, 1.5)),
        (0.0, 0.2, 0.4, 0.0, 0.5, 0.0), (0.8, 0.5, 0.6, 1.0, 0.8, 1.0), (0.008, 0.15, 2 * np.pi / 2**17),
    )  # fmt: skip


def _cart(d: _Draw) -> Machine:
    long = d.about(0.5, 1.3)
    links = (
        Link("cart", X, (0, 0, 0.5), d.about(1.2), (0, 0, 0), (0.003, 0.003, 0.003), slides=True,
             **d.joint(0.3, 4.0, 1.5)),
        Link("rod", Y, (0, 0, 0), m := d.about(0.25), (0, 0, -long / 2),
             (m * long**2 / 12, m * long**2 / 12, 1e-4), damping=d.about(0.004), driven=False),
    )  # fmt: skip
    return Machine(
        "field_cart", links, (0, 0, -long), (d.about(250.0, 1.25), 0.0), (d.about(25.0, 1.25), 0.0),
        (0.0, 0.0), (0.25, 0.0), (0.004, 0.1, 2e-5),
    )  # fmt: skip


def _geared(d: _Draw) -> Machine:
    long = d.about(0.4, 1.25)
    links = (
        Link("lift", Y, (0, 0, 0.6), m := d.about(1.6), (long / 2, 0, 0), _round(m * long**2 / 9),
             **d.joint(0.09, 0.5, 0.7)),
    )  # fmt: skip
    return Machine(
        "exam_geared", links, (long, 0, 0), (d.about(140.0, 1.25),), (d.about(7.0, 1.25),), (0.3,), (0.9,),
    )  # fmt: skip


def _leg(d: _Draw) -> Machine:
    thigh, shank = d.about(0.18, 1.2), d.about(0.24, 1.2)
    links = (
        Link("hip", Y, (0, 0, 0.6), m := d.about(1.6), (0, 0, -d.about(0.07)), _round(m * thigh**2 / 6),
             **d.joint(0.016, 0.1, 0.2)),
        Link("knee", Y, (0, 0, -thigh), m := d.about(0.4), (0, 0, -d.about(0.1)), _round(m * shank**2 / 8),
             **d.joint(0.016, 0.1, 0.2)),
    )  # fmt: skip
    return Machine(
        "exam_leg", links, (0, 0, -shank), tuple(d.about(k, 1.25) for k in (50.0, 45.0)),
        tuple(d.about(k, 1.25) for k in (1.5, 1.3)), (0.5, -0.6), (0.5, 0.6), (0.02, 0.03, 2 * np.pi / 2**16),
        ("thigh_drive", "shank_drive"), ((1.0, 0.0), (1.0, 1.0)),
    )  # fmt: skip


def _differential(d: _Draw) -> Machine:
    links = (
        Link("pitch", Y, (0.1, 0, 0.5), d.about(0.9), (d.about(0.04), 0, 0), _round(0.004),
             **d.joint(0.02, 0.15, 0.2)),
        Link("roll", X, (0.08, 0, 0), d.about(0.8), (d.about(0.1), 0, d.about(0.04)), _round(0.005),
             **d.joint(0.02, 0.15, 0.2)),
    )  # fmt: skip
    return Machine(
        "exam_differential", links, (0.2, 0, 0.05), tuple(d.about(k, 1.25) for k in (40.0, 40.0)),
        tuple(d.about(k, 1.25) for k in (1.6, 1.6)), (0.3, 0.1), (0.8, 0.8), (0.01, 0.03, 2 * np.pi / 2**16),
        ("left", "right"), ((1.0, 1.0), (1.0, -1.0)),
    )  # fmt: skip


MACHINES: Mapping[str, Callable[[_Draw], Machine]] = {
    "arm": _arm,
    "quadruped": _quadruped,
    "six_axis": _six_axis,
    "cart": _cart,
    "geared": _geared,
    "leg": _leg,
    "differential": _differential,
}


def draw_machine(family: str, seed: int) -> Machine:
    """One machine of a family, the same for the same seed."""
    return MACHINES[family](_Draw(seed))
