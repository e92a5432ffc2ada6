"""A quadruped on a floor in Drake, that stands, squats and sways: what its drives and a motion capture log.

It shares no code with how models of such machines are run: Drake's rigid bodies and contacts, friction of a
drive by a smooth law in small steps. Legs have three drives each, so that torques alone say how the floor is
pushed: what feet do against each other sideways would else be a state that nothing shows.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from functools import cache

import numpy as np
from pydrake.all import (
    AddContactMaterial,
    AddMultibodyPlantSceneGraph,
    CoulombFriction,
    DiagramBuilder,
    DiscreteContactApproximation,
    FixedOffsetFrame,
    HalfSpace,
    ProximityProperties,
    RevoluteJoint,
    RigidTransform,
    Simulator,
    SpatialInertia,
    Sphere,
    UnitInertia,
)
from scipy.spatial.transform import Rotation

from workbench.core import Controller, Excitation, Recording

LEGS = {"fl": (0.2, 0.1), "fr": (0.2, -0.1), "rl": (-0.2, 0.1), "rr": (-0.2, -0.1)}
AXES = tuple(f"{leg}_{joint}" for leg in LEGS for joint in ("roll", "hip", "knee"))
TRUNK, HIP, THIGH, SHANK = 6.0, 0.4, 0.8, 0.2  # kg
TRUNK_INERTIA, HIP_INERTIA = (0.05, 0.1, 0.12), (5e-4, 5e-4, 5e-4)
THIGH_INERTIA, SHANK_INERTIA = (0.003, 0.003, 0.0005), (8e-4, 8e-4, 1e-5)
LENGTH, FOOT, ROTOR = 0.2, 0.02, 0.01  # m, m, kg m^2
STIFFNESS, DAMPING, FRICTION = 2e4, 100.0, 1.5  # N/m, N s/m
KP, KD = 120.0, 3.0
PERIOD, SUBSTEP, SETTLING = 1e-3, 1e-4, 300  # s, s, rows before the log begins
NOISE = {"q": 1e-4, "w": 5e-3, "u": 0.02, "x": 1e-4, "r": 2e-4, "v": 5e-3, "o": 5e-3, "f": 0.3}

MJCF = f"""<mujoco model="robot">
  <compiler angle="radian"/>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 0.1" contype="0" conaffinity="0"/>
    <body name="trunk" pos="0 0 0.5">
      <freejoint/>
      <inertial pos="0 0 0" mass="{TRUNK}" diaginertia="{" ".join(map(str, TRUNK_INERTIA))}"/>
      <site name="cargo" pos="0.05 0 0.05"/>
      {{legs}}
    </body>
  </worldbody>
