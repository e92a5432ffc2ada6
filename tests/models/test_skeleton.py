from __future__ import annotations

import numpy as np
import pytest

from workbench import load_model
from workbench.core import Recording
from workbench.models.skeleton import Skeleton, facing


def moving(coordinates: str) -> Recording:
    time = np.linspace(0.0, 2.0, 401)
    thigh, shank = 0.5 * np.sin(time), 0.5 * np.sin(time) + 0.8 + 0.3 * np.cos(2 * time)
    second = shank if coordinates == "actuator" else shank - thigh
    position = np.stack([thigh, second], axis=1)
    return Recording("leg", ("hip", "knee"), coordinates, time, {"position": position}, ("rad", "rad"))  # type: ignore[arg-type]


@pytest.mark.parametrize("coordinates", ["actuator", "joint"])
def test_links_lie_where_the_angles_say(coordinates: str) -> None:
    model, recording = load_model("leg"), moving(coordinates)
    skeleton = Skeleton.of(model.serial)
    times, segments = skeleton.along(model, recording)
    drives = moving("actuator").position[np.searchsorted(recording.time, times - 1e-9)]

    def along(angle: np.ndarray) -> np.ndarray:
        return np.stack([np.sin(angle), np.zeros_like(angle), -np.cos(angle)], axis=1)

    knee = 0.175 * along(drives[:, 0])
    assert segments.shape == (len(times), 2, 2, 3) and skeleton.tip == 1
    assert np.abs(segments[:, 0, 1] - knee).max() < 1e-12
    assert np.abs(segments[:, 1, 1] - knee - 0.24 * along(drives[:, 1])).max() < 1e-12
    assert np.cos(facing(segments)) == pytest.approx(0.0, abs=1e-6), "seen across the plane that it moves in"


def test_links_without_a_shape_are_drawn_from_joint_to_joint(tmp_path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(
        """<mujoco><worldbody><body name="a"><joint name="a" axis="0 0 1"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="1 1 1"/><body name="b" pos="0.3 0 0">
<joint name="b" axis="0 0 1"/>
<inertial pos="0.1 0 0" mass="1" diaginertia="1 1 1"/></body></body></worldbody></mujoco>"""
    )
    skeleton = Skeleton.of(file)
    assert skeleton.ends[:, 1].tolist() == [[0.3, 0, 0], [0.2, 0, 0]]
