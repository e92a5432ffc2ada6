"""Where the numbers cannot tell a unit, it is asked for; where a model is there, its weight tells it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.planar_leg import moved, write_leg
from workbench.core import Recording
from workbench.effects import load_model
from workbench.proposing import Answers, Proposal, by_weight, complete, open_table, propose

TURN, DEG = 2 * np.pi, np.pi / 180


def put(
    folder: Path, recording: Recording, names: str = "{axis}.{signal}", *, position: float = 1.0,
    velocity: float = 1.0, torque: str = "torque", ampere: float = 1.0,
) -> Path:  # fmt: skip
    """A CSV file of a recording's motion and measured torque, in units of these sizes."""
    columns = {"time": recording.time}
    for i, axis in enumerate(recording.axes):
        for signal, key, size in (
            ("position", "position", position),
            ("velocity", "velocity", velocity),
            (torque, "torque_measured", ampere),
        ):
            columns[names.format(axis=axis, signal=signal)] = recording.signals[key][:, i] / size
    path = folder / "run.csv"
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.9g")
    return path


def small() -> Recording:
    """A motion of a third of a radian: as many turns would be as usual."""
    whole = moved()
    return whole.with_signals(position=0.2 * whole.position, velocity=0.2 * whole.velocity)


def sure(proposal: Proposal, what: str) -> float:
    return next(a.sure for a in proposal.assumptions if a.what == what)


@pytest.mark.parametrize("names", ["{axis}.{signal}", "q_{axis}.{signal}"])
def test_radians_and_turns_have_one_slope_and_are_asked(tmp_path: Path, names: str) -> None:
    """Those of equations too: a third of a radian, or a third of a turn."""
    proposal = propose(open_table(put(tmp_path, small(), names)))
    (asked,) = proposal.questions
    assert asked.key == "unit.position" and {"rad", "turn"} <= set(asked.choices)
    told = propose(open_table(put(tmp_path, small())), Answers().with_answer("unit.position", "turn"))
    assert not told.questions and told.description["units"]["velocity"] == "turn/s"


def test_a_size_alone_is_never_sure_and_is_remembered(tmp_path: Path) -> None:
    proposal = propose(open_table(put(tmp_path, moved())))
    assert all(sure(proposal, f"unit of {kind}") < 0.97 for kind in ("position", "velocity", "torque"))
    assert proposal.description["guessed_units"] == ["position", "velocity", "torque"]
    _, recording = complete(proposal, open_table(tmp_path / "run.csv"), Answers())
    assert recording.guessed_units == ("position", "velocity", "torque")


def test_a_stated_unit_is_no_guess_nor_is_what_its_slope_tells(tmp_path: Path) -> None:
    path = put(tmp_path, moved(), position=DEG)
    path.write_text(
        path.read_text()
        .replace("hip.position", "hip_position_deg", 1)
        .replace("knee.position", "knee_position_deg", 1)
    )
    proposal = propose(open_table(path))
    assert proposal.description["guessed_units"] == ["torque"]


@pytest.mark.parametrize(("size", "unit"), [(1.0, "rad"), (TURN, "turn"), (DEG, "deg")])
def test_weight_and_inertia_tell(tmp_path: Path, size: float, unit: str) -> None:
    model = load_model(str(write_leg(tmp_path)))
    table = open_table(put(tmp_path, moved(), position=size, velocity=size))
    answers = Answers(model_axes=("hip", "knee"), linear=(False, False))
    told = by_weight(propose(table, answers), table, answers, model)
    proposal = propose(table, told)
    assert proposal.description["units"]["position"] == unit and not proposal.questions
    if unit == "turn":
        assert "weight and inertia" in next(
            a.because for a in proposal.assumptions if a.what == "unit of position"
        )


@pytest.mark.parametrize("tens", [10.0, 100.0, 0.1])
def test_a_decimal_point_that_slipped(tmp_path: Path, tens: float) -> None:
    table = open_table(put(tmp_path, moved(), "{signal}_{axis}", velocity=1 / tens))
    (asked,) = propose(table).questions
    assert (
        asked.key == "unit"
        and f"velocity={1 / tens:g}*rad/s" == asked.best
        and f"{tens:g} times" in asked.text
    )
    for choice in asked.choices:
        answers = Answers().with_answer(asked.key, choice)
        proposal, recording = complete(propose(table, answers), table, answers)
        # of a clock that is a hundred times faster, speeds are strange for radians too
        assert not proposal.questions or choice.startswith("time"), choice
        slope = np.gradient(recording.position, recording.period, axis=0)
        ratio = np.sum(recording.velocity * slope) / np.sum(slope**2)
        assert ratio == pytest.approx(1.0, abs=0.02), choice


