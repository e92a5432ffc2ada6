"""Plants for the evaluation of a policy: the closed chain in Drake, or the world of its training."""

from __future__ import annotations

import copy
from collections.abc import Sequence

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.core.paths import closed_chain_file
from workbench.mechanism import DiscreteChain, Ground
from workbench.rigs.quadruped import quadruped_mechanism

from .injected import Injector
from .machine import LEGS, STEP_S, Machine
from .plant import State
from .quadruped import FOOT_RADIUS

_SUBSTEPS = 6  # of Drake in a control step
SUBSTEP_S = STEP_S / _SUBSTEPS
FEET = tuple(f"{leg}_foot" for leg in LEGS)
_LIMB_PIECES = 12  # of a control step in the simulation of a limb: 0.25 ms, as of its hardware


class ClosedChainPlant:
    """Virtual hardware that walks: the reference quadruped with its loops in Drake, on a ground.

    Args:
        machine: of kind ``quadruped``.
        ground: that its feet stand on; default: level and hard.
        inertia, damping: of all drives (n,) [kg m^2, N m s/rad]; default: the machine's.

    Attributes:
        chain: the robot in Drake.

    Raises:
        InputError: the machine's legs are not those of the reference.
    """

    def __init__(
        self, machine: Machine, ground: Ground | None = None, inertia: Sequence[float] | None = None,
        damping: Sequence[float] | None = None,
    ) -> None:  # fmt: skip
        _refuse_other_legs(machine)
        own = machine.model.actuators
        inertia = of_all_drives(own.inertia) if inertia is None else inertia
        damping = of_all_drives(own.damping) if damping is None else damping
        ground = ground or Ground(FEET, FOOT_RADIUS)
        self.chain = DiscreteChain(quadruped_mechanism(), list(inertia), list(damping), SUBSTEP_S, ground)
        self._force = np.zeros((len(LEGS), 3))

    def reset(self, drives: np.ndarray, height: float) -> None:
        """Set it at rest at drive positions (n,), its base level at a height [m]."""
        self.chain.reset(drives, base=np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, height]))
        self._force = np.zeros_like(self._force)

    def advance(self, torque: np.ndarray) -> None:
        """Simulate one control step."""
        force = np.zeros_like(self._force)
        for _ in range(_SUBSTEPS):
            self.chain.advance(self.passed(torque))
            force += self.chain.ground_force
        self._force = force / _SUBSTEPS

    def passed(self, torque: np.ndarray) -> np.ndarray:
        """Return what reaches the links of the drives' torque (n,) [N m] in the next step of Drake: all."""
        return torque

    def motion(self) -> tuple[np.ndarray, np.ndarray]:
        """Return angles and speeds of the rotors, which encoders see, (n,) each: those of the links."""
        return self.chain.position, self.chain.velocity

    def push(self, force: np.ndarray) -> None:
        """Push the base."""
        self.chain.push(force)

    def state(self) -> State:
        """Return the present state."""
        turn, base, rate = np.zeros(9), self.chain.base, self.chain.base_velocity
        mujoco.mju_quat2Mat(turn, base[:4])
        return State(
            *self.motion(),
            np.concatenate([base[4:], base[:4]]),
            np.concatenate([rate[3:], turn.reshape(3, 3).T @ rate[:3]]),
            self._force,
        )


def of_all_drives(of_leg: Sequence[float]) -> list[float]:
    """Return a number of every drive, from those of hip and knee; abductions have the hip's."""
    return [of_leg[0], *of_leg] * len(LEGS)


def _refuse_other_legs(machine: Machine) -> None:
    """The hardware that walks is the reference quadruped: a policy of other legs has none here.

    Raises:
        InputError: the machine's legs are not the reference leg.
    """
    chain, model = machine.model.closed_chain, machine.model
    if chain is not None and chain.file.read_bytes() != closed_chain_file("leg").read_bytes():
        raise InputError(
            f"it walks on legs of {model.name}, but the only walking virtual hardware is the reference "
            "quadruped",
            file=model.source, remedy="evaluate it in a simulator of your own robot",
        )  # fmt: skip


