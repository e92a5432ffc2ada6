"""A scripted jump: bend, stretch all legs together, land. No policy and no training is used.

What the legs weigh and what turns with their drives decides how fast the trunk leaves the ground.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from transfer_robot import IDEAL, Robot

from workbench.rigs import Sensors
from workbench.training.machine import LEGS, STEP_S, Machine
from workbench.training.plant import Plant
from workbench.training.rollout import Log, run
from workbench.training.situation import Array, Situation

SECONDS = 1.6
_CROUCH_S, _REST_S, _STRETCH_S, _TUCK_S = 0.4, 0.3, 0.12, 0.1
#: Hip and knee with the foot under the hip, folded and stretched [rad].
_FOLDED, _STRETCHED = (-1.15, 1.88), (-0.32, 0.55)
_LOADED = 1.0  # N on all feet together


@dataclass(frozen=True)
class Jump:
    """Largest height of the origin of the trunk [m], and its largest upward speed [m/s].

    `peak_force` is the largest sum of the feet's forces while it pushes off [N].
    """

    apex: float
    take_off: float
    peak_force: float


class Script:
    """Joint angles over time, linear between points.

    Args:
        times: (K,) [s].
        joints: (K, n) [rad].
    """

    def __init__(self, times: np.ndarray, joints: np.ndarray) -> None:
        self._times, self._joints = times, joints

    def target(self, since: int, now: Situation) -> Array:
        """Return the commanded joint angles (1, n)."""
        at = float(now.elapsed[0])
        return np.array([[np.interp(at, self._times, column) for column in self._joints.T]])


def jump_script(machine: Machine, height: float = 1.0) -> Script:
    """Return the jump of a quadruped; `height` is the share of the full stretch."""
    legs = len(LEGS)
    folded = np.tile([0.0, *_FOLDED], legs)
    stretched = folded + height * (np.tile([0.0, *_STRETCHED], legs) - folded)
    steps = np.cumsum([0.0, _CROUCH_S, _REST_S, 1e-6, _STRETCH_S, _TUCK_S])
    rows = [machine.posture, folded, folded, stretched, stretched, machine.posture]
    return Script(steps, np.array(rows))


def jump(
    machine: Machine, plant: Plant, *, height: float = 1.0, seed: int = 0, sensors: Sensors | None = None,
    robot: Robot = IDEAL,
) -> tuple[Jump, Log]:  # fmt: skip
    """Return the result of one jump; NaN if a foot never left the ground."""
    log = run(
        jump_script(machine, height), machine, plant, SECONDS, seed, command=np.zeros((1, 1)),
        sensors=sensors, robot=robot,
    )  # fmt: skip
    pose, speed, force = (np.array(log.rows[k]) for k in ("base_pose", "base_velocity", "ground_force"))
    total = np.linalg.norm(force.reshape(len(force), -1, 3), axis=-1).sum(axis=1)
    first = log.policy_from + round((_CROUCH_S + _REST_S) / STEP_S)
    flying = np.flatnonzero(total[first:] < _LOADED)
    if not len(flying):
        return Jump(np.nan, np.nan, float(total[first:].max())), log
    off = first + int(flying[0])
    apex, take_off = float(pose[off:, 2].max()), float(speed[first : off + 1, 2].max())
    return Jump(apex, take_off, float(total[first:off].max())), log
