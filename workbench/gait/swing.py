"""Prediction of the legs in the air, one policy step ahead, from encoders, torques and the base's motion.

Legs know of each other only through the acceleration of the base, and that was measured: with the trunk made
so heavy that nothing moves it, and pushed so that it moves as measured, every leg answers to its own torques
alone. No contact and no policy takes part, which makes this a test of the leg's dynamics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from workbench.core import InputError, Recording

from .bootstrap import Interval, resampled

HORIZON_S = 0.018  # one policy step
_STEP_S = 1e-3  # of the prediction, at most
_HEAVY = 1e7  # kg and kg m^2
_HIGH = 0.01  # m over the lowest foot: a foot in the air, where no force tells
LOADED = 1.0  # N
NEEDS = ("base_orientation", "base_angular_velocity", "base_velocity")


@dataclass(frozen=True)
class Limbs:
    """Legs on a floating base, in MuJoCo.

    Attributes:
        m: the compiled robot; its base's free joint comes first.
        places, dofs: of the k joints that the drives move, in qpos and qvel (k,).
        begin: angles of these joints from those of the n serial joints, (k, n).
        read: positions of the n drives from these joints, (n, k).
        transmission: J (n, n), q_p = J q_s.
        legs: of each leg its feet's geom and its drives, base first.
        labels: what the drives of one leg are called.
        motors: whether the model's motors are the drives, in their order; else torques act on the joints.
    """

    m: mujoco.MjModel
    places: np.ndarray
    dofs: np.ndarray
    begin: np.ndarray
    read: np.ndarray
    transmission: np.ndarray
    legs: tuple[tuple[int, tuple[int, ...]], ...]
    labels: tuple[str, ...]
    motors: bool


@dataclass(frozen=True)
class SwingPrediction:
    """Error of the predicted change of speed over that change, rms, by drive of a leg; swings seen."""

    error: dict[str, Interval]
    count: int


def limbs_of(
    m: mujoco.MjModel, joints: Sequence[str], transmission: np.ndarray, feet: Sequence[str],
    rotors: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray] | None = None,
) -> Limbs:  # fmt: skip
    """Return the legs of a compiled robot.

    Args:
        m: the robot.
        joints: its n serial joints.
        transmission: J (n, n).
        feet: geoms.
        rotors: where the drives have joints of their own: their places, dofs, angles from the serial joints
            (r, n), and the drives' positions from joints and these (n, n + r).

    Raises:
        InputError: the base is not free, or legs have different numbers of joints.
    """
    if not m.njnt or m.jnt_type[0] != mujoco.mjtJoint.mjJNT_FREE:
        raise InputError(
            "the model's base does not float", remedy="give its MJCF a <freejoint/> at the trunk"
        )
    n = len(joints)
    places = np.array([m.joint(j).qposadr[0] for j in joints])
    dofs = np.array([m.joint(j).dofadr[0] for j in joints])
    begin, read = np.eye(n), np.asarray(transmission, float)
    if rotors is not None:
        places, dofs = np.append(places, rotors[0]), np.append(dofs, rotors[1])
        begin, read = np.vstack([begin, rotors[2]]), rotors[3]
    own = {int(m.joint(j).bodyid[0]): k for k, j in enumerate(joints)}
    legs = []
    for foot in feet:
        geom = m.geom(foot).id
        body, chain = int(m.geom_bodyid[geom]), []
        while body > 0:
            chain += [own[body]] if body in own else []
            body = int(m.body_parentid[body])
        legs.append((geom, tuple(reversed(chain))))
    if len({len(chain) for _, chain in legs}) != 1 or not legs[0][1]:
        raise InputError(
            "feet hang on chains of different lengths", remedy="name one foot per leg in [ground]"
        )
    labels = tuple(joints[k].split("_", 1)[-1] for k in legs[0][1])
    return Limbs(
        m, places, dofs, begin, read, np.asarray(transmission, float), tuple(legs), labels, m.nu == n
    )


def predict_swing(limbs: Limbs, recording: Recording, first_row: int = 0) -> SwingPrediction | None:
    """Return how well a model foretells the drives' speeds in legs that are in the air throughout.

    Every `HORIZON_S` the model starts from the measured joints and speeds, gets the measured torques, and its
    base moves as measured. None where no foot was in the air for so long.

    Args:
        limbs: the model.
        recording: in actuator coordinates, with torque_measured and the base's orientation and rates; feet
            are in the air where ``ground_force`` says so, else where they are well over the lowest.
        first_row: where it begins.

    Raises:
        InputError: the recording lacks one of these.
    """
    check(recording)
    rows, period = len(recording), recording.period
    ahead = max(1, round(HORIZON_S / period))
    joints = recording.position @ np.linalg.inv(limbs.transmission).T
    speeds = recording.velocity @ np.linalg.inv(limbs.transmission).T
    air = in_air(limbs, recording, joints)
    run = _Run(limbs, recording)
    gaps: dict[str, list[list[float]]] = {label: [] for label in limbs.labels}
    count = 0
    for row in range(first_row, rows - ahead, ahead):
        flying = air[row : row + ahead + 1].all(axis=0)
        if not flying.any() or not recording.valid[row : row + ahead + 1].all():
            continue
        ahead_speed = run.ahead(row, ahead, joints[row], speeds[row])
        missed = ahead_speed - recording.velocity[row + ahead]
        changed = recording.velocity[row + ahead] - recording.velocity[row]
        for leg in np.flatnonzero(flying):
            count += 1
            for label, k in zip(limbs.labels, limbs.legs[leg][1], strict=True):
                gaps[label].append([missed[k] ** 2, changed[k] ** 2])
    if not count:
        return None
    return SwingPrediction(
        {
            label: resampled(lambda m: np.sqrt(m[..., 0] / m[..., 1]), np.array(each))
            for label, each in gaps.items()
        },
        count,
    )


def check(recording: Recording) -> None:
    """Raise an `InputError` where a recording lacks what a prediction needs."""
    lacking = [name for name in NEEDS if name not in recording.extra]
    if recording.get("torque_measured") is None:
        lacking.insert(0, "torque_measured")
    if lacking:
        raise InputError(
            f"the swing leg's prediction needs {', '.join(lacking)}", file=recording.source,
            remedy="name their columns",
        )  # fmt: skip
    if recording.coordinates != "actuator":
        raise InputError(
            "the swing leg's prediction needs the drives' own positions", file=recording.source,
            column="coordinates", remedy="give a recording in actuator coordinates",
        )  # fmt: skip


def in_air(limbs: Limbs, recording: Recording, joints: np.ndarray) -> np.ndarray:
    """Return whether each foot is in the air (N, F), by its force, else by its height over the lowest
    foot.
    """
    force = recording.extra.get("ground_force")
    if force is not None and force.shape[1] == 3 * len(limbs.legs):
        return np.linalg.norm(force.reshape(len(force), -1, 3), axis=-1) < LOADED
    data, feet = mujoco.MjData(limbs.m), [foot for foot, _ in limbs.legs]
    height = np.zeros((len(joints), len(feet)))
    for row, (q, turn) in enumerate(zip(joints, recording.extra["base_orientation"], strict=True)):
        data.qpos[3:7] = turn
        data.qpos[limbs.places] = limbs.begin @ q
        mujoco.mj_kinematics(limbs.m, data)
        height[row] = data.geom_xpos[feet, 2]
    return height > height.min(axis=1, keepdims=True) + _HIGH


class _Run:
    """A robot whose trunk moves as recorded, with legs in the air."""

    def __init__(self, limbs: Limbs, recording: Recording) -> None:
        m = limbs.m.__copy__()
        trunk = int(m.jnt_bodyid[0])
        m.body_mass[trunk], m.body_inertia[trunk] = _HEAVY, _HEAVY
        m.body_ipos[trunk], m.body_iquat[trunk] = 0.0, (1.0, 0.0, 0.0, 0.0)
        self.substeps = int(np.ceil(recording.period / _STEP_S - 1e-9))
        m.opt.timestep = recording.period / self.substeps
        m.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        self.m, self.data, self.limbs = m, mujoco.MjData(m), limbs
        mujoco.mj_setConst(m, self.data)
        extra, period = recording.extra, recording.period
        self.turn = extra["base_orientation"]
        self.rate = np.hstack([extra["base_velocity"], extra["base_angular_velocity"]])
        self.faster = np.diff(self.rate, axis=0) / period
        self.torque = recording.signals["torque_measured"]

    def ahead(self, row: int, rows: int, joints: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """Speeds of the drives (n,) so many rows later."""
        m, data, limbs = self.m, self.data, self.limbs
        mujoco.mj_resetData(m, data)
        data.qpos[limbs.places], data.qvel[limbs.dofs] = limbs.begin @ joints, limbs.begin @ speeds
        for k in range(row, row + rows):
            # 1 m up or down is nothing to legs in the air
            data.qpos[:3], data.qpos[3:7], data.qvel[:6] = 0.0, self.turn[k], self.rate[k]
            data.qfrc_applied[:] = 0.0
            data.qfrc_applied[:3] = _HEAVY * (self.faster[k, :3] - m.opt.gravity)
            data.qfrc_applied[3:6] = _HEAVY * self.faster[k, 3:]
            if limbs.motors:
                data.ctrl[:] = self.torque[k]
            else:
                data.qfrc_applied[limbs.dofs] = limbs.read.T @ self.torque[k]
            for _ in range(self.substeps):
                mujoco.mj_step(m, data)
        return limbs.read @ data.qvel[limbs.dofs]
