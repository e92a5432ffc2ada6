"""Drake's own discrete simulation of a mechanism, its loops as constraints, for contact with a ground.

The projection of `closed_chain` is exact but knows no contact. Here the loops are ball constraints of the SAP
solver, which keeps them nearly closed; how nearly, and how far the motion is from the exact one, falls with
the step.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    DiscreteContactApproximation,
    ExternallyAppliedSpatialForce,
)
from pydrake.multibody.tree import SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from workbench.core import InputError, Mechanism, declared_couplings

from .closed_chain import ClosedChain
from .ground import Ground, only_ground, stand
from .loops import loop_pairs, origin
from .parse import finished, parse, quiet


class DiscreteChain:
    """A mechanism in Drake's discrete simulation, with rotors and damping at its drives.

    With a ground, a base that hangs free in the file falls; without one it is held.

    Args:
        mechanism: what is known of it beside its file.
        inertia: of each actuator at its output (n,) [kg m^2].
        damping: of each actuator at its output (n,) [N m s/rad].
        step: of the simulation [s].
        ground: what it stands on, if anything.

    Raises:
        InputError: as for `ClosedChain`.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        inertia: Sequence[float],
        damping: Sequence[float],
        step: float,
        ground: Ground | None = None,
    ) -> None:
        self.mechanism, self.step, self.ground = mechanism, step, ground
        self._chain = ClosedChain(mechanism)
        builder: Any = DiagramBuilder()
        plant, scene = AddMultibodyPlantSceneGraph(builder, step)
        self.plant: Any = plant
        self.plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
        _, model = parse(mechanism.file, self.plant, hold_base=ground is None)
        self._pairs = loop_pairs(self.plant, model, mechanism)
        for first, second in self._pairs[: len(mechanism.loops)]:  # those the file declares are there already
            self.plant.AddBallConstraint(first.body(), origin(first), second.body(), origin(second))
        held = _couple(self.plant, model, mechanism)
        _equip(self.plant, mechanism, inertia, damping)
        self._feet = stand(self.plant, model, mechanism, ground) if ground else []
        finished(self.plant, mechanism.file)
        only_ground(self.plant, model, scene)
        joints = [self.plant.GetJointByName(name, model) for name in mechanism.drives]
        self._positions = [joint.position_start() for joint in joints]
        self._velocities = [joint.velocity_start() for joint in joints]
        self._model = model
        with quiet():  # a half space is not for deformable bodies, which nobody has here
            self._simulator: Any = Simulator(builder.Build())
        self._context = self.plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())
        for joint in held:
            joint.Lock(self._context)
        self._force = self.plant.get_applied_generalized_force_input_port()
        self.reset(self._chain.start[0])

    def reset(self, q: np.ndarray, v: np.ndarray | None = None, base: np.ndarray | None = None) -> None:
        """Back to time zero with closed loops.

        Args:
            q: drive positions (n,).
            v: drive speeds (n,), zero if not given.
            base: pose of a floating base (7,), quaternion w x y z and position [m]; at rest.

        Raises:
            SimulationError: the loops cannot be closed at `q`.
        """
        self._done = 0
        self._simulator.get_mutable_context().SetTime(0.0)
        theta = self._chain.tree_position(q)
        rates = np.zeros_like(theta) if v is None else self._chain.projection(q) @ v
        positions, velocities = self._whole(base)
        plant = self.plant
        for index in plant.GetJointIndices(self._model):
            joint = plant.get_joint(index)
            names = _names(joint)
            if names and names[0] in self._chain.coordinates:
                at = [self._chain.coordinates.index(name) for name in names]
                positions[joint.position_start() : joint.position_start() + len(at)] = theta[at]
                velocities[joint.velocity_start() : joint.velocity_start() + len(at)] = rates[at]
        plant.SetPositions(self._context, positions)
        plant.SetVelocities(self._context, velocities)
        self._simulator.Initialize()

    def kick(self, more: np.ndarray) -> None:
        """Changes the floating base's speed at once, by (6,): angular [rad/s], linear [m/s], in the world."""
        [body] = self.plant.GetFloatingBaseBodies()
        start = self.plant.get_body(body).floating_velocities_start_in_v()
        velocities = self.plant.GetVelocities(self._context)
        velocities[start : start + 6] += more
        self.plant.SetVelocities(self._context, velocities)

    def push(self, force: np.ndarray) -> None:
        """A force on the origin of the floating base, in the world (3,) [N], from now on; zero ends it."""
        pushed = ExternallyAppliedSpatialForce()
        [pushed.body_index], pushed.p_BoBq_B = self.plant.GetFloatingBaseBodies(), np.zeros(3)
        pushed.F_Bq_W = SpatialForce(*np.array([np.zeros(3), force]))
        self.plant.get_applied_spatial_force_input_port().FixValue(self._context, [pushed])

    def load(self, mass: float, at: Sequence[float]) -> None:
        """Fixes a point mass [kg] to the floating base, at a place in its frame (3,) [m]."""
        [index] = self.plant.GetFloatingBaseBodies()
        body = self.plant.get_body(index)
        own = body.CalcSpatialInertiaInBodyFrame(self._context)
        x, y, z = at
        about = UnitInertia(y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z)
        place: Any = np.array(at, float)
        own += SpatialInertia(mass, place, about)
        body.SetSpatialInertiaInBodyFrame(self._context, own)

    def advance(self, torque: np.ndarray) -> None:
        """One step with drive torques (n,) [N m]."""
        forces = np.zeros(self.plant.num_velocities())
        forces[self._velocities] = torque
        self._force.FixValue(self._context, forces)
        self._done += 1
        self._simulator.AdvanceTo(self._done * self.step)  # a sum of steps would drift off Drake's own times

    @property
    def position(self) -> np.ndarray:
        """Drive positions (n,) [rad or m]."""
        return self.plant.GetPositions(self._context)[self._positions]

    @property
    def velocity(self) -> np.ndarray:
        """Drive speeds (n,) [rad/s or m/s]."""
        return self.plant.GetVelocities(self._context)[self._velocities]

    @property
    def base(self) -> np.ndarray:
        """Pose of the floating base (7,), quaternion w x y z and position [m]; empty if it is held."""
        bodies = self.plant.GetFloatingBaseBodies()
        start = [self.plant.get_body(i).floating_positions_start() for i in bodies]
        return self.plant.GetPositions(self._context)[start[0] : start[0] + 7] if start else np.zeros(0)

    @property
    def base_velocity(self) -> np.ndarray:
        """Of the floating base (6,) in the world: angular [rad/s], then linear [m/s]; empty if it is held."""
        bodies = self.plant.GetFloatingBaseBodies()
        start = [self.plant.get_body(i).floating_velocities_start_in_v() for i in bodies]
        return self.plant.GetVelocities(self._context)[start[0] : start[0] + 6] if start else np.zeros(0)

    @property
    def loop_gap(self) -> float:
        """Largest distance [m] between the two frames of a loop."""
        ends = ([f.CalcPoseInWorld(self._context).translation() for f in pair] for pair in self._pairs)
        return max((float(np.linalg.norm(first - second)) for first, second in ends), default=0.0)

    @property
    def ground_force(self) -> np.ndarray:
        """Force of the ground on each foot (F, 3) [N], in the order of `Ground.feet`, in the last step."""
        results = self.plant.get_contact_results_output_port().Eval(self._context)
        forces = np.zeros((len(self._feet), 3))
        for i in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(i)
            for body, sign in ((contact.bodyB_index(), 1.0), (contact.bodyA_index(), -1.0)):
                if body in self._feet:
                    forces[self._feet.index(body)] += sign * contact.contact_force()
        return forces

    def place(self, frame: str) -> np.ndarray:
        """Return where the origin of a frame is in the world (3,) [m]."""
        return self.plant.GetFrameByName(frame).CalcPoseInWorld(self._context).translation()

    def _whole(self, base: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """All positions, with the base where it is wanted or where the file has it, and all speeds, zero."""
        positions = self.plant.GetPositions(self.plant.CreateDefaultContext())
        if base is not None:
            bodies = self.plant.GetFloatingBaseBodies()
            if not bodies:
                raise InputError(
                    "the base is held", file=self.mechanism.file, remedy="give a ground, or no base pose"
                )
            start = self.plant.get_body(next(iter(bodies))).floating_positions_start()
            positions[start : start + 7] = base
        return positions, np.zeros(self.plant.num_velocities())


def _names(joint: Any) -> list[str]:
    """The coordinates of a joint as `ClosedChain.coordinates` names them."""
    count = joint.num_positions()
    return (
        [joint.name()] if count == 1 else [f"{joint.name()}_{joint.position_suffix(i)}" for i in range(count)]
    )


def _equip(plant: Any, mechanism: Mechanism, inertia: Sequence[float], damping: Sequence[float]) -> None:
    """Rotors and damping at the drives, and damping nowhere else."""
    actuators = {a.joint().name(): a for a in map(plant.get_joint_actuator, plant.GetJointActuatorIndices())}
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        if joint.num_velocities():
            joint.set_default_damping_vector(np.zeros(joint.num_velocities()))
    for name, rotor, drag in zip(mechanism.drives, inertia, damping, strict=True):
        joint = plant.GetJointByName(name)
        joint.set_default_damping_vector(np.array([drag]))
        actuator = actuators.get(name) or plant.AddJointActuator(f"{name}_drive", joint)
        actuator.set_default_rotor_inertia(rotor)
        actuator.set_default_gear_ratio(1.0)


def _couple(plant: Any, model: Any, mechanism: Mechanism) -> list[Any]:
    """Couplings of the mechanism, as Drake's own constraints; returns joints that are to be held.

    Raises:
        InputError: a joint follows another along a curve, which Drake's constraint does not.
    """
    by_the_file = {coupling.joint for coupling in declared_couplings(mechanism.file)}
    held = []
    for coupling in mechanism.all_couplings():
        offset, *slopes = *coupling.polynomial, *([] if len(coupling.polynomial) > 1 else [0.0])
        if any(slopes[1:]):
            raise InputError(
                f"joint '{coupling.joint}' follows another along a curve", file=mechanism.file,
                column="closed_chain.couplings", remedy="contact in Drake needs couplings that are lines",
            )  # fmt: skip
        joint = plant.GetJointByName(coupling.joint, model)
        if coupling.follows is None:
            held.append(joint)
        elif coupling.joint not in by_the_file:  # Drake reads those of the file itself
            plant.AddCouplerConstraint(
                joint, plant.GetJointByName(coupling.follows, model), slopes[0], offset
            )
    return held