</mujoco>
"""
_LEG = f"""<body name="{{leg}}_bracket" pos="{{x}} {{y}} 0">
        <joint name="{{leg}}_roll" axis="1 0 0" armature="{ROTOR}"/>
        <inertial pos="0 0 0" mass="{HIP}" diaginertia="{" ".join(map(str, HIP_INERTIA))}"/>
        <body name="{{leg}}_thigh">
          <joint name="{{leg}}_hip" axis="0 1 0" armature="{ROTOR}"/>
          <inertial pos="0 0 -0.1" mass="{THIGH}" diaginertia="{" ".join(map(str, THIGH_INERTIA))}"/>
          <body name="{{leg}}_shank" pos="0 0 -{LENGTH}">
            <joint name="{{leg}}_knee" axis="0 1 0" armature="{ROTOR}"/>
            <inertial pos="0 0 -0.1" mass="{SHANK}" diaginertia="{" ".join(map(str, SHANK_INERTIA))}"/>
            <geom name="{{leg}}_foot" size="{FOOT}" pos="0 0 -{LENGTH}" mass="0" friction="{FRICTION}"/>
          </body>
        </body>
      </body>"""


def write_robot(folder) -> None:
    """The robot as its maker knows it: ``robot.xml`` and ``robot.toml``."""
    legs = "\n      ".join(_LEG.format(leg=leg, x=x, y=y) for leg, (x, y) in LEGS.items())
    (folder / "robot.xml").write_text(MJCF.format(legs=legs))
    feet = ", ".join(f'"{leg}_foot"' for leg in LEGS)
    (folder / "robot.toml").write_text(
        'format = 1\nname = "robot"\nserial = "robot.xml"\n[payload]\nsite = "cargo"\n'
        f'[ground]\nfeet = [{feet}]\nsurface = "floor"\nstiffness = {STIFFNESS}\ndamping = {DAMPING}\n'
    )


@cache
def recorded(
    seconds: float = 2.0,
    seed: int = 0,
    coulomb: tuple[float, ...] = (),
    damping: tuple[float, ...] = (),
    cargo: float = 0.0,
    friction: float = FRICTION,
    plates: bool = True,
) -> Recording:
    """What is logged while it squats, sways and swings its legs a little.

    Args:
        seconds: how long.
        seed: of noise and of what it is asked to do.
        coulomb, damping: of each drive that the maker does not know [N m, N m s/rad].
        cargo: on the trunk [kg].
        friction: of the floor.
        plates: whether force plates lie under its feet.
    """
    log, generator = _moved(seconds, seed, coulomb, damping, cargo, friction)
    return _logged(log, deepcopy(generator), plates)


@cache
def _moved(
    seconds: float,
    seed: int,
    coulomb: tuple[float, ...],
    damping: tuple[float, ...],
    cargo: float,
    friction: float,
) -> tuple[Mapping[str, np.ndarray], np.random.Generator]:
    """What happens, which no sensor changes, and the generator of what they add."""
    generator = np.random.default_rng(seed)
    coulomb = coulomb or (0.0,) * len(AXES)
    damping = damping or (0.0,) * len(AXES)
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=SUBSTEP)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    trunk = plant.AddRigidBody("trunk", _inertia(TRUNK, TRUNK_INERTIA, np.zeros(3)))
    if cargo:
        load = plant.AddRigidBody("load", SpatialInertia(cargo, np.zeros(3), UnitInertia.SolidSphere(0.001)))
        plant.WeldFrames(trunk.body_frame(), load.body_frame(), RigidTransform([0.05, 0.0, 0.05]))
    _floor(plant, friction)
    joints: list[RevoluteJoint] = []
    for leg, (x, y) in LEGS.items():
        parent = trunk
        for name, (mass, inertia, centre, at, axis) in {
            "roll": (HIP, HIP_INERTIA, 0.0, [x, y, 0.0], [1, 0, 0]),
            "hip": (THIGH, THIGH_INERTIA, -0.1, [0.0, 0.0, 0.0], [0, 1, 0]),
            "knee": (SHANK, SHANK_INERTIA, -0.1, [0.0, 0.0, -LENGTH], [0, 1, 0]),
        }.items():
            body = plant.AddRigidBody(f"{leg}_{name}", _inertia(mass, inertia, np.array([0.0, 0.0, centre])))
            frame = FixedOffsetFrame(f"at_{leg}_{name}", parent.body_frame(), RigidTransform(at))
            joint = plant.AddJoint(
                RevoluteJoint(
                    f"{leg}_{name}",
                    plant.AddFrame(frame),
                    body.body_frame(),
                    axis,
                    damping=damping[len(joints)],
                )
            )
            actuator = plant.AddJointActuator(f"{leg}_{name}", joint)
            actuator.set_default_rotor_inertia(ROTOR)
            actuator.set_default_gear_ratio(1.0)
            joints.append(joint)
            parent = body
        _foot(plant, parent, friction)
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    rows = round(seconds / PERIOD)
    wanted = _wanted(rows, generator)
    plant.SetFreeBodyPose(context, trunk, RigidTransform([0.0, 0.0, _height(wanted[0]) - 0.001]))
    for joint, angle in zip(joints, wanted[0], strict=True):
        joint.set_angle(context, angle)
    simulator.Initialize()
    log: dict[str, list[np.ndarray]] = {k: [] for k in ("q", "w", "u", "x", "R", "v", "o", "f")}
    port = plant.get_actuation_input_port()
    contacts = plant.get_contact_results_output_port()
    bodies = [plant.GetBodyByName(f"{leg}_knee").index() for leg in LEGS]
    friction_of = np.array(coulomb)
    for row in range(-SETTLING, rows):
        q = np.array([j.get_angle(context) for j in joints])
        w = np.array([j.get_angular_rate(context) for j in joints])
        u = KP * (wanted[max(row, 0)] - q) - KD * w
        pose = plant.EvalBodyPoseInWorld(context, trunk)
        rate = plant.EvalBodySpatialVelocityInWorld(context, trunk)
        forces = np.zeros((len(LEGS), 3))
        found = contacts.Eval(context)
        for i in range(found.num_point_pair_contacts()):
            info = found.point_pair_contact_info(i)
            one, other = info.bodyA_index(), info.bodyB_index()
            sign = 1.0 if other in bodies else -1.0
            forces[bodies.index(other if other in bodies else one)] += sign * info.contact_force()
        turn = pose.rotation().matrix()
        for key, value in {
            "q": q, "w": w, "u": u, "x": pose.translation(), "R": turn, "v": rate.translational(),
            "o": turn.T @ rate.rotational(), "f": forces.ravel(),
        }.items():  # fmt: skip
            if row >= 0:
                log[key].append(np.array(value))
        for k in range(round(PERIOD / SUBSTEP)):
            w = np.array([j.get_angular_rate(context) for j in joints])
            port.FixValue(context, u - friction_of * np.tanh(w / 0.02))
            simulator.AdvanceTo((row + SETTLING) * PERIOD + (k + 1) * SUBSTEP)
    return {k: np.array(v) for k, v in log.items()}, generator


def _logged(log: Mapping[str, np.ndarray], generator: np.random.Generator, plates: bool) -> Recording:
    def noisy(key: str, of: str | None = None) -> np.ndarray:
        return log[of or key] + NOISE[key] * generator.standard_normal(log[of or key].shape)

    turn = Rotation.from_matrix(log["R"]) * Rotation.from_rotvec(
        NOISE["r"] * generator.standard_normal((len(log["R"]), 3))
    )
    force = {"ground_force": noisy("f")} if plates else {}
    return Recording(
        name="robot",
        axes=AXES,
        coordinates="actuator",
        time=np.arange(len(log["q"])) * PERIOD,
        signals={
            "position": noisy("q"), "velocity": noisy("w"), "torque_command": log["u"],
            "torque_measured": noisy("u"),
        },
        units=("rad",) * len(AXES),
        controller=Controller("unknown"),
        excitation=Excitation("reference"),
        extra={
            "base_position": noisy("x"), "base_orientation": np.roll(turn.as_quat(), 1, axis=1),
            "base_velocity": noisy("v"), "base_angular_velocity": noisy("o"), **force,
        },
    )  # fmt: skip


def _wanted(rows: int, generator: np.random.Generator) -> np.ndarray:
    """Angles of the drives (rows, 12): all squat together, and each leg does a little of its own."""
    t = np.arange(rows)[:, None] * PERIOD
    ease = np.clip(t / 0.4, 0.0, 1.0)

    def wave(size: float, low: float, high: float, count: int) -> np.ndarray:
        f, start = generator.uniform(low, high, count), generator.uniform(0.0, 6.28, count)
        return size * ease * (np.sin(2.0 * np.pi * f * t + start) - np.sin(start))

    squat = 0.6 + wave(0.1, 1.0, 2.0, 1) + wave(0.003, 0.5, 4.0, 4)
    lean = wave(0.006, 0.5, 2.0, 1) + wave(0.003, 0.5, 4.0, 4)
    roll = wave(0.006, 0.5, 2.0, 1) + wave(0.003, 0.5, 4.0, 4)
    return np.stack([roll, squat + lean, -2.0 * squat], axis=-1).reshape(rows, -1)


def _height(angles: np.ndarray) -> float:
    hip, knee = angles[1], angles[1] + angles[2]
    return LENGTH * (np.cos(hip) + np.cos(knee)) + FOOT


def _inertia(mass: float, principal: tuple[float, float, float], centre: np.ndarray) -> SpatialInertia:
    at_centre = UnitInertia(*(i / mass for i in principal))
    return SpatialInertia(mass, np.zeros(3), at_centre).Shift(-centre)


def _material(friction: float) -> ProximityProperties:
    properties = ProximityProperties()
    # both surfaces give way: of both stiffnesses half is left, and both times of relaxation add up
    AddContactMaterial(0.0, 2.0 * STIFFNESS, CoulombFriction(friction, friction), properties)
    properties.AddProperty("material", "relaxation_time", 0.5 * DAMPING / STIFFNESS)
    return properties


def _floor(plant, friction: float) -> None:
    plant.RegisterCollisionGeometry(
        plant.world_body(), RigidTransform(), HalfSpace(), "floor", _material(friction)
    )


def _foot(plant, shank, friction: float) -> None:
    plant.RegisterCollisionGeometry(
        shank, RigidTransform([0.0, 0.0, -LENGTH]), Sphere(FOOT), f"{shank.name()}_foot", _material(friction)
    )
