"""A robot as moving lines: joints that a posture's transmission moves, and only what belongs to its shape."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.simulation.scene import scene_of

_TREE = """<mujoco><worldbody><site name="far" pos="0 0 3"/>
<body name="link"><joint name="pin" axis="0 1 0"/><inertial pos="0 0 -0.1" mass="1" diaginertia="1 1 1"/>
<site name="toe" pos="0 0 -0.5"/><site name="hook" pos="0.4 0 0"/></body></worldbody>
<tendon><spatial><site site="far"/><site site="hook"/></spatial></tendon></mujoco>"""


def test_places_that_a_tendon_passes_are_not_drawn() -> None:
    m = mujoco.MjModel.from_xml_string(_TREE)
    scene = scene_of(m, np.array([0.0, 0.1]), np.zeros((2, 1)))
    assert scene.ends.shape[1] == 1
    np.testing.assert_allclose(scene.ends[0, 0], [[0, 0, 0], [0, 0, -0.5]], atol=1e-12)
