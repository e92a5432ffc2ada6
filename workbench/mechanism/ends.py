"""Both ends of the loops of a mechanism; of loops between the same two links at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

_V = JacobianWrtVariable.kV


@dataclass(frozen=True)
class Ends:
    """Loops between two links: k points on each that coincide where the loops are closed.

    Attributes:
        loops: their numbers, length k.
        rows: of the gap of all loops, three for each of these.
        frames: of the two links.
        points: of each link in its own frame (3, k) [m].
    """

    loops: tuple[int, ...]
    rows: list[int]
    frames: tuple[Any, Any]
    points: tuple[np.ndarray, np.ndarray]

    def gap(self, plant: Any, context: Any) -> np.ndarray:
        """Return the ways from the second points to the first (3 k,) [m]."""
        world = plant.world_frame()
        first, second = (
            plant.CalcPointsPositions(context, frame, points, world)
            for frame, points in zip(self.frames, self.points, strict=True)
        )
        return (first - second).ravel(order="F")

    def jacobian(self, plant: Any, context: Any) -> np.ndarray:
        """Return d gap / d theta (3 k, N)."""
        world = plant.world_frame()
        first, second = (
            plant.CalcJacobianTranslationalVelocity(context, _V, frame, points, world, world)
            for frame, points in zip(self.frames, self.points, strict=True)
        )
        return first - second

    def bias(self, plant: Any, context: Any) -> np.ndarray:
        """Return the second derivative of the gap at zero acceleration of the tree (3 k,) [m/s^2]."""
        world = plant.world_frame()
        first, second = (
            plant.CalcBiasTranslationalAcceleration(context, _V, frame, points, world, world)
            for frame, points in zip(self.frames, self.points, strict=True)
        )
        return (first - second).ravel(order="F")


def ends_of(plant: Any, context: Any, pairs: Sequence[tuple[Any, Any]]) -> tuple[Ends, ...]:
    """Return the loops `pairs` of frames, by the links that they join; links that are welded are one.

    Args:
        plant: finalised.
        context: of it, in any posture.
        pairs: frames whose origins coincide where the loops are closed.
    """
    found: dict[tuple[Any, Any], list[int]] = {}
    links = [(_link(plant, first), _link(plant, second)) for first, second in pairs]
    for number, (first, second) in enumerate(links):
        found.setdefault((first.index(), second.index()), []).append(number)
    out = []
    for numbers in found.values():
        frames = tuple(link.body_frame() for link in links[numbers[0]])
        points = tuple(
            np.hstack(
                [plant.CalcPointsPositions(context, pairs[k][i], np.zeros(3), frames[i]) for k in numbers]
            )
            for i in (0, 1)
        )
        rows = [3 * k + i for k in numbers for i in range(3)]
        out.append(Ends(tuple(numbers), rows, (frames[0], frames[1]), (points[0], points[1])))
    return tuple(out)


def _link(plant: Any, frame: Any) -> Any:
    """The first of the bodies that are welded to each other."""
    return min(plant.GetBodiesWeldedTo(frame.body()), key=lambda body: int(body.index()))
