"""Which budget of time a loop lacks is said before it starts."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest

from tests.deployment.robot import TICK, Robot
from workbench.deployment import Punctuality
from workbench.deployment.budget import REHEARSAL_S, budget, lacking, takes
from workbench.deployment.deploy import run_host
from workbench.deployment.processors import Crowd


def punctual(**more: object) -> Punctuality:
    return Punctuality(**{"round_trips": [0.8e-3] * 200, "late": [5e-5] * 200, **more})


def test_a_loop_that_keeps_its_times_lacks_nothing() -> None:
    assert lacking(punctual(), TICK, 3 * TICK, 0.4e-3) == []


@pytest.mark.parametrize(
    ("seen", "policy", "said"),
    [
        (punctual(round_trips=[2.6e-3] * 200), 0.0, "an exchange takes 2.6 ms (99 %), of the 2.55 ms"),
        (punctual(), 2e-3, "takes 0.8 ms and the policy 2 ms"),
        (punctual(round_trips=[]), 0.0, "an exchange takes nan ms"),
        (punctual(late=[5e-5] * 199 + [0.0035]), 0.0, "late by 3.5 ms, and 3 ms remain"),
        (punctual(skipped=5), 0.0, "2.4 % of the ticks"),
        (punctual(incomplete=10), 0.0, "10 of 200 exchanges had no answer"),
    ],
)
def test_what_is_lacking_is_named(seen: Punctuality, policy: float, said: str) -> None:
    [line] = lacking(seen, TICK, 3 * TICK, policy)
    assert said in line


def test_a_rehearsal_moves_nothing_and_does_not_count(tmp_path: Path) -> None:
    robot, said = Robot(tmp_path), []

    def before(host) -> None:
        begin = robot.network.now()
        assert budget(host, robot.config, robot.controller, said.append) == [] == said
        assert robot.network.now() - begin == pytest.approx(REHEARSAL_S, abs=6 * TICK)
        assert not any(motor.longest for motor in robot.motors), "no drive was on"
        assert host.punctuality.ticks == 0 and not host.punctuality.counts

    result = run_host(robot.host, robot.network, 0.3, before=before)
    assert result["fault"] is None and result["ticks"] < 300


def test_drives_that_answer_late_are_told_of(tmp_path: Path) -> None:
    robot, said = Robot(tmp_path), []
    robot.host.verify()
    robot.network.tamper = lambda a: [(a.stamp + 0.0028, a)]
    lacks = budget(robot.host, robot.config, robot.controller, said.append)
    assert len(lacks) == 2 and said[0].startswith("not enough time: an exchange takes")
    robot.network.tamper = None
    assert budget(robot.host, robot.config, robot.controller, said.append, ["realtime"])[0].endswith(
        "realtime"
    )


class Full(Crowd):
    def lacking(self) -> list[str]:
        return ["full"]


def test_processors_that_others_want_are_lacking(tmp_path: Path) -> None:
    file = tmp_path / "cpu"

    def counted(seconds: float) -> None:
        file.write_text(f"some avg10=1.00 avg60=1.00 avg300=1.00 total={1e6 * seconds:.0f}\nfull total=9\n")

    counted(100.0)
    times = iter((50.0, 52.0, 54.0))
    crowd = Crowd(file, lambda: next(times))
    counted(100.4)
    assert crowd.lacking() == [], "our own processes wait for each other"
    counted(103.2)
    [line] = crowd.lacking()
    assert "80 % of the time" in line
    robot = Robot(tmp_path)
    robot.host.verify()
    said = budget(robot.host, robot.config, robot.controller, lambda line: None, (), Full(file))
    assert said == ["full"]


@pytest.mark.parametrize(("load", "lacks"), [(0.0, 0), (1e3, 1)])
def test_where_the_kernel_counts_no_waiting_its_load_is_taken(
    tmp_path: Path, monkeypatch, load, lacks
) -> None:
    monkeypatch.setattr(os, "getloadavg", lambda: (load, 0.0, 0.0))
    assert len(Crowd(tmp_path / "none").lacking()) == lacks
    (tmp_path / "odd").write_text("nothing of the kind\n")
    assert len(Crowd(tmp_path / "odd").lacking()) == lacks


def test_a_policy_is_timed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert takes(lambda: time.sleep(2e-3)) > 2e-3
    counted = iter(np.repeat(np.arange(50.0), 2) + np.tile([0.0, 0.02], 50))  # s, as if each call took 20 ms
    with monkeypatch.context() as patched:
        patched.setattr("time.perf_counter", lambda: next(counted))
        spent = takes(lambda: None, lambda seconds: 10.0 * seconds)
    assert spent == pytest.approx(2e-3)
