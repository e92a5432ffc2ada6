"""A user's SDF or URDF in Drake: whatever is wrong with it becomes one line that says what to do.

A base that hangs free in the file is held still, as on a test stand.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from workbench.core import InputError

GRAVITY = 9.81  # m/s^2


@dataclass(frozen=True)
class BallLoop:
    """A loop that the file itself closes (``drake:ball_constraint``): two bodies, a point [m] on each."""

    bodies: tuple[str, str]
    points: tuple[tuple[float, float, float], tuple[float, float, float]]


def parse(file: Path, plant: Any = None, *, hold_base: bool = True) -> tuple[Any, Any]:
    """A Drake plant of the file, not yet finalised, and its model instance.

    Args:
        file: SDF or URDF with one model.
        plant: the empty plant to fill; a continuous one if not given.
        hold_base: weld a base that hangs free in the file to the world where the file places it.

    Raises:
        InputError: Drake cannot read it; its own reason is kept.
    """
    plant = MultibodyPlant(0.0) if plant is None else plant
    model = _read(file, plant)
    if not hold_base:
        return plant, model
    probe: Any = MultibodyPlant(0.0)  # Any: Drake's stubs misuse numpy's type parameters
    _read(file, probe)
    _finalize(probe, file)
    for body in probe.GetFloatingBaseBodies():
        pose = probe.GetDefaultFloatingBaseBodyPose(probe.get_body(body))
        name = probe.get_body(body).name()
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(name, model), pose)
    return plant, model


def finished(plant: Any, file: Path) -> Any:
    """The plant, finalised and with gravity along -z.

    Raises:
        InputError: its joints form a loop, or it has constraints or joints that are not understood here.
    """
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    _finalize(plant, file)
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        if joint.type_name() == "ball_rpy":
            raise InputError(
                f"joint '{joint.name()}' is of type {joint.type_name()}",
                file=file,
                remedy="use revolute, prismatic and universal joints: a rod between two ball joints has a "
                "universal joint at one end, and its loop closes at the other",
            )
    return plant


def declared_loops(file: Path) -> tuple[BallLoop, ...]:
    """The loops that the file closes itself, read from its XML: Drake does not give them back."""
    try:
        root = ElementTree.parse(file).getroot()
    except (ElementTree.ParseError, OSError) as error:
        raise InputError(f"not an XML file: {error}", file=file, remedy="give an SDF or URDF file") from error
    for node in root.iter():
        if _tag(node) in ("mimic", "tendon_constraint"):
            raise InputError(
                f"it has a <{_tag(node)}>", file=file, remedy="describe the mechanism by its links and pins"
            )
    return tuple(_ball_loop(node, file) for node in root.iter() if _tag(node) == "ball_constraint")


def _ball_loop(node: ElementTree.Element, file: Path) -> BallLoop:
    # SDF writes the values as text, URDF as attributes
    entries = {_tag(child): (child.text or "").strip() or _attribute(child) for child in node}
    try:
        bodies = (entries["ball_constraint_body_A"], entries["ball_constraint_body_B"])
        first, second = (entries[f"ball_constraint_{key}"].split() for key in ("p_AP", "p_BQ"))
        (ax, ay, az), (bx, by, bz) = map(float, first), map(float, second)
    except (KeyError, ValueError) as error:
        raise InputError(
            "a ball constraint lacks a body or a point", file=file, column="drake:ball_constraint",
            remedy="give body_A, body_B, p_AP and p_BQ",
        ) from error  # fmt: skip
    return BallLoop(bodies, ((ax, ay, az), (bx, by, bz)))


def _tag(node: ElementTree.Element) -> str:
    """Name without namespace, whether the prefix was declared (``{uri}x``) or not (``drake:x``)."""
    return node.tag.rsplit("}", 1)[-1].rsplit(":", 1)[-1]


def _attribute(node: ElementTree.Element) -> str:
    return next((node.attrib[key] for key in ("name", "value") if key in node.attrib), "")


def _read(file: Path, plant: Any) -> Any:
    """Fills the plant from the file; returns the model instance."""
    if not Path(file).is_file():
        raise InputError("the file does not exist", file=file, remedy="give the path of an SDF or URDF file")
    try:
        with quiet():
            models = Parser(plant).AddModels(Path(file))
    except RuntimeError as error:
        raise InputError(
            f"Drake cannot read it: {error}", file=file, remedy="correct what it names"
        ) from error
    if len(models) != 1:
        raise InputError(f"it holds {len(models)} models", file=file, remedy="give a file with one model")
    return models[0]


def _finalize(plant: Any, file: Path) -> None:
    try:
        with quiet():
            plant.Finalize()
    except RuntimeError as error:
        looped = "loop" in str(error)
        problem = "its joints form a loop" if looped else f"Drake cannot build it: {error}"
        remedy = (
            "leave out one joint of the loop, put a frame at its pin on either link and name the pair"
            if looped
            else "correct what it names"
        )
        raise InputError(problem, file=file, column="closed_chain.loops", remedy=remedy) from error


@contextmanager
def quiet() -> Iterator[None]:
    """Without Drake's log on the terminal: what matters in it comes as an error."""
    log = logging.getLogger("drake")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        log.setLevel(level)