def test_a_currents_torque_constant_is_asked_and_may_be_told(tmp_path: Path) -> None:
    path = put(tmp_path, moved(), "{axis}_{signal}", torque="current", ampere=1.3)
    said = Answers(columns={"torque_measured": ("hip_current", "knee_current")})
    (asked,) = propose(open_table(path), said).questions
    assert asked.key == "constant" and not asked.best
    answers = said.with_answer("constant", "1.3, 1.3")
    proposal, recording = complete(propose(open_table(path), answers), open_table(path), answers)
    assert not proposal.questions
    np.testing.assert_allclose(
        recording.signals["torque_measured"], moved().signals["torque_measured"], rtol=1e-6
    )


def test_a_range_at_which_encoders_wrap_tells_the_unit(tmp_path: Path) -> None:
    t = np.arange(3000) * 0.002
    angle = 4 * np.sin(1.3 * t) + 3 * t
    for unit, size, period in (("deg", 360.0, 360.0), ("rad", TURN, TURN), ("turn", 1.0, 1.0)):
        rows = np.column_stack([t, (angle / TURN * size) % period, np.gradient(angle, t) / TURN * size])
        np.savetxt(
            tmp_path / "w.csv", rows, delimiter=",", header="t,position,velocity", comments="", fmt="%.9g"
        )
        proposal = propose(open_table(tmp_path / "w.csv"))
        assert proposal.description["units"]["position"] == unit and not proposal.questions


@pytest.mark.parametrize(("size", "unit"), [(1e-2, "cN*m"), (1e-3, "mN*m"), (1.0, "N*m")])
def test_weight_and_inertia_tell_the_torque_too(tmp_path: Path, size: float, unit: str) -> None:
    model = load_model(str(write_leg(tmp_path)))
    table = open_table(put(tmp_path, moved(), ampere=size))
    answers = Answers(model_axes=("hip", "knee"), linear=(False, False))
    told = by_weight(propose(table, answers), table, answers, model)
    proposal, recording = complete(propose(table, told), table, told)
    assert not proposal.questions
    torque = recording.signals["torque_measured"]
    np.testing.assert_allclose(torque, moved().signals["torque_measured"], rtol=1e-6, atol=1e-9)
    assert proposal.description["units"]["torque"] in (unit, "N*mm" if unit == "mN*m" else unit)


def test_an_encoders_steps_and_steps_a_second(tmp_path: Path) -> None:
    steps = TURN / 4096
    whole = moved()
    rounded = whole.with_signals(
        position=np.round(whole.position / steps + 2048) * steps,
        velocity=np.round(whole.signals["velocity"] / steps) * steps,
    )
    table = open_table(put(tmp_path, rounded, position=steps, velocity=steps))
    (asked,) = propose(table).questions
    assert asked.key == "counts"
    answers = Answers().with_answer("counts", "4096")
    proposal, recording = complete(propose(table, answers), table, answers)
    assert not proposal.questions
    np.testing.assert_allclose(recording.position, rounded.position, atol=1e-9)
    np.testing.assert_allclose(
        recording.signals["velocity"], rounded.signals["velocity"], rtol=1e-6, atol=1e-9
    )


def test_equations_of_a_motor_before_its_gear_are_asked(tmp_path: Path) -> None:
    """Numbers to 14, of a motion of 11: degrees of a joint that hardly moves, or radians of a rotor."""
    whole = moved()
    fast = whole.with_signals(position=11 * whole.position, velocity=11 * whole.signals["velocity"])
    path = put(tmp_path, fast, "{signal}_{axis}")
    path.write_text(path.read_text().replace("position_", "q_").replace("velocity_", "dq_"))
    assert [q.key for q in propose(open_table(path)).questions] == ["unit.position"]


@pytest.mark.parametrize(
    ("names", "gain", "asked"),
    [("{}.pos", 1.0, True), ("{}_pos", 1.0, False), ("{}_pos", 2.0, True), ("{}_pos_deg", 2.0, False)],
)
def test_parts_of_a_range_are_asked_or_noted(tmp_path: Path, names: str, gain: float, asked: bool) -> None:
    """By the names that such robots give, and where numbers are cut off at 100; else it is said at least."""
    t = np.arange(600) / 30
    q = np.clip(gain * np.column_stack([60 * np.sin(t), 40 * np.cos(0.7 * t)]), -100, 100)
    header = ",".join(["t", *(names.format(joint) for joint in ("a", "b"))])
    np.savetxt(tmp_path / "run.csv", np.column_stack([t, q]), delimiter=",", header=header, comments="")
    proposal = propose(open_table(tmp_path / "run.csv"))
    assert [q.key for q in proposal.questions] == ["unit.position"] * asked
    noted = any("caled to each joint's range" in note for note in proposal.notes)
    assert noted == (not asked and "deg" not in names)
