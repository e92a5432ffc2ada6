"""MuJoCo times none of its steps, unless somebody has set a clock."""

from __future__ import annotations

import mujoco

from workbench.models.engine import stop_clock

_HINGE = """<mujoco><worldbody><body><joint name="a"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>"""


def timed() -> float:
    """Seconds that MuJoCo says a hundred steps took, by the clock it has."""
    model = mujoco.MjModel.from_xml_string(_HINGE)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=100)
    assert data.time > 0.0 and data.timer[mujoco.mjtTimer.mjTIMER_STEP].number == 100
    return data.timer[mujoco.mjtTimer.mjTIMER_STEP].duration


def test_steps_are_not_timed() -> None:
    assert timed() == 0.0


def test_somebody_s_clock_stays() -> None:
    ticks = iter(range(10**9))
    mujoco.set_mjcb_time(lambda: float(next(ticks)))
    try:
        stop_clock()
        assert timed() > 0.0
    finally:
        mujoco.set_mjcb_time(None)
        assert timed() > 0.0  # MuJoCo's module has set its own again
        stop_clock()
    assert timed() == 0.0
