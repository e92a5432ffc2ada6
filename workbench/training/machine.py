"""The machine of a policy: one leg on a fixed base, or four legs under a floating trunk.

Both are made from the model of one leg, normalised (see `workbench.s3n`), so that whatever a comparison found
missing in the leg is in every leg that trains. The motors' delay is left out of MuJoCo: the loop of
`control` holds every torque back, and a delay has to be produced once.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import DriveMap, InputError
from workbench.importing import is_reference_leg
from workbench.models import Model, load_tree
from workbench.s3n import PostureDependent, drive_map, fit_native, normalise
from workbench.s3n.explicit import Injection
from workbench.s3n.mjcf import exact_xml
from workbench.s3n.posture_fitted import ALLOWED, left_out

from .floor import lay_floor
from .injected import EXPLICIT, split
from .quadruped import LEGS, base_height, quadruped
from .rotors import Rotors, no_rotors, rotors_of

STEP_S = 0.003  # simulation and control
STIFF_S = 2.0 * STEP_S  # of the stiffest contact that this step allows; MuJoCo's default is 20 ms
POLICY_STEPS = 6  # control steps a policy step: 18 ms
ABDUCTION_LIMIT = 0.6  # rad
# under a trunk the hold posture of the single leg falls over backwards: Kp = 50 gives way, this one stands
_STAND = np.array([-0.75, 1.2])  # rad
_LOWEST = 0.4943  # of the height in its posture
_SOLVER = 10, 20  # iterations of the solver and of its line search


@dataclass(frozen=True)
class Machine:
    """A machine ready for many parallel simulations.

    Arrays over the n joints have one block per leg, in the order of `LEGS`; q_p = transmission q_s.

    Attributes:
        kind: ``leg`` or ``quadruped``.
        model: the leg it is made of, as the variant that trains.
        xml: the whole machine as plain MJCF.
        mujoco: the same, compiled.
        joints: names of the serial joints, length n.
        places, dofs: where they are in qpos and in qvel, both (n,).
        transmission: J (n, n) (paper, Eq. 1), of one posture where `map` is.
        kp, kd: gains of the joints' PD loop (n,) [N m/rad, N m s/rad].
        torque_limit: of the drives (n,) [N m].
        delay_steps: control steps from reading to torque.
        posture: joint angles from which actions count (n,) [rad].
        limits: lower and upper joint limits (n, 2) [rad].
        height: of the base's origin over the ground in this posture [m]; 0 for a leg.
        rotors: joints on the motors' sides of what is soft or has play.
        left_out: effects of the model that plain MJCF cannot hold; the policy does not see them.
        map: the drives' positions where the transmission changes with the posture; None where it is constant.
        injected: torques that no file holds, of the variant ``explicit``; None of all others.
    """

    kind: str
    model: Model
    xml: str
    mujoco: mujoco.MjModel
    joints: tuple[str, ...]
    places: np.ndarray
    dofs: np.ndarray
    transmission: np.ndarray
    kp: np.ndarray
    kd: np.ndarray
    torque_limit: np.ndarray
    delay_steps: int
    posture: np.ndarray
    limits: np.ndarray
    height: float
    rotors: Rotors
    left_out: tuple[str, ...]
    map: DriveMap | None = None
    injected: Injection | None = None

    @property
    def variant(self) -> str:
        """Return what is simulated: the model's variant, or ``explicit``."""
        return self.model.variant if self.injected is None else EXPLICIT

    def drive_position(self, joints: np.ndarray) -> np.ndarray:
        """Return drive positions (..., n) at joint positions (..., n)."""
        return joints @ self.transmission.T if self.map is None else self.map.drives(joints)

    def joint_motion(self, drives: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return joint positions and speeds (n,) for those of the drives (n,)."""
        if self.map is not None:
            joints = self.map.joints(drives)
            return joints, self.map.joint_speed(joints, speeds)
        back = np.linalg.inv(self.transmission).T
        return drives @ back, speeds @ back

    @property
    def size(self) -> int:
        """Return the number of joints n."""
        return len(self.joints)

    @property
    def lowest(self) -> float:
        """Return the height of the base origin below which the robot has fallen [m]: 0.18 m for the
        reference quadruped.
        """
        return _LOWEST * self.height

    @property
    def floating(self) -> bool:
        """Return whether it has a trunk, feet and a ground."""
        return self.kind == "quadruped"

    @property
    def digest(self) -> str:
        """Return the SHA-256 of the MJCF text, hexadecimal."""
        return hashlib.sha256(self.xml.encode()).hexdigest()


def make_machine(
    kind: str, model: Model, variant: str | None = None, fitted: tuple[str, DriveMap] | None = None,
    stiff: bool = False,
) -> Machine:  # fmt: skip
    """Return the machine of this kind, made from the model of a leg.

    Args:
        kind: ``leg`` or ``quadruped``.
        model: a leg with two drives, hip and knee, and a PD loop in joint coordinates.
        variant: a plain variant of S3N in place of the model's own, or ``explicit``.
        fitted: MJCF and drives' positions of a limb whose transmission changes, where that was done before.
        stiff: whether a quadruped's contacts are as stiff as the step allows, not MuJoCo's default.

    Raises:
        InputError: the model has another loop, a delay that is no whole number of control steps, no foot, or
            is not a leg with a hip and a knee (quadruped).
    """
    gains = model.controller
    if gains.kind != "pd" or gains.coordinates != "joint":
        raise InputError(
            "policies act through a PD loop in joint coordinates", file=model.source, column="controller",
            remedy='give kind = "pd", coordinates = "joint", kp and kd',
        )  # fmt: skip
    if model.posture_dependent and (kind != "leg" or variant not in (None, model.variant)):
        raise InputError(
            "its transmission changes with the posture: it has no variants, and no quadruped is made of it",
            file=model.source, column="transmission.posture_dependent",
            remedy="train it as the limb that it is, without --variant",
        )  # fmt: skip
    steps = model.actuators.delay_s / STEP_S
    if abs(steps - round(steps)) > 1e-6:
        raise InputError(
            f"a delay of {model.actuators.delay_s:g} s is not a whole number of {STEP_S:g} s steps",
            file=model.source, column="actuators.delay_s", remedy="round it",
        )  # fmt: skip
    # four legs under a trunk stand on the task's floor; what is known of the leg's is put there later
    ground = model.ground if kind == "leg" else None
    prompt = replace(model, actuators=replace(model.actuators, delay_s=0.0), ground=ground)
    if model.posture_dependent:
        missing = left_out(prompt)
        own, text, drives = prompt, *(fitted or _fitted(prompt))
    else:
        tree, drives = normalise(prompt, "kin_only" if variant == EXPLICIT else variant), None
        own, text, missing = tree.model, tree.xml, tree.left_out
    leg = mujoco.MjSpec.from_string(text)
    leg.option.timestep = STEP_S
    leg.option.iterations, leg.option.ls_iterations = _SOLVER
    injected = split(leg, prompt) if variant == EXPLICIT else None
    spec = leg if kind == "leg" else quadruped(leg, model)
    spec.compile()
    floor: tuple[str, ...] = ()
    if kind == "quadruped":
        if stiff:
            for foot in LEGS:
                spec.geom(f"{foot}_sphere").solref = STIFF_S, 1.0
        floor = lay_floor(spec, model, [f"{leg}_sphere" for leg in LEGS], "ground")
    xml = exact_xml(spec)
    compiled = mujoco.MjModel.from_xml_string(xml)
    names = model.joints if kind == "leg" else ("abduction", *model.joints)
    joints = names if kind == "leg" else tuple(f"{leg}_{name}" for leg in LEGS for name in names)
    first = 0 if kind == "leg" else 1
    block = np.eye(len(names))
    block[first:, first:] = model.transmission
    legs = len(joints) // len(names)

    def per_joint(values: tuple[float, ...]) -> np.ndarray:
        return np.tile([*values[:first], *values], legs).astype(float)

    posture = _STAND if kind == "quadruped" else _posture(model)
    limits = _limits(model)
    return Machine(
        kind=kind,
        model=own,
        xml=xml,
        mujoco=compiled,
        joints=joints,
        places=np.array([compiled.joint(name).qposadr[0] for name in joints]),
        dofs=np.array([compiled.joint(name).dofadr[0] for name in joints]),
        transmission=np.kron(np.eye(legs), block),
        kp=per_joint(gains.kp),
        kd=per_joint(gains.kd),
        torque_limit=per_joint(model.actuators.torque_limit),
        delay_steps=round(steps),
        posture=np.tile([0.0] * first + posture.tolist(), legs),
        limits=np.tile([[-ABDUCTION_LIMIT, ABDUCTION_LIMIT]] * first + [list(x) for x in limits], (legs, 1)),
        height=0.0 if kind == "leg" else base_height(compiled, joints, posture, legs),
        rotors=rotors_of(compiled, joints) if drives is None else no_rotors(len(joints)),
        left_out=(*missing, *floor),
        map=drives,
        injected=injected,
    )


def _fitted(model: Model) -> tuple[str, DriveMap]:
    """MJCF and drives' positions of a model whose transmission changes; takes some seconds."""
    chain = PostureDependent(model)
    found = drive_map(model, chain)
    assert found is not None
    fitted = fit_native(model, allow=None, chain=chain)
    if not fitted.error.inertia_max <= ALLOWED:
        raise InputError(
            f"in the tree that it would train in the inertia of '{model.name}' is off by up to "
            f"{fitted.error.inertia_max:.1%} (at {fitted.error.inertia_at}), and {ALLOWED:.0%} are allowed",
            file=model.source, column="closed_chain.limits",
            remedy="narrow the limits to postures farther from that",
        )  # fmt: skip
    return fitted.xml, found


def _posture(model: Model) -> np.ndarray:
    """The reference leg's hold posture, another's zero, or the middle of the limits where that is outside."""
    wanted = np.array([-0.55, np.pi / 3]) if is_reference_leg(model) else np.zeros(model.size)
    limits = np.array(_limits(model))
    inside = bool(((wanted > limits[:, 0]) & (wanted < limits[:, 1])).all())
    return wanted if inside else limits.mean(axis=1)


def _limits(model: Model) -> tuple[tuple[float, float], ...]:
    """Lower and upper limit of each joint: the closed chain's, else the tree's, else a half turn each way."""
    if model.closed_chain and model.closed_chain.limits:
        return model.closed_chain.limits
    tree = load_tree(model.serial).compile()
    ranges = [tree.joint(name) for name in model.joints]
    whole = (-float(np.pi), float(np.pi))
    return tuple((float(j.range[0]), float(j.range[1])) if tree.jnt_limited[j.id] else whole for j in ranges)
