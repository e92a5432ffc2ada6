"""The virtual hardware of the transfer study: the reference leg, clean or hiding effects, and other legs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from transfer_robot import Robot

from workbench.rigs import HiddenEffect
from workbench.training.machine import STEP_S

#: Hidden in the second set, beside what the linkage itself has over a serial tree: its weight, its velocity
#: terms. Flanks of the gap are as soft as the rig's sampled loop stays stable with.
EFFECTS = (
    HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.12}),
    HiddenEffect("backlash", "knee", parameters={"gap": 0.002, "stiffness": 400.0}),
    HiddenEffect("torque_constant_error", "hip", parameters={"gain": 0.94}),
)
SETS = {
    "clean": (),
    "hidden effects": EFFECTS,
    "no play": tuple(e for e in EFFECTS if e.effect != "backlash"),
}
#: What a robot has beyond its drawing, part by part; sizes of a robot of this size.
PARTS: dict[str, Robot] = {
    "friction of 0.3 N m in all drives": Robot(drive_friction=0.3),
    "actions 6 ms late": Robot(latency_steps=round(0.006 / STEP_S)),
    "1 kg on the trunk, 5 cm off its centre": Robot(trunk_mass=1.0, trunk_at=(0.05, 0.0, 0.0)),
    "gyro bias 0.05 rad/s, tilt 0.02 rad, 6 ms late": Robot(
        gyro_bias=(0.05, 0.05, 0.05), tilt_bias=(0.02, 0.02), imu_steps=round(0.006 / STEP_S)
    ),
    "drives to 25 rad/s, battery that sags": Robot(no_load_speed=25.0, sag=0.2),
    "soft ground, 20 kN/m": Robot(ground_stiffness=2e4),
    "rough ground, 10 mm": Robot(roughness=0.01),
}


@dataclass(frozen=True)
class Plant:
    """One leg that is measured.

    Attributes:
        name: in tables.
        hidden: all that it has beyond the reference leg.
        seed: of every sensor's noise.
    """

    name: str
    hidden: tuple[HiddenEffect, ...]
    seed: int


def reference_leg(which: str, seed: int) -> Plant:
    """The reference leg with one of the `SETS` of effects hidden in it."""
    return Plant("reference leg", SETS[which], seed)


def other_leg(which: str, seed: int) -> Plant:
    """A leg that was never nominal: its drives differ from each other, links are longer and heavier.

    Drives +-25 % (each its own), thigh +-30 mm, linkage -20 to +60 % of the reference's inertia and weight.
    """
    generator = np.random.default_rng([seed, 8])
    more = generator.uniform(-0.25, 0.25, 2) * 0.0162
    m11, m12, m22, g1, g2 = generator.uniform(-0.2, 0.6, 5)
    own = (
        HiddenEffect("reflected_inertia", "hip", parameters={"inertia": float(more[0])}),
        HiddenEffect("reflected_inertia", "knee", parameters={"inertia": float(more[1])}),
        HiddenEffect(
            "link_length_error", "hip", parameters={"length": float(generator.uniform(-0.03, 0.03))}
        ),
        HiddenEffect(
            "linkage_inertia",
            None,
            parameters={"M11": m11 * 0.00967, "M12": m12 * 0.002893, "M22": m22 * 0.00516},
        ),
        HiddenEffect("linkage_gravity", None, parameters={"g1": g1 * 0.163091, "g2": g2 * 0.132743}),
    )
    return Plant(f"other leg {seed}", (*own, *SETS[which]), seed)
