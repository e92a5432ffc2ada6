"""Each variant as a world that takes steps: a MuJoCo model, with torques added where it needs them."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.effects import compile_plant
from workbench.models import Model

from .closed_forms import residual_velocity_torque
from .explicit import Injection, injection
from .loop import ConstraintSettings, close_loops, loop_spec, mechanism_of
from .variants import PER_STEP, VARIANT_NAMES, linkage_inertia, need_constant_transmission, with_variant

INTEGRATORS = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
}
State = tuple[np.ndarray, np.ndarray]


class World:
    """A plain variant: all of it is in the MuJoCo model, and steps are taken in C.

    Args:
        m: compiled model.
        joints: names of the serial joints.
        j: d q_p / d q_s, (n, n).
        start: ``(q, v)`` in serial coordinates, or None for the model's own posture at rest.
    """

    def __init__(
        self, m: mujoco.MjModel, joints: tuple[str, ...], j: np.ndarray, start: State | None
    ) -> None:
        self.m, self.data, self.j = m, mujoco.MjData(m), j
        self.places = np.array([m.joint(name).qposadr[0] for name in joints])
        self.dofs = np.array([m.joint(name).dofadr[0] for name in joints])
        if start is not None:
            self.put(*start)

    def put(self, position: np.ndarray, velocity: np.ndarray) -> None:
        """Set the state, serial coordinates (n,), (n,)."""
        self.data.qpos[self.places], self.data.qvel[self.dofs] = position, velocity

    def state(self) -> State:
        """Return position and velocity in serial coordinates, (n,), (n,)."""
        return self.data.qpos[self.places].copy(), self.data.qvel[self.dofs].copy()

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """Take `steps` steps under a torque on the drives (n,)."""
        self.data.qfrc_applied[self.dofs] = self.j.T @ torque
        mujoco.mj_step(self.m, self.data, steps)


class PaperWorld(World):
    """``s3n_full_paper``: a torque at every step takes the velocity terms of the linkage's inertia away."""

    m12 = 0.0

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """Torques follow the velocity at the beginning of each step."""
        on_joints = self.j.T @ torque
        for _ in range(steps):
            q, v = self.data.qpos[self.places], self.data.qvel[self.dofs]
            self.data.qfrc_applied[self.dofs] = on_joints + residual_velocity_torque(self.m12, q, v)
            mujoco.mj_step(self.m, self.data)


class ExplicitWorld(World):
    """``explicit``: the coupling terms as torques from the preceding step's acceleration and velocity."""

    split: Injection

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """Raises SimulationError where the knee comes to an angle at which the injection diverges."""
        on_joints, data = self.j.T @ torque, self.data
        for _ in range(steps):
            alpha = float(data.qpos[self.places[1]])
            self.split.refuse(alpha)
            back = (self.split.coupling + self.split.residual(alpha)) @ data.qacc[self.dofs]
            back += self.split.drag @ data.qvel[self.dofs]
            data.qfrc_applied[self.dofs] = on_joints - back
            mujoco.mj_step(self.m, data)


class LoopWorld(World):
    """``constraint``: torques act on the driven joints of the closed chain itself."""

    drives: np.ndarray

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """All in C."""
        self.data.qfrc_applied[self.drives] = torque
        mujoco.mj_step(self.m, self.data, steps)

    def gap(self) -> float:
        """Return the largest distance between two frames that a loop holds together [m]."""
        mujoco.mj_kinematics(self.m, self.data)
        sites = self.data.site_xpos[np.stack([self.m.eq_obj1id, self.m.eq_obj2id])]
        return float(np.linalg.norm(sites[0] - sites[1], axis=-1).max())


def make_world(
    model: Model,
    variant: str,
    step: float,
    integrator: str = "implicitfast",
    constraint: ConstraintSettings | None = None,
    start: State | None = None,
) -> World:
    """Return a variant ready to run; the arguments are those of `run_variant`.

    Raises:
        InputError: no such variant or integrator, an effect that needs a torque function, or a transmission
            that changes with the posture (any variant but ``constraint``).
        SimulationError: ``explicit`` where it diverges at the start already.
    """
    if variant not in VARIANT_NAMES:
        raise InputError(
            f"no variant is called '{variant}'", remedy=f"choose one of {', '.join(VARIANT_NAMES)}"
        )
    if integrator not in INTEGRATORS:
        raise InputError(
            f"no integrator is called '{integrator}'", remedy=f"choose one of {', '.join(INTEGRATORS)}"
        )
    if variant == "constraint":
        return _loop_world(model, step, integrator, constraint or ConstraintSettings(), start)
    need_constant_transmission(model, f"variant '{variant}'")
    plant = compile_plant(with_variant(model, PER_STEP.get(variant, variant)), step)
    if plant.chain.follows_state:
        raise InputError(
            f"model '{model.name}' has torques that depend on the state", file=model.source,
            remedy="leave their effects out, or simulate the model with workbench.simulation",
        )  # fmt: skip
    m = plant.mujoco
    m.opt.integrator = INTEGRATORS[integrator]
    kind = {"s3n_full_paper": PaperWorld, "explicit": ExplicitWorld}.get(variant, World)
    world = kind(m, model.joints, model.transmission, start)
    if isinstance(world, PaperWorld):
        world.m12 = linkage_inertia(model).M12
    if isinstance(world, ExplicitWorld):
        world.split = injection(model)
        m.dof_armature[world.dofs] += world.split.inertia
        m.dof_damping[world.dofs] += world.split.damping
        mujoco.mj_setConst(m, mujoco.MjData(m))
    return world


def _loop_world(
    model: Model, step: float, integrator: str, settings: ConstraintSettings, start: State | None
) -> LoopWorld:
    mechanism, spec = mechanism_of(model), loop_spec(model, settings)
    spec.option.timestep, spec.option.integrator = step, INTEGRATORS[integrator]
    spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    m = spec.compile()
    world = LoopWorld(m, mechanism.joints, model.transmission, None)
    world.drives = np.array([m.joint(name).dofadr[0] for name in mechanism.drives])
    if start is not None:
        world.data.qpos[:], world.data.qvel[:] = close_loops(m, model, *start)
    return world
