"""How long drives get to say that they are enabled: by time, for some tell their state only now and then."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.can.make import config, motor
from tests.deployment.robot import LIMITS, RANGES, Swing
from workbench.deployment import Host, SimulatedNetwork, joints_of


def leg(folder: Path, period: float) -> Host:
    """A leg with one ODrive on each bus: each tells its state every 10 ms."""
    ends = {"protocol": "odrive", "endpoints": {"watchdog_timeout": 481, "enable_watchdog": 482}}
    motors = [
        motor(axis, 1, bus=f"can{k}", limits=LIMITS, ranges=RANGES, **ends)
        for k, axis in enumerate(("hip", "knee"))
    ]
    known = config(folder, motors, ("can0", "can1"), mechanism=[{"model": "leg", "axes": ["hip", "knee"]}],
                   loop={"period_s": period, "soft_start_s": 0.1})  # fmt: skip
    host = Host(known, SimulatedNetwork(known), Swing(2), joints_of(known))
    host.verify()
    host.operator.arm = True
    return host


@pytest.mark.parametrize("period", [0.001, 0.003, 0.006])
def test_a_loop_faster_than_a_drive_tells_its_state_is_armed(tmp_path: Path, period: float) -> None:
    host = leg(tmp_path, period)
    host.run(0.3)
    assert host.state.phase == "run", (host.state.fault, host.feedback.fault)


def test_a_drive_that_stays_off_is_waited_for(tmp_path: Path) -> None:
    host = leg(tmp_path, 0.003)
    send = host._network.send
    on = {frame.data for drive in host.feedback.drives[:1] for frame in drive.act("enable")[1:]}
    host._network.send = lambda bus, f: (bus == "can0" and f.data in on) or send(bus, f)  # type: ignore[method-assign]
    host.run(0.09)
    assert (host.state.phase, host.state.fault) == ("off", None)
    host.run(0.03)
    assert (host.state.phase, host.state.fault, host.state.axes) == ("off", "a drive reports a fault", (0,))
    assert host.feedback.fault[0] == "is off"
