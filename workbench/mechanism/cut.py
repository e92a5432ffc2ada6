"""A mechanism whose loops are cut, in Drake; and what of it moves, as a plant of its own.

Of a whole robot one limb moves, and a file may have many links that are fixed to each other. In the plant of
what moves, links that do not move against each other are one body: Drake's work grows with its bodies.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BodyIndex,
    FixedOffsetFrame,
    PrismaticJoint,
    RevoluteJoint,
    SpatialInertia,
    UnitInertia,
    UniversalJoint,
)

from workbench.core import Coupling, InputError, Mechanism

from .loops import find_frame, loop_pairs
from .parse import GRAVITY, finished, parse

_KINDS = {"revolute", "prismatic", "universal", "weld"}


@dataclass(frozen=True)
class Cut:
    """A cut mechanism.

    Attributes:
        plant: Drake's, finalised.
        model: its model instance.
        pairs: of frames that coincide where the loops are closed.
        foot: its frame, or None.
        couplings: joints that follow others or are held.
    """

    plant: Any
    model: Any
    pairs: tuple[tuple[Any, Any], ...]
    foot: Any
    couplings: tuple[Coupling, ...]


def cut_open(mechanism: Mechanism, payload: float = 0.0) -> Cut:
    """Return a mechanism as its file has it, with a point mass [kg] at the foot.

    Raises:
        InputError: the file cannot be read, or has no frame of a name that `mechanism` gives.
    """
    if not (np.isfinite(payload) and payload >= 0.0):
        raise InputError(f"a payload of {payload} kg", file=mechanism.file, remedy="give a mass or zero")
    plant, model = parse(mechanism.file)
    pairs = loop_pairs(plant, model, mechanism)
    foot = find_frame(plant, model, mechanism, mechanism.foot, "foot") if mechanism.foot else None
    if payload:
        at: Any = np.zeros(3)
        body = plant.AddRigidBody("payload", model, SpatialInertia(payload, at, UnitInertia(0.0, 0.0, 0.0)))
        plant.WeldFrames(foot or no_foot(mechanism), body.body_frame())
    finished(plant, mechanism.file)
    return Cut(plant, model, tuple(pairs), foot, mechanism.all_couplings())


def no_foot(mechanism: Mechanism) -> Any:
    """Raise the InputError that something needs a foot and none is named."""
    raise InputError(
        "the mechanism has no foot", file=mechanism.file, column="closed_chain.foot",
        remedy="name the frame at its end",
    )  # fmt: skip


def moving_part(
    cut: Cut, context: Any, coordinates: Sequence[int], loops: Sequence[int], couplings: Sequence[int]
) -> Cut:
    """Return a cut mechanism in which nothing is left to move but some joints.

    Args:
        cut: the whole.
        context: of its plant, in the posture in which all other joints stay.
        coordinates: positions in theta of joints that move. Of a joint with more than one coordinate all do.
        loops: numbers of the pairs that are left.
        couplings: numbers of those that are left.

    The whole is returned where nothing would be saved, or where it has joints of other kinds.
    """
    kinds = {cut.plant.get_joint(index).type_name() for index in cut.plant.GetJointIndices()}
    if not kinds <= _KINDS or cut.plant.num_bodies() - 1 == len(set(coordinates)):
        return cut
    part = _Part(cut.plant, context, set(coordinates))
    pairs = tuple((part.frame(cut.pairs[k][0]), part.frame(cut.pairs[k][1])) for k in loops)
    foot = None if cut.foot is None else part.frame(cut.foot)
    part.plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    part.plant.Finalize()
    return Cut(part.plant, part.model, pairs, foot, tuple(cut.couplings[k] for k in couplings))


class _Part:
    """A plant in the making, of bodies that move against each other."""

    def __init__(self, whole: Any, context: Any, moving: set[int]) -> None:
        self.plant: Any = MultibodyPlant(0.0)
        self.model = self.plant.AddModelInstance("moving")
        self._whole, self._context, self._frames = whole, context, 0
        joints = [whole.get_joint(index) for index in whole.GetJointIndices()]
        stays = {j.child_body().index(): j for j in joints if moving.isdisjoint(_coordinates(j))}
        self._of: dict[Any, Any] = {}  # the first of the bodies that each moves with
        bodies = [whole.get_body(BodyIndex(k)) for k in range(whole.num_bodies())]
        for body in bodies:
            first = body
            while (joint := stays.get(first.index())) is not None:
                first = joint.parent_body()
            self._of[body.index()] = first
        self._new: dict[Any, Any] = {whole.world_body().index(): self.plant.world_body()}
        for index in dict.fromkeys(first.index() for first in self._of.values()):
            if index not in self._new:
                together = [body for body in bodies if self._of[body.index()].index() == index]
                first = whole.get_body(index)
                self._new[index] = self.plant.AddRigidBody(
                    first.name(), self.model, self._inertia(first, together)
                )
        for joint in joints:
            if joint.child_body().index() not in stays:
                self.plant.AddJoint(self._joint(joint))

    def frame(self, old: Any) -> Any:
        """Return the frame of this plant where one of the whole is."""
        first = self._of[old.body().index()]
        pose = old.CalcPose(self._context, first.body_frame())
        self._frames += 1
        new = FixedOffsetFrame(
            f"frame_{self._frames}", self._new[first.index()].body_frame(), pose, self.model
        )
        return self.plant.AddFrame(new)

    def _joint(self, old: Any) -> Any:
        ends = old.name(), self.frame(old.frame_on_parent()), self.frame(old.frame_on_child())
        kind = old.type_name()
        if kind == "revolute":
            return RevoluteJoint(*ends, old.revolute_axis())
        if kind == "prismatic":
            return PrismaticJoint(*ends, old.translation_axis())
        return UniversalJoint(*ends)

    def _inertia(self, first: Any, bodies: Sequence[Any]) -> Any:
        """Of bodies together, in the frame of the first."""
        total = None
        for body in bodies:
            pose = body.body_frame().CalcPose(self._context, first.body_frame())
            own = body.default_spatial_inertia().ReExpress(pose.rotation()).Shift(-pose.translation())
            if own.get_mass() > 0.0:
                total = own if total is None else total.__iadd__(own)
        return SpatialInertia.Zero() if total is None else total


def _coordinates(joint: Any) -> range:
    """Positions of a joint in theta."""
    return range(joint.position_start(), joint.position_start() + joint.num_positions())
