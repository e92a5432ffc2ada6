"""The reference quadruped: a trunk, and at each hip a bracket that swings outward and one leg."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import InputError
from workbench.core.paths import models_folder
from workbench.models import Model, load_mjcf

LEGS = ("fl", "fr", "rl", "rr")
FOOT_RADIUS = 0.02  # m
HIP_MASS, HIP_INERTIA = 1e-3, 1e-6  # kg, kg m^2: of the hip bracket, which the reference leaves out


def quadruped(leg: mujoco.MjSpec, model: Model) -> mujoco.MjSpec:
    """Return the spec of the reference quadruped: trunk, brackets and four legs."""
    if model.size != 2 or model.payload_site is None:
        raise InputError(
            "a quadruped needs a leg with two drives and a foot", file=model.source, column="payload.site",
            remedy="name the foot's site in [payload]",
        )  # fmt: skip
    spec = load_mjcf(models_folder() / "serial" / "quadruped.xml")
    for key in ("timestep", "integrator", "iterations", "ls_iterations"):
        setattr(spec.option, key, getattr(leg.option, key))
    trunk = spec.body("trunk")
    hips = {name: spec.body(f"{name}_thigh").pos.copy() for name in LEGS}
    for name in LEGS:
        spec.delete(spec.body(f"{name}_thigh"))
    inertia, damping, limit = (
        getattr(model.actuators, key)[0] for key in ("inertia", "damping", "torque_limit")
    )
    for name in LEGS:
        hip = trunk.add_body(name=f"{name}_bracket", pos=hips[name])
        hip.mass, hip.inertia, hip.explicitinertial = HIP_MASS, [HIP_INERTIA] * 3, True
        hip.ipos, hip.iquat = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]  # MuJoCo's writer needs them said
        hip.add_joint(name=f"{name}_abduction", axis=[1, 0, 0], armature=inertia, damping=[damping, 0, 0])
        motor = spec.add_actuator(name=f"{name}_abduction")
        motor.set_to_motor()
        motor.trntype, motor.target = mujoco.mjtTrn.mjTRN_JOINT, f"{name}_abduction"
        motor.ctrllimited, motor.ctrlrange = 1, (-limit, limit)
        spec.attach(leg.copy(), frame=hip.add_frame(), prefix=f"{name}_")
        site = spec.site(f"{name}_{model.payload_site}")
        site.parent.add_geom(
            name=f"{name}_sphere", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[FOOT_RADIUS, 0, 0], pos=site.pos,
            mass=0.0, contype=0, conaffinity=1, friction=[0.8, 0.005, 0.0001], priority=1,
        )  # fmt: skip
        for kind, entry in (
            ("touch", mujoco.mjtSensor.mjSENS_TOUCH),
            ("speed", mujoco.mjtSensor.mjSENS_FRAMELINVEL),
        ):
            spec.add_sensor(
                name=f"{name}_{kind}", type=entry, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=site.name
            )
    spec.worldbody.add_geom(
        name="ground", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], contype=1, conaffinity=0
    )
    return spec


def base_height(m: mujoco.MjModel, joints: tuple[str, ...], posture: np.ndarray, legs: int) -> float:
    """Return the height of the base origin at which the feet just touch the ground [m]."""
    data = mujoco.MjData(m)
    for name, value in zip(joints, np.tile([0.0, *posture], legs), strict=True):
        data.qpos[m.joint(name).qposadr[0]] = value
    data.qpos[:3] = 0.0
    mujoco.mj_kinematics(m, data)
    return float(FOOT_RADIUS - data.geom_xpos[m.geom("fl_sphere").id][2])
