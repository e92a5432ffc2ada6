"""The moving picture of the live workbench."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import Recording
from workbench.models import load_tree, read_model
from workbench.s3n import drive_map
from workbench.ui.motion import moving_picture


def test_links_follow_drives_whose_transmission_changes() -> None:
    model = read_model("ankle")
    own, count = drive_map(model), 100
    assert own is not None and model.closed_chain is not None
    low, high = np.transpose(model.closed_chain.limits)
    joints = low + np.linspace(0.1, 0.9, count)[:, None] * (high - low)
    time = np.arange(count) * 0.01
    drives = {"position": own.drives(joints)}
    told = Recording("moved", model.axes, "actuator", time, drives, units=("rad", "rad"))
    columns = moving_picture(model, told, {})
    m = load_tree(model.serial).compile()
    data = mujoco.MjData(m)
    tip = int(columns["scene"][1])
    feet = np.stack([columns[f"measured_{tip}_{c}"] for c in (3, 4, 5)], axis=1)
    rows = np.searchsorted(time, columns["t"] - 1e-9)
    ends = []
    for q, foot in zip(joints[rows], feet, strict=True):
        data.qpos[[m.joint(name).qposadr[0] for name in model.joints]] = q
        mujoco.mj_kinematics(m, data)
        ends.append(data.xmat[-1].reshape(3, 3).T @ (foot - data.xpos[-1]))
    # fixed in the last link, as long as its joints are where the drives have them
    assert np.ptp(ends, axis=0).max() < 1e-4
