"""A ground in Drake that feet stand on, level or of tiles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    Box,
    CollisionFilterDeclaration,
    GeometrySet,
    HalfSpace,
    ProximityProperties,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import CoulombFriction

from workbench.core import Mechanism

from .loops import find_frame, origin

_TILE, _TILES = 0.4, 9  # m, each way


@dataclass(frozen=True)
class Ground:
    """A level ground at z = 0, and the spheres that touch it.

    Attributes:
        feet: frames that carry a sphere.
        radius: of the spheres [m].
        friction: coefficient of dry friction, static and sliding.
        stiffness: of a contact [N/m]; None: as hard as the solver has it.
        damping: of a contact that has a stiffness [N s/m]; None: as Drake has it, 0.1 s of its stiffness.
        roughness: height up to which tiles of the ground stand out of it [m], about the origin.
    """

    feet: tuple[str, ...] = ("foot",)
    radius: float = 0.02
    friction: float = 0.8
    stiffness: float | None = None
    damping: float | None = None
    roughness: float = 0.0


def stand(plant: Any, model: Any, mechanism: Mechanism, ground: Ground) -> list[Any]:
    """Return the ground and the feet's spheres; returns the feet's bodies."""
    surface: Any = ProximityProperties()
    stiffness = None if ground.stiffness is None else 2.0 * ground.stiffness  # half of it gives way each
    AddContactMaterial(
        properties=surface, point_stiffness=stiffness,
        friction=CoulombFriction(ground.friction, ground.friction),
    )  # fmt: skip
    if ground.stiffness is not None and ground.damping is not None:
        # of both bodies Drake adds the times, and half of the sum belongs to each
        surface.AddProperty("material", "relaxation_time", 0.5 * ground.damping / ground.stiffness)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", surface)
    for k, (place, box) in enumerate(_tiles(ground.roughness)):
        plant.RegisterCollisionGeometry(plant.world_body(), place, box, f"tile{k}", surface)
    bodies: list[Any] = []
    for name in ground.feet:
        frame = find_frame(plant, model, mechanism, name, "foot")
        centre: Any = origin(frame)
        at = RigidTransform(centre)
        plant.RegisterCollisionGeometry(frame.body(), at, Sphere(ground.radius), f"{name}_sphere", surface)
        bodies.append(frame.body().index())
    return bodies


def _tiles(height: float) -> list[tuple[Any, Any]]:
    """Tiles of a rough ground with their places: what a lap of 1 m radius to the left passes over."""
    if not height:
        return []
    heights = np.random.default_rng(17).uniform(0.0, height, (_TILES, _TILES))
    at = [
        (float(_TILE * (i - _TILES // 2)), float(_TILE * (k - _TILES // 5)))
        for i, k in np.ndindex(heights.shape)
    ]
    places: list[Any] = [np.array([x, y, h - 0.05]) for (x, y), h in zip(at, heights.ravel(), strict=True)]
    return [(RigidTransform(place), Box(_TILE, _TILE, 0.1)) for place in places]


def only_ground(plant: Any, model: Any, scene: Any) -> None:
    """Links whose shapes overlap at a pin shall not push each other: they touch the ground only."""
    shapes: Any = GeometrySet()
    for index in plant.GetBodyIndices(model):
        shapes.Add(plant.GetCollisionGeometriesForBody(plant.get_body(index)))
    scene.collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(shapes))
