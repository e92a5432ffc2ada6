"""The world in which a walking policy was trained, as a model for comparison with its recordings."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workbench.core import Controller
from workbench.models import Actuators, Ground, Model, model_text

from .machine import LEGS, STEP_S, Machine


def model_files(machine: Machine, folder: Path) -> dict[Path, str]:
    """Return the texts of a model (TOML) and its MJCF, by file in `folder`; empty if drives have joints of
    their own.

    Args:
        machine: of kind ``quadruped``; a leg's recordings are held against the leg's own model.
        folder: where they will lie.
    """
    if not machine.floating or len(machine.rotors.places):
        return {}
    tree, file = folder / "robot.xml", folder / "robot.toml"
    n = machine.size
    model = Model(
        name="robot",
        serial=tree.resolve(),
        axes=machine.joints,
        joints=machine.joints,
        transmission=np.array(machine.transmission),
        # rotors and damping are in the MJCF already, on joints and tendons
        actuators=Actuators(
            (0.0,) * n, (0.0,) * n, tuple(map(float, machine.torque_limit)), machine.delay_steps * STEP_S
        ),
        controller=Controller(
            "pd", "joint", kp=tuple(map(float, machine.kp)), kd=tuple(map(float, machine.kd)), period_s=STEP_S
        ),
        ground=Ground(tuple(f"{leg}_sphere" for leg in LEGS), surface="ground"),
    )
    return {tree: machine.xml, file: model_text(model, file)}
