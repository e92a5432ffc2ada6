"""The steps of a simulation: our own, or those with which MuJoCo ran a model's file."""

from __future__ import annotations

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import InputError, Recording
from workbench.effects import Plant, compile_plant
from workbench.models import Model, load_tree, servos_of

_EULER = int(mujoco.mjtIntegrator.mjINT_EULER)
_IMPLICITS = int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST), int(mujoco.mjtIntegrator.mjINT_IMPLICIT)
#: Longest integration step [s]; Runge-Kutta 4 at this step errs by less than 1e-7 rad on the leg.
LONGEST_STEP = 0.001


@dataclass(frozen=True)
class Steps:
    """How a model is integrated from row to row of a recording.

    `per_row`: number of steps; `length`: of each [s]; `integrator`: MuJoCo's number of it, None for
    Runge-Kutta 4; `implicit`: gains on speed of each joint's actuator that it is implicit in, as on damping.
    """

    per_row: int
    length: float
    integrator: int | None = None
    implicit: tuple[float, ...] = ()

    def compiled(self, model: Model, *, grounded: bool = False) -> Plant:
        """Return the plant of a model that is integrated so.

        Raises:
            SimulationError: MuJoCo refuses it.
        """
        plant = compile_plant(model, self.length, grounded=grounded)
        if self.integrator is not None:
            plant.mujoco.opt.integrator = self.integrator
        for name, gain in zip(model.joints, self.implicit, strict=False):
            # (M + h kd) dv = h f, where the torque f has the speed from before the step
            plant.mujoco.dof_armature[plant.mujoco.joint(name).dofadr] += self.length * gain
        return plant


def steps_of(recording: Recording, model: Model) -> Steps:
    """Return the steps with which a model is simulated as a recording was made.

    Raises:
        InputError: it states the steps of the model's file (``[timing] stepped``), which do not fit its rows.
    """
    if not recording.timing.stepped:
        per_row = max(1, int(np.ceil(recording.period / LONGEST_STEP - 1e-9)))
        return Steps(per_row, recording.period / per_row)
    own = load_tree(model.serial).option
    per_row = whole_steps(recording.period, own.timestep)
    if per_row is None:
        raise InputError(
            f"its rows are {recording.period:g} s apart, but the model's file has steps of "
            f"{own.timestep:g} s", file=recording.source, column="timing.stepped",
            remedy="remove it if another model made the recording",
        )  # fmt: skip
    integrator, implicit = int(own.integrator), ()
    if integrator in _IMPLICITS:
        servos, loop = servos_of(model), recording.controller
        if servos and (loop.kp, loop.kd, loop.coordinates) == (servos.kp, servos.kd, "joint"):
            implicit = servos.kd
    if integrator == _EULER and not own.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP):
        integrator = _IMPLICITS[0]  # as Euler is in a joint's damping, but not in that of a drive's tendon
    return Steps(per_row, float(own.timestep), integrator, implicit)


def as_made(model: Model, recording: Recording) -> Model:
    """Return the model with dry friction as soft as in its file, if MuJoCo made the recording."""
    return replace(model, friction_as_in_mjcf=True) if recording.timing.by_mujoco else model


def whole_steps(duration: float, step: float) -> int | None:
    """Return how many steps [s] make a duration [s]; None if no whole number does."""
    count = duration / step
    return None if count < 0.5 or abs(count - round(count)) > 1e-6 else round(count)
