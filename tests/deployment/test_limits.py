"""What a configuration's limits become."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.can.make import LIMITS, RANGES, config, motor
from workbench.deployment import limits_of


def test_limits_are_those_of_the_configuration(tmp_path: Path) -> None:
    small = {**LIMITS, "position": [-0.5, 1.5], "velocity": 9.0, "torque": 2.0, "torque_rate": 70.0,
             "temperature": 55.0}  # fmt: skip
    weak = {**RANGES, "kp": 100.0, "kd": 2.0}
    motors = [
        motor("hip", 1, watchdog_s=0.02),
        motor("knee", 2, limits=small, ranges=weak, watchdog_s=0.012),
        motor("toe", 3, ranges={"kp": 300.0, "source": "drive"}),
    ]
    loop = {"period_s": 0.004, "policy_every": 3, "soft_start_s": 0.7, "damping": 0.8, "kp": 50.0}
    limits = limits_of(config(tmp_path, motors, loop=loop))
    for name, values in {
        "low": [-3.0, -0.5, -3.0], "high": [3.0, 1.5, 3.0], "velocity": [25.0, 9.0, 25.0],
        "torque": [20.0, 2.0, 20.0], "torque_rate": [5000.0, 70.0, 5000.0], "temperature": [80.0, 55.0, 80.0],
        "kp": [500.0, 100.0, 300.0], "kd": [5.0, 2.0, 5.0], "damping": [0.8] * 3,
        # a twentieth of the limit, or four steps of a frame where that is more; unknown until it is read
        "notice": [1.0, max(0.1, 4 * 50.0 / 4095), 1.0],
    }.items():  # fmt: skip
        assert getattr(limits, name) == pytest.approx(values), name
    # three periods, looked at by then: not a moment later
    assert limits.stale_s == pytest.approx(0.012, abs=2e-6) and limits.stale_s < 0.012
    assert limits.frozen_s == pytest.approx(0.024, abs=2e-6) and limits.frozen_s < 0.024
    assert limits.late_s == pytest.approx(2 * 3 * 0.004) and limits.soft_start_s == 0.7
    assert limits.watchdog_s == 0.012, "of the least patient drive"
    assert limits.overrun == pytest.approx(np.radians(3.0), rel=0.06) and limits.tilt == np.inf


def test_four_steps_of_a_coarse_frame_are_more_than_a_twentieth(tmp_path: Path) -> None:
    coarse = {**RANGES, "torque": 250.0}
    weak = {**LIMITS, "torque": 2.0}
    limits = limits_of(config(tmp_path, [motor("hip", 1, ranges=coarse, limits=weak)]))
    assert limits.notice == pytest.approx([4 * 500.0 / 4095])


@pytest.mark.parametrize(("stated", "tilt"), [({}, np.inf), ({"tilt": 0.6}, 0.6)])
def test_a_tilt_is_limited_where_it_is_stated(tmp_path: Path, stated: dict, tilt: float) -> None:
    imu = {"bus": "can0", "id": 0x60, **stated}
    assert limits_of(config(tmp_path, [motor("hip", 1)], imu=imu)).tilt == tilt
