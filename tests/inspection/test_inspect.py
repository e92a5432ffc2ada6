"""Each mistake made on purpose is found and named; data without a mistake raise no alarm."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.data_helpers import emps_toml, leg_examples
from tests.inspection.belt import BELT, STEP, alarms, remarks, swapped, times
from workbench.core import Controller, Recording
from workbench.inspection import inspect, inspection_dict
from workbench.recordings import load_recording


def test_nothing_is_wrong_with_sound_data(sound: Recording) -> None:
    assert alarms(sound) == []
    assert inspect([sound]).sound
    law = next(r for r in remarks(sound) if r.topic == "gains")
    assert law.severity == "ok" and law.value["unexplained"] < 1e-6
    for factor in law.value["factors"].values():
        assert factor["value"] == pytest.approx(1, abs=1e-6) and factor["std"] < 1e-6


def test_no_alarm_on_the_reference_leg() -> None:
    found = inspect([load_recording(path) for path in leg_examples()])
    assert [r for one in found.recordings for r in one.remarks if r.severity in ("warning", "problem")] == []


def test_no_alarm_on_emps(tmp_path: Path) -> None:
    assert alarms(load_recording(emps_toml(tmp_path))) == []


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("signal", ["position", "velocity", "torque_command", "torque_measured"])
def test_wrong_sign(sound: Recording, signal: str, axis: int) -> None:
    found = [r for r in alarms(times(sound, signal, axis, -1.0)) if r.topic == "sign"]
    assert {r.axis for r in found} == {sound.axes[axis]}


@pytest.mark.parametrize("signal", ["position_reference", "torque_feedforward"])
def test_wrong_sign_of_what_the_controller_reads(sound: Recording, signal: str) -> None:
    found = alarms(times(sound, signal, 1, -1.0))
    assert [(r.topic, r.axis) for r in found] == [("sign", "b")]


def test_wrong_sign_of_torque_shows_without_a_controller(sound: Recording) -> None:
    bare = {k: sound.signals[k] for k in ("position", "velocity", "torque_measured")}
    backward = times(replace(sound, signals=bare, controller=Controller()), "torque_measured", 0, -1.0)
    assert [(r.topic, r.axis) for r in alarms(backward)] == [("sign", "a")]


@pytest.mark.parametrize(
    "signals",
    [
        ("position",),
        ("velocity",),
        ("torque_command",),
        ("torque_measured",),
        ("position_reference",),
        ("torque_feedforward",),
        ("position", "velocity"),
    ],
)
def test_swapped_columns(sound: Recording, signals: tuple[str, ...]) -> None:
    found = [r for r in alarms(swapped(sound, *signals)) if r.topic == "swap"]
    assert found and all(sorted(r.value["axes"]) == ["a", "b"] for r in found)
    if signals not in (("torque_measured",),):
        assert any("the law holds" in r.text for r in found)


@pytest.mark.parametrize(
    ("signal", "factor", "meaning"),
    [
        ("position", 180 / np.pi, "degrees and radians"),
        ("velocity", 60 / (2 * np.pi), "rpm"),
        ("torque_measured", 1000.0, "milli"),
        ("torque_command", 1000.0, "milli"),
    ],
)
def test_wrong_unit_has_a_name(sound: Recording, signal: str, factor: float, meaning: str) -> None:
    wrong = times(times(sound, signal, 0, factor), signal, 1, factor)
    units = [r for r in alarms(wrong) if r.topic == "unit"]
    assert units and all(meaning in r.text for r in units)


def test_time_in_milliseconds(sound: Recording) -> None:
    units = [r for r in alarms(replace(sound, time=1e3 * sound.time)) if r.topic == "unit"]
    assert units and all("milli" in r.text for r in units)


def test_gear_ratio_on_one_axis(sound: Recording) -> None:
    found = [r for r in alarms(times(sound, "position", 1, 5.0)) if r.topic == "unit"]
    assert {r.axis for r in found} == {"b"}
    assert min(abs(r.value["factor"] - 0.2) for r in found) < 1e-3
    assert any(r.value["factor"] == pytest.approx(5.0, rel=1e-3) for r in found)


@pytest.mark.parametrize("factor", [1000.0, -1.0, 1.0])
def test_a_measured_torque_alone_is_held_against_the_law(sound: Recording, factor: float) -> None:
    command = sound.signals["torque_command"]
    signals = {name: values for name, values in sound.signals.items() if name != "torque_command"}
    noisy = command + np.random.default_rng(0).normal(0.0, 0.02, command.shape)
    alone = times(replace(sound, signals={**signals, "torque_measured": noisy}), "torque_measured", 1, factor)
    found = [r for r in alarms(alone) if "stated law" in r.text]
    topics = {1000.0: ["unit"], -1.0: ["sign"], 1.0: []}
    assert [r.topic for r in found] == topics[factor] and all(r.axis == "b" for r in found)
    assert all(r.value["factor"] == pytest.approx(factor, rel=0.05) for r in found)


def test_gains_are_not_as_stated(sound: Recording) -> None:
    law = replace(sound.controller, kp=(36.0, 20.0), kd=(0.9, 0.5))
    found = alarms(replace(sound, controller=law))
    assert [(r.topic, r.axis, r.value["gain"]) for r in found] == [("gains", "a", "kp"), ("gains", "b", "kd")]
    for remark, expected in zip(found, (30 / 36, 0.7 / 0.5), strict=True):
        assert remark.value["factor"] == pytest.approx(expected, rel=1e-4)
        assert abs(remark.value["factor"] - expected) < 6 * remark.value["std"] + 1e-7


def test_transmission_that_is_given_is_used(sound: Recording) -> None:
    assert any(r.topic == "gains" and r.severity == "ok" for r in remarks(sound, transmission=BELT))
    wrong = [r for r in remarks(sound, transmission=np.eye(2)) if r.severity in ("warning", "problem")]
    assert wrong


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda r: replace(r, controller=replace(r.controller, period_s=0.004)), "not for the stated 4 ms"),
        (
            lambda r: replace(
                r, time=r.time[:-1], signals={k: v[1:] for k, v in r.signals.items()}, valid=None
            ),
            "first tick is row 3",
        ),
    ],
)
def test_ticks(sound: Recording, change: Callable[[Recording], Recording], text: str) -> None:
    found = [r for r in alarms(change(sound)) if r.topic == "controller"]
    assert len(found) == 1 and text in found[0].text


def test_saturated_torque(sound: Recording) -> None:
    limit = 0.5 * np.abs(sound.signals["torque_measured"][:, 0]).max()
    cut = sound.with_signals(torque_measured=np.clip(sound.signals["torque_measured"], -limit, limit))
    found = next(r for r in alarms(cut) if r.topic == "saturation" and r.axis == "a")
    assert found.value["limit"] == pytest.approx(limit, rel=0.1)


def test_command_at_its_limit(sound: Recording) -> None:
    limit = 0.4 * np.abs(sound.signals["torque_command"][:, 1]).max()
    cut = sound.with_signals(torque_command=np.clip(sound.signals["torque_command"], -limit, limit))
    found = [r for r in alarms(cut) if "Command of 'b' is at its" in r.text]
    assert found and abs(found[0].value["limit"]) == pytest.approx(limit)


def test_held_axis_is_noted_and_not_alarming(sound: Recording) -> None:
    still = sound.position.copy()
    still[:, 1] = still[0, 1]
    quiet = np.random.default_rng(0).normal(0, 0.015, len(sound))
    v = np.column_stack([sound.velocity[:, 0], quiet])
    bare = {"position": still, "velocity": v}
    held = replace(sound, signals=bare, controller=Controller())
    one = inspect([held]).recordings[0]
    assert [e.held for e in one.excited] == [False, True] and alarms(held) == []
    assert any("'b' is held" in r.text for r in one.remarks)


def test_what_was_excited() -> None:
    t = np.arange(8000) / 1000
    q = 0.5 * np.sin(2 * np.pi * 2 * t)
    r = Recording("sine", ("a",), "actuator", t, {"position": q[:, None], "velocity": q[:, None]}, ("rad",))
    e = inspect([replace(r, derived=("velocity",))]).recordings[0].excited[0]
    assert e.position_range == pytest.approx((-0.5, 0.5), abs=1e-3)
    assert e.speed_max == pytest.approx(0.5 * 4 * np.pi, rel=0.01)
    assert e.reversals == 32
    assert e.band_hz[0] > 1.2 and e.band_hz[1] < 2.8
    assert e.low_speed_share == pytest.approx(2 * np.arcsin(0.05) / np.pi, abs=0.005)


def test_json(sound: Recording) -> None:
    plain = json.loads(json.dumps(inspection_dict(inspect([sound])), allow_nan=False))
    one = plain["recordings"][0]
    assert plain["format"] == 1 and plain["sound"] is True and one["recording"] == "made"
    assert one["noise"]["position_resolution"] == pytest.approx([STEP, STEP], rel=1e-3)
    assert {"severity", "topic", "axis", "text", "value"} == set(one["remarks"][0])
    assert [e["axis"] for e in one["excited"]] == ["a", "b"]


def test_a_short_recording_is_inspected_too() -> None:
    t = np.arange(40) / 100
    q = np.sin(t)[:, None]
    r = Recording("short", ("a",), "actuator", t, {"position": q, "velocity": np.cos(t)[:, None]}, ("rad",))
    assert inspect([r]).recordings[0].rows == 40
