"""A joint without a drive has an equation too: a sign that spoils it is not what is wrong with a log."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from workbench.comparison import torque_left, turned_axes
from workbench.core import Recording
from workbench.effects import load_model
from workbench.models import Model

CART = """<mujoco model="cart"><compiler angle="radian"/>
<option timestep="0.001" integrator="implicitfast"/><worldbody>
<body name="cart"><joint name="cart" type="slide" axis="1 0 0" armature="0.4" damping="1.5"/>
<inertial pos="0 0 0" mass="1.2" diaginertia="0.01 0.01 0.01"/>
<body name="rod"><joint name="rod" axis="0 1 0" damping="0.004"/>
<inertial pos="0 0 -0.3" mass="0.5" diaginertia="0.01 0.01 0.001"/></body></body></worldbody>
<actuator><motor name="cart" joint="cart"/></actuator></mujoco>"""
PERIOD, SECONDS = 0.002, 8.0


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    file = tmp_path_factory.mktemp("cart") / "cart.xml"
    file.write_text(CART)
    return load_model(str(file))


def run(reversed_pull: bool = False) -> Recording:
    """A log of the cart in a loop; its force may hold what turns the rod's pull on it round."""
    m = mujoco.MjModel.from_xml_string(CART)
    data, rows = mujoco.MjData(m), []
    time = np.arange(0.0, SECONDS, PERIOD)
    for t in time:
        wanted = 0.12 * np.sin(4.2 * t) + 0.08 * np.sin(7.9 * t)
        force = 60.0 * (wanted - data.qpos[0]) - 9.0 * data.qvel[0]
        rows.append((data.qpos.copy(), data.qvel.copy(), np.array([force, 0.0])))
        for _ in range(round(PERIOD / m.opt.timestep)):
            data.ctrl[0] = force
            mujoco.mj_step(m, data)
    names = "position", "velocity", "torque_measured"
    signals = {name: np.stack([row[k] for row in rows]) for k, name in enumerate(names)}
    if reversed_pull:
        carried = -0.3 * 0.5 * np.cos(signals["position"][:, 1]) * signals["velocity"][:, 1]
        signals["torque_measured"][:, 0] -= 2.0 * np.gradient(carried, PERIOD)
    return Recording("cart", ("cart", "rod"), "joint", time, signals, ("m", "rad"))


def turned(recording: Recording, axis: int, *names: str) -> Recording:
    side = np.where(np.arange(2) == axis, -1.0, 1.0)
    return recording.with_signals(**{name: recording.signals[name] * side for name in names})


def test_a_force_that_goes_with_the_rod_is_no_wrong_sign(model: Model) -> None:
    """With the rod negated the cart's force would be explained, and the rod's own motion would not be."""
    log = run(reversed_pull=True)
    before, after = torque_left(model, [log]), torque_left(model, [turned(log, 1, "position", "velocity")])
    assert after[0] < 0.2 * before[0]
    assert after[1] > 0.5 > 0.01 > before[1]
    assert turned_axes(model, [log]) is None


def test_a_rod_that_was_logged_the_other_way_is_found(model: Model) -> None:
    found = turned_axes(model, [turned(run(), 1, "position", "velocity")])
    assert found is not None and "rod" in {turn.axis for turn in found.turns}
