"""An MJCF whose loops are closed by ``<equality>`` as an SDF file with its loops cut open.

Links, joints and inertias are MuJoCo's own, compiled, so that defaults, includes and angles count as they do
there. An SDF joint is at zero where the MJCF's is: positions mean the same in both.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from workbench.core import InputError
from workbench.core.turns import roll_pitch_yaw
from workbench.mechanism.parse import GRAVITY
from workbench.models import NO_FRICTION, Inertial, load_with_loops
from workbench.models.engine import refused

from .converted import Converted
from .mjcf_bonds import across_rod, coupling, ends, free_joints, motors_of, resting, torque_limit

_KINDS = {int(mujoco.mjtJoint.mjJNT_HINGE): "revolute", int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic"}
_NEXT_TO_NOTHING = 1e-9  # kg of a link between two joints of one body: SDF knows no link without mass
_ON_EARTH = 9.75, 9.85  # m/s^2: somewhere on the ground, and what files round it to
_ARM = 0.1  # m between the points that hold what is welded


def convert(file: Path) -> Converted:
    """Read an MJCF with its loops.

    Raises:
        InputError: MuJoCo cannot read it, or it has joints or equalities that no SDF of a mechanism has.
    """
    spec = load_with_loops(file)
    with refused("compile it", file):
        m = spec.compile()
    pull = -float(m.opt.gravity[2])
    if m.opt.gravity[:2].any() or not _ON_EARTH[0] < pull < _ON_EARTH[1]:
        problem = f"gravity is {m.opt.gravity.tolist()}"
        raise InputError(problem, file=file, column="gravity", remedy=f"make it 0 0 -{GRAVITY}")
    return _Writer(m, file).converted()


class _Writer:
    def __init__(self, m: mujoco.MjModel, file: Path) -> None:
        self.m, self.file = m, file
        self.zero = mujoco.MjData(m)
        self.free = free_joints(m)
        for j in range(m.njnt):
            if j in self.free:
                continue
            if not m.joint(j).name:
                raise InputError("a joint has no name", file=file, remedy="give every joint a name")
            if m.jnt_type[j] != mujoco.mjtJoint.mjJNT_BALL:
                self.zero.qpos[m.jnt_qposadr[j]] = 0.0
        mujoco.mj_kinematics(m, self.zero)
        self.taken = {m.joint(j).name for j in range(m.njnt)}
        sites = [m.site(s).name for s in range(m.nsite) if m.site(s).name]
        self.frames = {name: self._name(name, "site") for name in sites}
        self.links = [
            "world",
            *(self._name(m.body(b).name or f"body_{b}", "link") for b in range(1, m.nbody)),
        ]
        root = ElementTree.Element("sdf", version="1.9")
        self.model = ElementTree.SubElement(root, "model", name=file.stem)
        self.root = root

    def converted(self) -> Converted:
        m = self.m
        for body in range(1, m.nbody):
            self._body(body)
        for s in range(m.nsite):
            if m.site(s).name:
                self._frame(self.frames[m.site(s).name], int(m.site_bodyid[s]), m.site_pos[s], m.site_quat[s])
        active = [e for e in range(m.neq) if m.eq_active0[e]]
        bound = [e for e in active if m.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT]
        loops = [pair for e in active if e not in bound for pair in self._loop(e)]
        ElementTree.indent(self.root)
        own = [j for j in range(m.njnt) if j not in self.free]
        moving = [j for j in own if int(m.jnt_type[j]) in _KINDS]
        joints = {m.joint(j).name: int(m.jnt_dofadr[j]) for j in moving}
        frictionless = m.opt.disableflags & NO_FRICTION
        return Converted(
            ElementTree.tostring(self.root, encoding="unicode") + "\n",
            ".sdf",
            tuple(loops),
            len(active) - len(bound),
            couplings=tuple(coupling(m, e, self.file) for e in bound),
            round_rods=tuple(m.joint(j).name for j in own if m.jnt_type[j] == mujoco.mjtJoint.mjJNT_BALL),
            armature={name: float(m.dof_armature[dof]) for name, dof in joints.items()},
            damping={name: float(m.dof_damping[dof]) for name, dof in joints.items()},
            friction={} if frictionless else {n: float(m.dof_frictionloss[dof]) for n, dof in joints.items()},
            torque_limit={m.joint(j).name: torque_limit(m, j) for j in moving},
            motors=tuple(m.joint(j).name for j in moving if motors_of(m, j).size),
            springs=tuple(m.joint(j).name for j in moving if m.jnt_stiffness[j] > 0.0),
            start=resting(m, moving),
            gravity=-float(m.opt.gravity[2]),
        )

    def _name(self, wanted: str, kind: str) -> str:
        """A name that nothing else in the SDF has: there links, joints and frames share theirs."""
        more = (f"{wanted}_{kind}{k or ''}" for k in range(self.m.nbody + self.m.nsite + self.m.neq + 2))
        name = next(name for name in (wanted, *more) if name not in self.taken)
        self.taken.add(name)
        return name

    def _body(self, body: int) -> None:
        m, parent = self.m, self.links[int(self.m.body_parentid[body])]
        joints = range(int(m.body_jntadr[body]), int(m.body_jntadr[body]) + int(m.body_jntnum[body]))
        moving = [j for j in joints if j not in self.free]
        turns = [turn for j in moving for turn in self._turns(j)]
        for j, name, axis in turns[:-1]:
            between = self._name(f"{self.links[body]}_{name}", "link")
            self._link(between, body, _NEXT_TO_NOTHING)
            self._joint((j, name, axis), parent, between)
            parent = between
        self._link(self.links[body], body, None)
        if turns:
            self._joint(turns[-1], parent, self.links[body])
        elif not len(joints):
            name = self._name(f"{self.links[body]}_fixed", "joint")
            joint = ElementTree.SubElement(self.model, "joint", name=name, type="fixed")
            ElementTree.SubElement(joint, "parent").text = parent
            ElementTree.SubElement(joint, "child").text = self.links[body]

    def _link(self, name: str, body: int, mass: float | None) -> None:
        m, link = self.m, ElementTree.SubElement(self.model, "link", name=name)
        turn = Rotation.from_quat(self.zero.xquat[body], scalar_first=True)
        ElementTree.SubElement(link, "pose").text = _pose(self.zero.xpos[body], turn)
        inertial = ElementTree.SubElement(link, "inertial")
        about, centre = 1e-3 * _NEXT_TO_NOTHING * np.eye(3), np.zeros(3)
        if mass is None and m.body_mass[body] > 0.0:
            own = Inertial.of(m, body)
            about, centre, mass = own.tensor, own.centre, own.mass
        ElementTree.SubElement(inertial, "pose").text = _pose(centre, Rotation.identity())
        ElementTree.SubElement(inertial, "mass").text = repr(mass or _NEXT_TO_NOTHING)
        inertia = ElementTree.SubElement(inertial, "inertia")
        for key in ("xx", "yy", "zz", "xy", "xz", "yz"):
            value = about["xyz".index(key[0]), "xyz".index(key[1])]
            ElementTree.SubElement(inertia, f"i{key}").text = repr(float(value) + 0.0)

    def _turns(self, j: int) -> list[tuple[int, str, np.ndarray]]:
        """A joint as those with one coordinate: itself, its name and axis; of a ball two, across its rod."""
        m, name = self.m, self.m.joint(j).name
        if m.jnt_type[j] != mujoco.mjtJoint.mjJNT_BALL:
            return [(j, name, m.jnt_axis[j])]
        axes = across_rod(m, j, self.file)
        return [(j, self._name(f"{name}_{k}", "joint"), axis) for k, axis in enumerate(axes)]

    def _joint(self, turn: tuple[int, str, np.ndarray], parent: str, child: str) -> None:
        m, (j, name, along) = self.m, turn
        kind = _KINDS.get(int(m.jnt_type[j]), "revolute")
        joint = ElementTree.SubElement(self.model, "joint", name=name, type=kind)
        ElementTree.SubElement(joint, "parent").text = parent
        ElementTree.SubElement(joint, "child").text = child
        ElementTree.SubElement(joint, "pose").text = _pose(m.jnt_pos[j], Rotation.identity())
        axis = ElementTree.SubElement(joint, "axis")
        ElementTree.SubElement(axis, "xyz").text = " ".join(repr(float(x) + 0.0) for x in along)
        if m.jnt_limited[j] and int(m.jnt_type[j]) in _KINDS:
            limit = ElementTree.SubElement(axis, "limit")
            for key, value in zip(("lower", "upper"), m.jnt_range[j], strict=True):
                ElementTree.SubElement(limit, key).text = repr(float(value))

    def _frame(self, name: str, body: int, at: np.ndarray, quat: np.ndarray | None = None) -> None:
        frame = ElementTree.SubElement(self.model, "frame", name=name)
        if body:
            frame.set("attached_to", self.links[body])
        turn = Rotation.identity() if quat is None else Rotation.from_quat(quat, scalar_first=True)
        ElementTree.SubElement(frame, "pose").text = _pose(at, turn)

    def _loop(self, e: int) -> Iterator[tuple[str, str]]:
        """Frames on both bodies at each point that an equality holds together."""
        m = self.m
        weld = m.eq_type[e] == mujoco.mjtEq.mjEQ_WELD
        name = m.eq(e).name or f"loop{e}"
        corners = _ARM * np.vstack([np.zeros(3), np.eye(3)[:2]]) if weld else np.zeros((1, 3))
        for k, corner in enumerate(corners):
            pair = []
            for side, (body, at, quat) in zip(("a", "b"), ends(m, e), strict=True):
                turn = Rotation.from_quat(quat, scalar_first=True) if weld else Rotation.identity()
                pair.append(self._name(f"{name}{k or ''}_{side}", "frame"))
                self._frame(pair[-1], body, at + turn.apply(corner))
            yield pair[0], pair[1]


def _pose(at: np.ndarray, turn: Rotation) -> str:
    return " ".join(repr(float(x) + 0.0) for x in (*at, *roll_pitch_yaw(turn)))
