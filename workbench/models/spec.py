"""The MJCF or URDF of a model as MuJoCo parses it: its joints, and its end."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np

from workbench.core import InputError

from .bound import refuse_equalities
from .contacts import keep_base_apart
from .engine import refused, warned
from .floating import take_apart
from .mjcf import check_mjcf
from .urdf import is_urdf, load_urdf

_STRONGEST = 1e6  # m/s^2; no machine stands where gravity is stronger


def load_mjcf(path: Path) -> mujoco.MjSpec:
    """Parse an MJCF or URDF file; what hangs on a fixed base does not touch it (`contacts.keep_base_apart`).

    Raises:
        InputError: MuJoCo cannot read it; its own reason is kept. Or it has plugins, names files that do
            not lie beside or below it, or holds bodies or joints together beside its tree.
    """
    if is_urdf(path):
        return load_urdf(path)
    spec = _parsed(path)
    refuse_equalities(spec, path)
    keep_base_apart(spec)
    return spec


def load_with_loops(path: Path) -> mujoco.MjSpec:
    """Parse an MJCF whose bodies may be held together in loops, as an import takes it.

    Raises:
        InputError: as `load_mjcf`, loops apart.
    """
    spec = _parsed(path)
    refuse_equalities(spec, path, loops=True)
    return spec


def _parsed(path: Path) -> mujoco.MjSpec:
    check_mjcf(path)
    with refused("read this MJCF", path):
        spec = mujoco.MjSpec.from_file(str(path))
    _take_inertia_from_geoms(spec)
    return spec


def _take_inertia_from_geoms(spec: mujoco.MjSpec) -> None:
    """What ``inertiafromgeom="true"`` says of a file's bodies, said of these bodies alone.

    Else what is put in or changed later would get an inertia of its geoms too, whatever it is given.
    """
    if spec.compiler.inertiafromgeom != mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE:
        return
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_AUTO
    for body in (b for b in spec.bodies if b.geoms):
        body.explicitinertial, body.mass, body.inertia = False, 0.0, np.zeros(3)
        body.ipos, body.iquat, body.fullinertia = np.full(3, np.nan), [1, 0, 0, 0], np.full(6, np.nan)


def load_tree(path: Path) -> mujoco.MjSpec:
    """Return the tree of a model: a floating base hangs on six joints (`floating.BASE_AXES`).

    Raises:
        InputError: as `load_mjcf`; or several bodies float.
    """
    spec = load_mjcf(path)
    take_apart(spec, path)
    return spec


def hinges_and_slides(spec: mujoco.MjSpec, file: Path) -> list[str]:
    """Return the names of its joints, all hinges or slides, in a tree that MuJoCo can compile.

    Raises:
        InputError: it has none or others, they have no names or a negative number, gravity is no number of
            m/s^2, or it cannot be compiled.
    """
    names: list[str] = []
    for joint in spec.joints:
        if joint.type not in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            raise InputError(
                f"joint '{joint.name}' is a ball", file=file,
                remedy="a model may have only hinge and slide joints below its base",
            )  # fmt: skip
        if not joint.name:
            raise InputError("a joint has no name", file=file, remedy="name every joint")
        _refuse_negative(joint, file)
        names.append(joint.name)
    if not names:
        raise InputError("the MJCF has no joints", file=file, remedy="give a tree with hinge or slide joints")
    strongest = float(max(spec.option.gravity, key=abs))
    if not abs(strongest) < _STRONGEST:
        problem = f"gravity is {strongest:.3g} m/s^2"
        raise InputError(problem, file=file, column="gravity", remedy="give it in m/s^2")
    with refused("compile this model", file), warned():
        spec.compile()  # what is lacking may stand in the model file, as a drive's inertia does
    return names


def _refuse_negative(joint: mujoco.MjsJoint, file: Path) -> None:
    for what in ("armature", "damping", "frictionloss"):
        number = float(np.ravel(getattr(joint, what))[0])  # of a damping by powers of speed the linear one
        if number < 0.0:
            raise InputError(
                f"joint '{joint.name}' has {what} {number:.3g}", file=file, column=what,
                remedy="a machine has zero or more of it",
            )  # fmt: skip


def end_site(spec: mujoco.MjSpec) -> str | None:
    """Return the site at the machine's end, where a payload would hang, if there is only one."""
    moving = [b for b in spec.bodies if b.joints]
    ends = [b for b in moving if not any(other is not b and _carries(b, other) for other in moving)]
    sites = [s.name for b in ends for s in b.find_all("site") if s.name]
    return sites[0] if len(sites) == 1 else None


def _carries(body: mujoco.MjsBody, other: mujoco.MjsBody) -> bool:
    return any(below.name == other.name for below in body.find_all("body"))
