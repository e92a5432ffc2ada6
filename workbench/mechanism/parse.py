"""A user's SDF or URDF in Drake: whatever is wrong with it becomes one line that says what to do.

A base that hangs free in the file is held still, as on a test stand.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

from workbench.core import InputError
from workbench.core.files import read_file
from workbench.core.xml import parse_xml

GRAVITY = 9.81  # m/s^2
#: How Drake refuses: a condition that fails wants to end the process, too long a number is out of range.
_REFUSALS = RuntimeError, ValueError, IndexError, OverflowError, SystemExit


@dataclass(frozen=True)
class BallLoop:
    """A loop that the file itself closes (``drake:ball_constraint``): two bodies, a point [m] on each."""

    bodies: tuple[str, str]
    points: tuple[tuple[float, float, float], tuple[float, float, float]]


def parse(file: Path, plant: Any = None, *, hold_base: bool = True) -> tuple[Any, Any]:
    """Return a Drake plant of the file, not yet finalised, and its model instance.

    Args:
        file: SDF or URDF with one model.
        plant: the empty plant to fill; a continuous one if not given.
        hold_base: weld a base that hangs free in the file to the world where the file places it.

    Raises:
        InputError: Drake cannot read it; its own reason is kept.
    """
    plant = MultibodyPlant(0.0) if plant is None else plant
    model = _read(file, plant)
    if not hold_base or not _rootless(plant, model):
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
    """Return the plant, finalised and with gravity along -z.

    Raises:
        InputError: its joints form a loop, or it has constraints or joints that are not understood here.
    """
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    _finalize(plant, file)
    _refuse_missing_inertias(plant, file)
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
    """Return the loops that the file closes itself, read from its XML: Drake does not give them back.

    Raises:
        InputError: not XML, or joints are bound to each other by what is no loop.
    """
    root = _xml(file)
    if next(root.iter("tendon_constraint"), None) is not None:
        raise InputError(
            "it has a <tendon_constraint>", file=file, remedy="describe the mechanism by its links and pins"
        )
    return tuple(_ball_loop(node, file) for node in root.iter("ball_constraint"))


def _ball_loop(node: ElementTree.Element, file: Path) -> BallLoop:
    # SDF writes the values as text, URDF as attributes
    entries = {child.tag: (child.text or "").strip() or _attribute(child) for child in node}
    try:
        bodies = (entries["ball_constraint_body_A"], entries["ball_constraint_body_B"])
        first, second = (entries[f"ball_constraint_{key}"].split() for key in ("p_AP", "p_BQ"))
        (ax, ay, az), (bx, by, bz) = map(float, first), map(float, second)
    except (KeyError, ValueError) as error:
        raise InputError(
            "a ball constraint has no body or no point", file=file, column="drake:ball_constraint",
            remedy="give body_A, body_B, p_AP and p_BQ",
        ) from error  # fmt: skip
    return BallLoop(bodies, ((ax, ay, az), (bx, by, bz)))


def _xml(file: Path) -> ElementTree.Element:
    """The file's XML, tags without prefix: Drake reads ``drake:`` whether it is declared or not."""
    remedy = "give an SDF or URDF file"
    return parse_xml(read_file(file), file, prefixes=False, problem="not an XML file", remedy=remedy)


def _attribute(node: ElementTree.Element) -> str:
    return next((node.attrib[key] for key in ("name", "value") if key in node.attrib), "")


def _read(file: Path, plant: Any) -> Any:
    """Fills the plant from the file; returns the model instance."""
    if not Path(file).is_file():
        raise InputError("the file does not exist", file=file, remedy="give the path of an SDF or URDF file")
    _refuse_others(_xml(file), Path(file))
    try:
        with quiet() as warnings:
            models = Parser(plant).AddModels(Path(file))
    except _REFUSALS as error:
        raise InputError(
            f"Drake cannot read it: {_reason(error)}", file=file, remedy="correct what it names"
        ) from error
    _refuse_replaced_inertias(warnings, file)
    if len(models) != 1:
        raise InputError(f"it holds {len(models)} models", file=file, remedy="give a file with one model")
    return models[0]


def _refuse_others(root: ElementTree.Element, file: Path) -> None:
    """Raises InputError where the file is of another kind, or draws in other files."""
    if root.tag not in ("sdf", "robot"):
        raise InputError(f"it is a <{root.tag}>", file=file, remedy="give an SDF or URDF file")
    if next(root.iter("include"), None) is not None:
        raise InputError("it includes other files", file=file, column="include", remedy="write them in place")


def _rootless(plant: Any, model: Any) -> bool:
    """Whether some link is no joint's child, so that the file has a base that may hang free."""
    children = {plant.get_joint(i).child_body().index() for i in plant.GetJointIndices()}
    return any(index not in children for index in plant.GetBodyIndices(model))


def _finalize(plant: Any, file: Path) -> None:
    try:
        with quiet():
            plant.Finalize()
    except _REFUSALS as error:
        looped = "loop" in str(error)
        problem = "its joints form a loop" if looped else f"Drake cannot build it: {_reason(error)}"
        remedy = (
            "leave out one joint of the loop, put a frame at its pin on either link and name the pair"
            if looped
            else "correct what it names"
        )
        raise InputError(problem, file=file, column="closed_chain.loops", remedy=remedy) from error


def _refuse_missing_inertias(plant: Any, file: Path) -> None:
    """SDF takes a link without <inertial> for 1 kg, which nobody means where the link moves."""
    root = _xml(file)
    if root.tag != "sdf":
        return
    bodies = [plant.get_body(BodyIndex(i)) for i in range(plant.num_bodies())]
    moving = {body.name() for body in bodies if not plant.IsAnchored(body)}
    for link in root.iter("link"):
        name = link.get("name", "")
        if link.find("inertial") is None and name in moving:
            raise InputError(
                f"link '{name}' has no <inertial>, which SDF reads as 1 kg", file=file, column="inertial",
                remedy="give it a mass and an inertia, or put a <frame> in its place",
            )  # fmt: skip


def _refuse_replaced_inertias(warnings: list[str], file: Path) -> None:
    """Drake replaces an inertia that no body can have by one of a solid ball, and only warns."""
    for warning in warnings:
        found = re.search(r":(\d+): warning: While .*inertia.*?: (.*)", warning, re.DOTALL)
        if found:
            raise InputError(
                f"an inertia that no link can have: {_reason(found[2])}", file=file, row=int(found[1]),
                remedy="give a positive mass and a positive inertia about the centre of mass",
            )  # fmt: skip


def _reason(said: object) -> str:
    """What Drake says in one line, without the place in its own source."""
    text = re.sub(r"Failure at .*?condition", "condition", " ".join(str(said).split()))
    return "a whole number is too large" if text == "stoi" else text


@contextmanager
def quiet() -> Iterator[list[str]]:
    """Drake's log as a list rather than on the terminal: what matters in it becomes an error."""
    log, messages = logging.getLogger("drake"), []
    keep = logging.Handler()
    keep.emit = lambda record: messages.append(record.getMessage())
    before = log.handlers, log.propagate
    log.handlers, log.propagate = [keep], False
    try:
        yield messages
    finally:
        log.handlers, log.propagate = before
