"""Parts of a file that bind joints or bodies beyond its tree; a model here is only a tree.

Left out, such a loop would be a machine with more freedoms than the real one, of which every result is wrong.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import mujoco

from workbench.core import InputError

_IMPORT = (
    "make a model of it: workbench import FILE --drive JOINT... --joint JOINT... --foot SITE -o MODEL.toml"
)
_LIMB = "--hold-rest for all that has no motor, as a gripper"
_LOOP = f'{_IMPORT} (or set active="false" where the loop is not there)'
_CUT = f"name a frame on either side of the pin that closes it, and {_IMPORT}, with --loop A:B"
_TENDON = "equalities between tendons are not supported: take it out of a copy of the file"
#: Equalities that close a loop of bodies, or make a joint follow another.
LOOPS = mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtEq.mjEQ_WELD, mujoco.mjtEq.mjEQ_JOINT
_KINDS = {
    mujoco.mjtEq.mjEQ_CONNECT: ("connect", _LOOP),
    mujoco.mjtEq.mjEQ_WELD: ("weld", _LOOP),
    mujoco.mjtEq.mjEQ_JOINT: ("joint", _LOOP),
    mujoco.mjtEq.mjEQ_TENDON: ("tendon", _TENDON),
}


def refuse_equalities(spec: mujoco.MjSpec, file: Path, *, loops: bool = False) -> None:
    """Refuse an MJCF that binds bodies, joints or tendons together; an inactive equality is ignored.

    Args:
        spec: the MJCF.
        file: it was read from.
        loops: whether bodies and joints may be held together.

    Raises:
        InputError: one is active.
    """
    for each in spec.equalities:
        if each.active and not (loops and each.type in LOOPS):
            kind, remedy = _KINDS.get(each.type, ("flex", "take it out of a copy of the file"))
            called = f" '{each.name}'" if each.name else ""
            ends = " and ".join(f"'{name}'" for name in (each.name1, each.name2) if name)
            problem = f"the equality{called} ({kind}) binds {ends or 'the world'}, and a model is a tree"
            raise InputError(problem, file=file, column=f"equality.{kind}", remedy=remedy)


def refuse_constraints(root: ElementTree.Element, file: Path) -> None:
    """Refuse the same in a URDF, whose tags have no prefix: joints that follow others, and loops.

    Raises:
        InputError: it has one.
    """
    for joint in root.iter("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            problem = f"joint '{joint.get('name')}' follows '{mimic.get('joint')}' (<mimic>)"
            raise InputError(problem, file=file, column="mimic", remedy=f"{_IMPORT}, and {_LIMB}")
    for node in root:
        if node.tag.endswith("_constraint") or node.tag == "loop_joint":
            raise InputError(
                f"it has a <{node.tag}>, and a model is a tree", file=file, column=node.tag, remedy=_IMPORT
            )
        if node.tag == "gazebo" and node.find("joint") is not None:
            name = node.find("joint").get("name")  # pyright: ignore[reportOptionalMemberAccess]
            problem = f"the joint '{name}' inside of <gazebo> closes a loop, and a model is a tree"
            raise InputError(problem, file=file, column="gazebo", remedy=_CUT)
