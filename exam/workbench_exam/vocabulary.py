"""The effects that may be hidden and named, with their values and units; places are drives, or all of them.

Names and values are those of a plain catalogue of robot effects; an increment is added to what the model's
file has and may be negative. An effect of all drives has no place (`None`).
"""

from __future__ import annotations

from collections.abc import Mapping

INCREMENTS: Mapping[str, Mapping[str, str]] = {
    "viscous_damping": {"damping": "N m s/rad"},
    "coulomb_friction": {"torque": "N m"},
    "reflected_inertia": {"inertia": "kg m^2"},
    "first_moment_error": {"along": "kg m"},
    "link_inertia_error": {"inertia": "kg m^2"},
}
EFFECTS: Mapping[str, Mapping[str, str]] = {
    **INCREMENTS,
    "payload_mass": {"mass": "kg"},
    "torque_constant_error": {"gain": "1"},
    "torque_bias": {"torque": "N m"},
    "torque_saturation": {"limit": "N m"},
    "parallel_spring": {"stiffness": "N m/rad", "rest": "rad"},
    "quadratic_drag": {"drag": "N m s^2/rad^2"},
    "stribeck_friction": {"coulomb": "N m", "static": "N m", "speed": "rad/s"},
    "cogging": {"torque": "N m", "order": "1/rev", "phase": "rad"},
    "joint_compliance": {"stiffness": "N m/rad", "damping": "N m s/rad"},
    "backlash": {"gap": "rad", "stiffness": "N m/rad"},
    "encoder_offset": {"angle": "rad"},
    "current_loop_lag": {"time_constant": "s"},
    "command_delay": {"time": "s"},
}
#: Effects of the whole machine.
WHOLE = ("payload_mass", "command_delay")
MEANING: Mapping[str, str] = {
    "viscous_damping": "torque -damping * speed of the drive, added to the file's",
    "coulomb_friction": "dry friction of that torque, added to the file's",
    "reflected_inertia": "inertia of the rotor at the output, added to the file's armature",
    "first_moment_error": "mass times lever of that drive's link towards the next joint, added to the file's",
    "link_inertia_error": "inertia of that drive's link about its own centre, added to the file's",
    "payload_mass": "a point mass at the tip",
    "torque_constant_error": "true torque = gain * measured torque",
    "torque_bias": "a constant torque on the drive that is not measured",
    "torque_saturation": "the torque is clipped at +-limit before it is measured",
    "parallel_spring": "torque -stiffness * (angle - rest)",
    "quadratic_drag": "torque -drag * speed * |speed|",
    "stribeck_friction": "dry friction coulomb + (static - coulomb) exp(-(speed/v)^2), v the value `speed`",
    "cogging": "torque * sin(order * angle + phase)",
    "joint_compliance": "a spring and damper between the rotor, which the encoder sees, and the link",
    "backlash": "a gap of that whole width between rotor and link, with flanks of that stiffness",
    "encoder_offset": "measured angle = true angle + angle",
    "current_loop_lag": "the torque follows the command through a first-order lag, before it is measured",
    "command_delay": "the torque follows the command so much later on all drives, before it is measured",
}
VERDICTS: Mapping[str, str] = {
    "consistent": "nothing is missing",
    "missing_effect": "what is named explains the recordings",
    "partly_explained": "what is named is true, and something is left that no effect here explains",
    "unexplained": "something is missing, and no effect here explains it",
    "recordings_disagree": "no one model explains all recordings: a unit or the machine differs between them",
}
