"""The loop between a policy and the drives: PD in joint coordinates, mapped to the drives, one step late."""

from __future__ import annotations

from .situation import Array, Constants


def drive_torque(c: Constants, target: Array, position: Array, velocity: Array) -> Array:
    """Return the torque command of the loop to the drives (W, n) [N m], clipped as the drives clip it.

        tau_s = Kp (target - q_s) - Kd q_s',   tau_p = J^-T tau_s      (paper, Eq. 4)

    Args:
        c: the machine's constants.
        target, position, velocity: of the serial joints (W, n) [rad, rad/s].
    """
    wanted = c.kp * (target - position) - c.kd * velocity
    asked = wanted @ c.to_drives if c.map is None else c.map.drive_torque(position, wanted, c.xp)
    return c.xp.maximum(c.xp.minimum(asked, c.torque_limit), -c.torque_limit)


def action_target(c: Constants, action: Array, scale: float) -> Array:
    """Return the joint angles of an action (W, n) [rad]: the posture plus `scale` times the action."""
    return c.posture + scale * action
