"""The baseline of S3N: the real mechanism in MuJoCo, its loops closed by equality constraints.

Crank and coupler are bodies of their own, and where a loop closes two sites are held together by MuJoCo's
``connect``. That constraint is soft: how well the loop is closed, and what it does to the motion, depends on
solver settings that correspond to nothing in the mechanism, which is the paper's argument against it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from workbench.core import Coupling, InputError, Mechanism, SimulationError
from workbench.core.coupling import BoundJoints
from workbench.models import Model, load_mjcf

from .sdf import HERE, Pose, SdfTree
from .urdf import read_tree

_LEAST = 1e-12  # kg, of a link that has none
_POINT = 1e-12  # kg m^2
_CLOSED = 1e-9  # m, largest gap of a loop that counts as closed


@dataclass(frozen=True)
class ConstraintSettings:
    """Solver settings of the loop (MuJoCo's, and its defaults).

    `solref`: time constant [s] and damping ratio; `solimp`: impedance (dmin, dmax, width, midpoint, power);
    `iterations`, `tolerance`: of the solver.
    """

    solref: tuple[float, float] = (0.02, 1.0)
    solimp: tuple[float, float, float, float, float] = (0.9, 0.95, 0.001, 0.5, 2.0)
    iterations: int = 100
    tolerance: float = 1e-8


def mechanism_of(model: Model) -> Mechanism:
    """Return the model's closed chain.

    Raises:
        InputError: it names none.
    """
    if model.closed_chain is None:
        raise InputError(
            f"model '{model.name}' names no closed chain", file=model.source,
            remedy="give a [closed_chain] table",
        )  # fmt: skip
    return model.closed_chain


def loop_spec(
    model: Model, settings: ConstraintSettings | None = None, floating: bool = False
) -> mujoco.MjSpec:
    """Return the closed chain as MJCF: every link a body, rotors and damping on the driven joints.

    Args:
        model: names the SDF file or URDF, drives and loops; gives the actuators and, by its MJCF, gravity.
        settings: of the loop constraints; None leaves the tree cut open.
        floating: the tree hangs on a free body, not on the world.

    Raises:
        InputError: the model names no closed chain, or its file is not a tree of joints that MuJoCo has.
    """
    mechanism = mechanism_of(model)
    tree = read_tree(mechanism.file)
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.option.gravity = load_mjcf(model.serial).option.gravity
    base = spec.worldbody
    if floating:
        base = free_base(spec)
    _grow(spec, tree, base, None, HERE)
    for name in {n for pair in mechanism.loops for n in pair} | ({mechanism.foot} - {None}):
        frame = tree.frame(str(name))
        carrier = base if frame.link is None else spec.body(frame.link)
        carrier.add_site(name=frame.name, pos=frame.place.at, quat=_quat(frame.place))
    drives = zip(mechanism.drives, model.actuators.inertia, model.actuators.damping, strict=True)
    for name, inertia, damping in drives:
        joint = spec.joint(name)
        if joint is None:
            raise InputError(f"no joint is called '{name}'", file=tree.file, remedy="correct 'drives'")
        joint.armature, joint.damping[0] = inertia, damping
    if settings is not None:
        spec.option.iterations, spec.option.tolerance = settings.iterations, settings.tolerance
        for index, (first, second) in enumerate(mechanism.loops):
            loop = spec.add_equality(name=f"loop:{index}")
            loop.type, loop.objtype = mujoco.mjtEq.mjEQ_CONNECT, mujoco.mjtObj.mjOBJ_SITE
            loop.name1, loop.name2 = first, second
            loop.solref, loop.solimp = settings.solref, settings.solimp
        for coupling in mechanism.all_couplings():
            couple(spec, coupling, settings.solref, settings.solimp, tree.file)
    return spec


def free_base(spec: mujoco.MjSpec) -> mujoco.MjsBody:
    """Return a free body for a tree to hang on; it has almost no mass, because MuJoCo needs some."""
    base = spec.worldbody.add_body(name="free base")
    base.add_freejoint()
    base.explicitinertial, base.mass, base.ipos = True, 1e-9, np.zeros(3)
    base.inertia = np.full(3, 1e-12)
    return base


def close_loops(
    m: mujoco.MjModel, model: Model, position: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the state of the cut-open tree with its loops closed, at a state (n,) in serial coordinates.

    The posture is followed from the mechanism's start, so that it stays on the branch the start is on.

    Returns:
        ``(qpos, qvel)`` of the tree.

    Raises:
        SimulationError: the loops cannot be closed there.
    """
    mechanism, data = mechanism_of(model), mujoco.MjData(m)
    serial = [m.joint(name).qposadr[0] for name in mechanism.joints]
    drives = [m.joint(name).qposadr[0] for name in mechanism.drives]
    bound, start = bound_joints(m, mechanism), data.qpos.copy()
    for name, angle in mechanism.start:
        start[m.joint(name).qposadr[0]] = angle

    def miss(theta: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        data.qpos[:] = theta
        mujoco.mj_kinematics(m, data)
        gaps = [data.site(a).xpos - data.site(b).xpos for a, b in mechanism.loops]
        # where J is constant it says where the drives are, which keeps a parallelogram from folding over
        known = [] if model.posture_dependent else [theta[drives] - model.transmission @ wanted]
        return np.concatenate([*gaps, bound.gap(theta), theta[serial] - wanted, *known])

    steps = max(2, int(np.ceil(np.abs(position - start[serial]).max() / 0.1)))
    theta = start
    for wanted in np.linspace(start[serial], position, steps):
        theta = least_squares(miss, theta, args=(wanted,), xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    if np.abs(miss(theta, position)).max() > _CLOSED:
        raise SimulationError(f"the loop cannot be closed at q = {np.round(position, 4).tolist()} rad")
    return theta, tree_projection(m, model, theta) @ velocity


def tree_projection(m: mujoco.MjModel, model: Model, theta: np.ndarray) -> np.ndarray:
    """Return d theta / d q_s, (nv, n): how the tree moves with the serial coordinates, its loops closed."""
    mechanism, data = mechanism_of(model), mujoco.MjData(m)
    data.qpos[:] = theta
    mujoco.mj_kinematics(m, data)
    mujoco.mj_comPos(m, data)
    rows = []
    for pair in mechanism.loops:
        first, second = (np.zeros((3, m.nv)) for _ in pair)
        for jacobian, name in zip((first, second), pair, strict=True):
            mujoco.mj_jacSite(m, data, jacobian, None, m.site(name).id)
        rows.append(first - second)
    serial = np.zeros((len(mechanism.joints), m.nv))
    for index, name in enumerate(mechanism.joints):
        serial[index, m.joint(name).dofadr[0]] = 1.0
    rows.append(bound_joints(m, mechanism).jacobian(theta))
    closed = np.concatenate(rows)
    wanted = np.concatenate([np.zeros((len(closed), len(serial))), np.eye(len(serial))])
    return np.linalg.lstsq(np.concatenate([closed, serial]), wanted, rcond=None)[0]


def _grow(spec: mujoco.MjSpec, tree: SdfTree, base: mujoco.MjsBody, parent: str | None, at: Pose) -> None:
    """Add the links that hang on `parent`, whose frame lies at `at` in the model's frame."""
    links = {link.name: link for link in tree.links}
    for joint in (j for j in tree.joints if j.parent == parent):
        link = links[joint.child]
        here = at.back().then(link.place)
        body = base.add_body(name=link.name, pos=here.at, quat=_quat(here))
        if (
            link.mass > 0.0 or joint.coordinates
        ):  # MuJoCo moves nothing without mass, as links between axes are
            body.explicitinertial, body.mass, body.ipos = True, max(link.mass, _LEAST), link.centre
            i = solid(link.inertia)
            body.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
        slide = joint.kind == "prismatic"
        for name, axis in joint.coordinates:
            body.add_joint(
                name=name,
                type=mujoco.mjtJoint.mjJNT_SLIDE if slide else mujoco.mjtJoint.mjJNT_HINGE,
                pos=joint.place.at,
                axis=joint.place.turn @ axis,
            )
        _grow(spec, tree, body, link.name, link.place)


def solid(inertia: np.ndarray) -> np.ndarray:
    """Return an inertia (3, 3) that MuJoCo accepts: a point mass (a frame in some files) gets a small one."""
    if np.linalg.eigvalsh(inertia)[0] > 0.0:
        return inertia
    return inertia + (_POINT - min(0.0, np.linalg.eigvalsh(inertia)[0])) * np.eye(3)


def _quat(pose: Pose) -> np.ndarray:
    """Return the quaternion (w, x, y, z) of a rotation (3, 3)."""
    return Rotation.from_matrix(pose.turn).as_quat(scalar_first=True)


def couple(
    spec: mujoco.MjSpec, coupling: Coupling, solref: Sequence[float], solimp: Sequence[float], file: Path
) -> None:
    """Add a joint that follows another, as MuJoCo's own equality constraint.

    Raises:
        InputError: it follows by more than MuJoCo's polynomial of the fourth degree.
    """
    if len(coupling.polynomial) > 5:
        raise InputError(
            f"joint '{coupling.joint}' follows by {len(coupling.polynomial)} coefficients", file=file,
            column="closed_chain.couplings", remedy="give five at most",
        )  # fmt: skip
    bound = spec.add_equality(name=f"coupling:{coupling.joint}")
    bound.type, bound.objtype = mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtObj.mjOBJ_JOINT
    bound.name1, bound.name2 = coupling.joint, coupling.follows or ""
    bound.data[:5] = [*coupling.polynomial, *[0.0] * (5 - len(coupling.polynomial))]
    bound.solref, bound.solimp = solref, solimp


def bound_joints(m: mujoco.MjModel, mechanism: Mechanism) -> BoundJoints:
    """Return a mechanism's couplings, for its tree in MuJoCo with loops cut open and no free base.

    Raises:
        InputError: a joint is not in the tree.
    """

    def place(name: str) -> int:
        number = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_JOINT, name)
        if number >= 0:
            return int(m.jnt_dofadr[number])
        raise InputError(
            f"no joint is called '{name}'", file=mechanism.file, column="closed_chain.couplings",
            remedy="correct it",
        )  # fmt: skip

    return BoundJoints.of(mechanism.all_couplings(), place)
