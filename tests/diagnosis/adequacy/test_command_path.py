"""What is certain of a drive's command path, whatever the machine behind it does."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import AXES, FAST, SLOW, bench_arm, logged
from tests.diagnosis.rig import asked
from workbench.core import EffectKey, Recording
from workbench.diagnosis.adequacy.command_path import certain_on_path
from workbench.diagnosis.moves.joint_solution import solve_jointly
from workbench.diagnosis.problem import Problem
from workbench.effects import load_model

LIFT = AXES.index("lift")
Drive = Callable[[np.ndarray], np.ndarray]


def hum(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """What no effect explains: a torque that hangs on the position of another axis."""
    return np.array([0.0, 3.0 * np.sin(4.0 * position[0]), 0.0])


def problem(folder: Path, drive: Drive) -> Problem:
    """Of an arm with something unknown, whose lift drive makes something else of its command."""
    machine = bench_arm(folder, "machine")
    logs = [logged(machine, t, seconds=4.0, seed=k, resisting=hum) for k, t in enumerate((SLOW, FAST))]
    return asked(load_model(bench_arm(folder)), [_driven(log, drive) for log in logs])


def _driven(log: Recording, drive: Drive) -> Recording:
    noise = log.signals["torque_measured"] - log.signals["torque_command"]
    given = log.signals["torque_command"].copy()
    given[:, LIFT] = drive(given[:, LIFT])
    return log.with_signals(torque_measured=given + noise)


def lagging(command: np.ndarray, time_constant: float = 0.006, step: float = 0.002) -> np.ndarray:
    """A current that had settled before the log begins, at each row just after its command."""
    out, now = np.empty_like(command), command[0]
    for k, wanted in enumerate(command):
        out[k] = now
        now = wanted + (now - wanted) * np.exp(-step / time_constant)
    return out


def rate_limited(command: np.ndarray, most: float = 0.3) -> np.ndarray:
    """A torque that changes by no more than this per row."""
    out = command.copy()
    for k in range(1, len(out)):
        out[k] = out[k - 1] + np.clip(command[k] - out[k - 1], -most, most)
    return out


def found(asked_of: Problem) -> dict[str, dict[str, tuple[float, float]]]:
    assert asked_of.inverse_dynamics is not None
    certain = certain_on_path(asked_of.inverse_dynamics[2].linearisation)
    return {str(a.key): {n: (e.value, e.std) for n, e in a.parameters.items()} for a in certain}


def test_a_lag_has_its_name_and_size_beside_an_unknown_torque(tmp_path: Path) -> None:
    asked_of = problem(tmp_path, lagging)
    ((name, values),) = found(asked_of).items()
    value, std = values["time_constant"]
    assert name == "current_loop_lag@lift"
    assert value == pytest.approx(0.006, abs=3.0 * std) and std < 1e-4


def test_a_ceiling_is_no_falling_line(tmp_path: Path) -> None:
    ((name, values),) = found(problem(tmp_path, lambda u: np.clip(u, -6.0, 6.0))).items()
    assert name == "torque_saturation@lift"
    assert values["limit"][0] == pytest.approx(6.0, rel=2e-3)


@pytest.mark.parametrize("drive", [rate_limited, lambda u: u, lambda u: np.roll(lagging(u), 4)])
def test_nothing_is_certain_that_does_not_explain_all(tmp_path: Path, drive: Drive) -> None:
    assert found(problem(tmp_path, drive)) == {}


def test_held_out_recordings_say_nothing(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path, "machine")
    logs = [logged(machine, t, seconds=4.0, seed=k, resisting=hum) for k, t in enumerate((SLOW, FAST))]
    fitted, held_out = _driven(logs[1], lagging), _driven(logs[0], rate_limited)
    assert set(found(asked(load_model(bench_arm(tmp_path)), [fitted], [held_out]))) == {
        "current_loop_lag@lift"
    }


def test_a_line_that_falls_with_the_speed_is_left_to_the_loop(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path, "machine")
    log = logged(machine, FAST, seconds=4.0, resisting=hum)
    speed = log.velocity[:, LIFT]

    def falling(command: np.ndarray) -> np.ndarray:
        low, high = -12.0 * np.minimum(1.0 + speed / 4.0, 1.0), 12.0 * np.minimum(1.0 - speed / 4.0, 1.0)
        return np.clip(command, low, high)

    assert found(asked(load_model(bench_arm(tmp_path)), [_driven(log, falling)])) == {}


def test_a_delay_is_left_to_the_loop(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path, "machine")
    logs = [logged(machine, t, seconds=4.0, seed=k, late=2) for k, t in enumerate((SLOW, FAST))]
    assert found(asked(load_model(bench_arm(tmp_path)), logs)) == {}


def test_it_is_named_if_it_helps_in_the_loop(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path, "machine")
    lag = {"lag": 0.006, "resisting": hum}
    logs = [logged(machine, t, seconds=4.0, seed=k, **lag) for k, t in enumerate((SLOW, FAST))]
    node = solve_jointly(asked(load_model(bench_arm(tmp_path)), logs))
    assert node is not None and EffectKey("current_loop_lag", "lift") in node.adequacy
    # the same log of a machine that does not lag is a log with a fault
    assert solve_jointly(problem(tmp_path, lagging)) is None
