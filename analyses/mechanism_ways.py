"""The worlds that `mechanisms.py` compares: one mechanism in MuJoCo, by each of its ways."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np
from posture_callback import CallbackWorld
from posture_schedule import Schedule
from posture_worlds import ScheduledWorld

from workbench.models import Model, load_mjcf
from workbench.s3n import PostureDependent, fit_native
from workbench.s3n.worlds import World, make_world

PERIOD, SECONDS = 0.004, 2.0
WAYS = ("kin_only", "s3n_frozen", "fitted", "scheduled", "scheduled_4", "callback", "constraint")


class Bench:
    """A mechanism with everything that its ways need.

    Args:
        model: the mechanism.
    """

    def __init__(self, model: Model) -> None:
        # all ways get the same torques: no motor delays or clips them
        free = replace(model.actuators, delay_s=0.0, torque_limit=(np.inf,) * model.size)
        self.model = replace(model, actuators=free)
        self.chain, self.schedule = PostureDependent(model), Schedule(model, beyond="hold")
        self.fitted = fit_native(self.model, allow=None, chain=self.chain)
        self.middle = self.chain.box.mean(axis=1)
        self.frozen = self.chain.jacobian(self.middle[None])[0]

    def plain(self, way: str, step: float = 0.001) -> mujoco.MjModel:
        """The plain MJCF of kin_only, s3n_frozen or fitted."""
        if way == "fitted":
            m = mujoco.MjModel.from_xml_string(self.fitted.xml)
            m.opt.timestep = step
            return m
        spec, actuators = load_mjcf(self.model.serial), self.model.actuators
        rows = np.eye(self.model.size) if way == "kin_only" else self.frozen
        for index, row in enumerate(rows):
            tendon = spec.add_tendon(name=f"drive:{index}")
            tendon.armature, tendon.damping[0] = actuators.inertia[index], actuators.damping[index]
            for name, coefficient in zip(self.model.joints, row, strict=True):
                if coefficient:
                    tendon.wrap_joint(name, float(coefficient))
        spec.option.timestep, spec.option.integrator = step, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        return spec.compile()

    def world(self, way: str, step: float) -> World:
        """One world at rest in the middle of the workspace."""
        start = self.middle, np.zeros_like(self.middle)
        if way.startswith("scheduled"):
            return ScheduledWorld(self.schedule, step, "implicitfast", start, 4 if way.endswith("4") else 1)
        if way == "callback":
            return CallbackWorld(self.schedule, step, "implicitfast", start)
        if way == "constraint":
            return make_world(self.model, way, step, "implicitfast", start=start)
        kind = MotorWorld if way == "fitted" else MappedWorld
        world = kind(self.plain(way, step), self.model.joints, self.frozen, start)
        world.chain = self.chain
        return world

    def law(self, reference: np.ndarray) -> Callable[[int, np.ndarray, np.ndarray], np.ndarray]:
        """Joint PD of the model's size, by virtual work on the drives; stiff enough for 10 Hz or so."""
        kp = 1500.0 * self.chain.mass(self.middle[None])[0].diagonal()
        kd = kp / 25.0

        def torque(row: int, q: np.ndarray, v: np.ndarray) -> np.ndarray:
            j = self.chain.jacobian(np.clip(q, *self.chain.box.T)[None])[0]
            return np.linalg.solve(j.T, kp * (reference[row] - q) - kd * v)

        return torque

    def chirp(self, period: float) -> np.ndarray:
        """Joint reference (N, n) [rad]: 0.5 to 4 Hz, the joints in opposite phase, faded in."""
        t = np.arange(round(SECONDS / period)) * period
        phase = 2 * np.pi * (0.5 * t + (4.0 - 0.5) / (2 * SECONDS) * t**2)
        swing = np.sin(phase) * np.clip(t / 0.3, 0, 1)
        signs = (-1.0) ** np.arange(self.model.size)
        return self.middle + 0.3 * swing[:, None] * signs * np.ptp(self.chain.box, axis=1) / 2.0


class MappedWorld(World):
    """A plain tree whose drives act by virtual work: J^T at the posture at the beginning of each step."""

    chain: PostureDependent

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """Outside the workspace J stays what it is at its edge."""
        for _ in range(steps):
            q = np.clip(self.state()[0], *self.chain.box.T)
            self.data.qfrc_applied[self.dofs] = self.chain.jacobian(q[None])[0].T @ torque
            mujoco.mj_step(self.m, self.data)


class MotorWorld(MappedWorld):
    """The fitted tree, driven by its own motors."""

    def advance(self, torque: np.ndarray, steps: int) -> None:
        """All in C."""
        self.data.ctrl[:] = torque
        mujoco.mj_step(self.m, self.data, steps)
