"""The loop between a policy and the drives: PD in joint coordinates, mapped to the drives, one step late."""

from __future__ import annotations

from .situation import Array, Constants


def drive_torque(c: Constants, target: Array, position: Array, velocity: Array) -> Array:
    """Torque that the loop asks of the drives (W, n) [N m], clipped as they clip it.

        tau_s = Kp (target - q_s) - Kd q_s',   tau_p = J^-T tau_s      (paper, Eq. 4)

    Args:
        c: the machine's constants.
        target, position, velocity: of the serial joints (W, n) [rad, rad/s].
    """
    wanted = c.kp * (target - position) - c.kd * velocity
    asked = wanted @ c.to_drives if c.map is None else c.map.drive_torque(position, wanted, c.xp)
    return c.xp.maximum(c.xp.minimum(asked, c.torque_limit), -c.torque_limit)


def action_target(c: Constants, action: Array, scale: float) -> Array:
    """Joint angles that an action asks for (W, n) [rad]: the posture, plus `scale` an action unit."""
    return c.posture + scale * action