class TrainedPlant:
    """The serial machine of the training, without randomisation.

    A limb on its stand moves in fine steps between two control steps. In training it takes one, with which
    it answers half a step late: a recording shows that, and would be held against the model for it.

    Args:
        machine: the machine.
        world: another MuJoCo model of it, with the same names.
    """

    def __init__(self, machine: Machine, world: mujoco.MjModel | None = None) -> None:
        self._machine, m = machine, world or machine.mujoco
        feet = [f"{leg}_sphere" for leg in LEGS] if machine.floating else []
        if not machine.floating:
            m = copy.copy(m)
            m.opt.timestep = STEP_S / _LIMB_PIECES
        self._m, self._data = m, mujoco.MjData(m)
        self._substeps = round(STEP_S / m.opt.timestep)
        self._feet = [m.geom(foot).id for foot in feet]
        self._force = np.zeros((len(feet), 3))
        self._injector = None if machine.injected is None else Injector(machine, np.asarray, np)

    def reset(self, drives: np.ndarray, height: float) -> None:
        """Set it at rest at drive positions (n,)."""
        m, data = self._machine, self._data
        mujoco.mj_resetData(self._m, data)
        self._force = np.zeros_like(self._force)
        data.qpos[m.places] = m.joint_motion(drives, np.zeros(m.size))[0]
        data.qpos[m.rotors.places] = m.rotors.follow @ data.qpos[m.places]
        if m.floating:
            data.qpos[2] = height

    def advance(self, torque: np.ndarray) -> None:
        """Simulate one control step."""
        self._data.ctrl[:] = torque
        force = np.zeros_like(self._force)
        for _ in range(self._substeps):
            self._inject()
            mujoco.mj_step(self._m, self._data)
            force += self._loads()
        self._force = force / self._substeps

    def _inject(self) -> None:
        """Compensation torques from the step before, where the machine's variant has them."""
        if self._injector is not None:
            data = self._data
            torques = self._injector.torque(data.qpos[None], data.qvel[None], data.qacc[None])
            for dofs, torque in zip(self._injector.dofs, torques, strict=True):
                data.qfrc_applied[dofs] = torque[0]

    def push(self, force: np.ndarray) -> None:
        """Push the base; its origin is that of its body."""
        trunk, data = int(self._m.jnt_bodyid[0]), self._data
        arm = data.xpos[trunk] - data.xipos[trunk]  # MuJoCo pushes at the centre of mass
        data.xfrc_applied[trunk] = [*force, *np.cross(arm, force)]

    def state(self) -> State:
        """Return the present state."""
        m, data = self._machine, self._data
        rotors = m.rotors
        position = np.concatenate([data.qpos[m.places], data.qpos[rotors.places]])
        velocity = np.concatenate([data.qvel[m.dofs], data.qvel[rotors.dofs]])
        if m.map is None:
            motion = rotors.drives @ position, rotors.drives @ velocity
        else:
            motion = m.map.drives(position), m.map.jacobian(position) @ velocity
        if not m.floating:
            return State(*motion, np.zeros(0), np.zeros(0), np.zeros((0, 3)))
        return State(*motion, data.qpos[:7].copy(), data.qvel[:6].copy(), self._force)

    def _loads(self) -> np.ndarray:
        """Force of the ground on each foot (F, 3) in the last step."""
        m, data, loads, six = self._m, self._data, np.zeros((len(self._feet), 3)), np.zeros(6)
        for i in range(data.ncon):
            contact = data.contact[i]
            for side, foot in enumerate((contact.geom1, contact.geom2)):
                if foot in self._feet:
                    mujoco.mj_contactForce(m, data, i, six)
                    world = contact.frame.reshape(3, 3).T @ six[:3]
                    loads[self._feet.index(foot)] += world if side else -world
        return loads
