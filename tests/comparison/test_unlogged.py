"""What a log of positions alone leaves open of its loop is read off it, whatever is wrong with the model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, KD, KP, SLOW, bench_arm, logged
from workbench.comparison import compare, matched, matched_ways, with_torque_by_law
from workbench.core import Recording
from workbench.effects import load_model

WRONG = {
    "nothing": {},
    "a rotor": {"lift_armature": 0.15},
    "all damping": {"yaw_damping": 1.2, "lift_damping": 0.2, "bend_damping": 1.1},
    "a centre of mass": {"fore_centre": 0.09},
}


def logs(machine: Path, *, held: bool) -> list[Recording]:
    each = (SLOW, FAST)
    return [
        logged(machine, tones, log_s=0.01, loop_s=0.001, held=held, positions_alone=True) for tones in each
    ]


@pytest.mark.parametrize("held", [True, False], ids=["held", "smooth"])
@pytest.mark.parametrize("wrong", WRONG)
def test_the_reference_between_rows_is_told_all_the_same(tmp_path: Path, wrong: str, held: bool) -> None:
    machine, model = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", **WRONG[wrong]))
    likeliest, *others = matched_ways(model, logs(machine, held=held))
    for told in likeliest:
        assert told.timing.reference_held is held
        assert any("reference_held" in note for note in told.notes)
    # inertia of all axes that is wrong hides half a tick: then both ways to the speed are left to be tried
    open_to = {
        way[0].controller.velocity for way in (likeliest, *others) if way[0].timing.reference_held is held
    }
    assert open_to == ({"sensor"} if wrong != "a centre of mass" else {"sensor", "difference"})


@pytest.mark.parametrize("held", [True, False], ids=["held", "smooth"])
@pytest.mark.parametrize("log_s", [0.004, 0.01])
def test_a_right_model_explains_torques_of_a_slower_log(tmp_path: Path, log_s: float, held: bool) -> None:
    """At its rows the torque is the same whatever the reference does between them; the motion is not."""
    machine = bench_arm(tmp_path)
    found = compare(load_model(machine), [logged(machine, log_s=log_s, loop_s=0.002, held=held)])
    assert found.consistent and found.error < 1.2 * found.noise_error
    assert any(f"reference_held = {str(held).lower()}" in note for note in found.notes)


def test_the_torque_until_the_next_row_follows_from_the_law(tmp_path: Path) -> None:
    """A reference that waits for the next row while the arm moves on: damping of kp times half the wait."""
    machine, rows = bench_arm(tmp_path), np.arange(20, 1000)  # away from the start
    log = logged(machine, log_s=0.004, loop_s=0.002)
    (made,) = with_torque_by_law(load_model(machine), matched(load_model(machine), [log])) or ()
    change = (made.signals["torque_measured"] - log.signals["torque_measured"])[rows]
    w, a = log.signals["velocity"][rows], np.gradient(log.signals["velocity"], 0.004, axis=0)[rows]
    wait = 0.5 * 0.002
    np.testing.assert_allclose(change, -wait * (KP * w + KD * a), atol=0.03 * np.abs(change).max())


def test_a_right_model_explains_positions_alone(tmp_path: Path) -> None:
    """Half a row of delay would be many times the noise."""
    machine = bench_arm(tmp_path)
    found = compare(load_model(machine), logs(machine, held=True))
    assert found.consistent and found.error < 1.2 * found.noise_error


@pytest.mark.parametrize("numbers", [{}, {"lift_damping": 1.6}], ids=["alone", "beside damping"])
def test_drives_half_a_row_late_leave_the_reference_open(tmp_path: Path, numbers: dict[str, float]) -> None:
    """They move the reference as a constant one does, and look like wrong numbers then."""
    machine, model = bench_arm(tmp_path, "machine", **numbers), load_model(bench_arm(tmp_path))
    made = [
        logged(machine, tones, log_s=0.01, loop_s=0.001, held=False, late=5, positions_alone=True)
        for tones in (SLOW, FAST)
    ]
    ways = matched_ways(model, made)
    assert {way[0].timing.reference_held for way in ways} == {True, False}


def test_what_is_stated_is_not_asked(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path)
    log = logs(machine, held=True)[1]
    controller = replace(log.controller, velocity="difference")
    stated = replace(log, timing=replace(log.timing, reference_held=False), controller=controller)
    (told,) = matched(load_model(machine), [stated])
    assert told.timing == stated.timing and told.controller == controller and told.notes == stated.notes


def test_logged_torque_leaves_nothing_open(tmp_path: Path) -> None:
    machine = bench_arm(tmp_path)
    log = logged(machine, seconds=2.0)
    (told,) = matched(load_model(machine), [log])
    assert told.notes == log.notes and np.array_equal(told.position, log.position)


@pytest.mark.parametrize("differences", [True, False], ids=["difference", "sensor"])
@pytest.mark.parametrize("log_s", [0.002, 0.004])
def test_a_measured_torque_tells_how_the_loop_got_its_speed(
    tmp_path: Path, log_s: float, differences: bool
) -> None:
    """Taken wrongly it would be a rotor of half of kd times the period, on every axis."""
    machine, model = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model", **WRONG["a rotor"]))
    log = logged(machine, log_s=log_s, differences=differences)
    signals = {name: values for name, values in log.signals.items() if name != "torque_command"}
    signals["velocity"] = np.gradient(log.position, log_s, axis=0)
    (told,) = matched(model, [replace(log, signals=signals, derived=("velocity",))])
    assert told.controller.velocity == ("difference" if differences else "sensor")
    assert any("no speed was logged" in note for note in told.notes)
    assert told.timing.reference_held is (True if log_s > 0.002 else None)


def test_an_arm_that_rests_tells_how_its_loop_works(tmp_path: Path) -> None:
    """Dry friction at rest takes any torque, also one that the model lacks: it says nothing of the loop."""
    machine = bench_arm(tmp_path, yaw_friction=2.0, lift_friction=4.0)
    log = logged(machine, log_s=0.01, loop_s=0.001, held=False, positions_alone=True, pauses=True)
    for model in (machine, bench_arm(tmp_path, "model")):
        ((told,),) = matched_ways(load_model(model), [log])
        assert told.timing.reference_held is False and told.controller.velocity == "sensor"
