"""A table without names, of which the user says a little: the numbers say the rest, and what disagrees."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import log, text
from workbench.core import InputError
from workbench.inspection import inspect
from workbench.proposing import Answers, open_table, propose

from .make import imported

LOG = log()


@pytest.fixture
def nameless(tmp_path: Path) -> Path:
    """Three positions, their speeds, three torques; the third joint is of no interest."""
    third = 0.3 * np.sin(1.7 * LOG.t + 1.0) + 0.1 * np.sin(5.0 * LOG.t)
    q, v = np.column_stack([LOG.q, third]), np.column_stack([LOG.v, np.gradient(third, 0.005)])
    data = {str(k): column for k, column in enumerate(np.column_stack([q, v, LOG.tau, LOG.tau[::-1, 0]]).T)}
    file = tmp_path / "run.csv"
    file.write_text(text(data, header=False))
    return file


def answers(rate: float | None, *positions: str) -> Answers:
    return Answers(columns={"position": positions}, model_axes=("a", "b"), rate_hz=rate)


def test_speeds_of_stated_positions_are_found(nameless: Path) -> None:
    columns = propose(open_table(nameless), answers(200.0, "column_1", "column_2")).description["columns"]
    assert columns["velocity"] == ["column_4", "column_5"]


def test_speeds_follow_the_order_in_which_positions_are_stated(nameless: Path) -> None:
    said = Answers(columns={"position": ("column_3", "column_1", "column_2")}, rate_hz=200.0)
    columns = propose(open_table(nameless), said).description["columns"]
    assert columns["velocity"] == ["column_6", "column_4", "column_5"]


def test_they_tell_the_rate(nameless: Path) -> None:
    (asked,) = propose(open_table(nameless), answers(None, "column_1", "column_2")).questions
    assert asked.key == "rate" and float(asked.best) == pytest.approx(200.0, rel=0.03)


def test_a_stated_rate_that_all_speeds_contradict_is_told(nameless: Path) -> None:
    proposal, recording = imported(nameless, answers(400.0, "column_1", "column_2"))
    (note,) = [n for n in proposal.notes if "rows per second" in n]
    assert "on every axis" in note and float(note.split("--rate ")[1]) == pytest.approx(200.0, rel=0.03)
    (problem,) = [r for r in inspect([recording]).recordings[0].remarks if r.severity == "problem"]
    assert problem.topic == "clock" and problem.value["rate_hz"] == pytest.approx(200.0, rel=0.03)


def test_degrees_a_second_are_no_wrong_rate(nameless: Path) -> None:
    table = np.loadtxt(nameless, delimiter=",")
    table[:, 3:6] *= 180.0 / np.pi
    np.savetxt(nameless, table, delimiter=",")
    said = Answers(**{**vars(answers(200.0, "column_1", "column_2")), "units": {"velocity": "rad/s"}})
    notes = propose(open_table(nameless), said).notes
    assert not [n for n in notes if "rows per second" in n] and any("deg/s" in n for n in notes)


def test_a_speed_off_by_thousands_of_millions_is_no_wrong_clock(nameless: Path) -> None:
    table = np.loadtxt(nameless, delimiter=",")
    table[:, 3:6] *= 3.1e9
    np.savetxt(nameless, table, delimiter=",")
    said = Answers(**{**vars(answers(200.0, "column_1", "column_2")), "units": {"velocity": "rad/s"}})
    remarks = inspect([imported(nameless, said)[1]]).recordings[0].remarks
    assert {r.topic for r in remarks if r.severity == "problem"} == {"unit"}


def test_too_many_positions_are_shown_by_their_columns(nameless: Path) -> None:
    with pytest.raises(InputError, match="of the columns column_1, column_2, column_3"):
        propose(open_table(nameless), Answers(model_axes=("a", "b"), rate_hz=200.0))


@pytest.fixture
def reversed_order(tmp_path: Path) -> Path:
    """Joint b's columns before joint a's; torques are currents in mA, 1.5 and 0.5 N m per A."""
    currents = 1e3 * LOG.tau / (1.5, 0.5)
    data = {"time [s]": LOG.t}
    for k, name in ((1, "b"), (0, "a")):
        data |= {f"{name}_pos [rad]": LOG.q[:, k], f"{name}_vel [rad/s]": LOG.v[:, k]}
    data |= {f"{name}_current [mA]": currents[:, k] for k, name in ((1, "b"), (0, "a"))}
    file = tmp_path / "run.csv"
    file.write_text(text(data))
    return file


@pytest.mark.parametrize("axes", [(), ("a", "b"), ("b", "a")])
def test_stated_columns_are_in_the_order_of_the_axes(reversed_order: Path, axes: tuple[str, ...]) -> None:
    order = axes or ("a", "b")
    names = tuple(f"{axis}_current [mA]" for axis in order)
    constants = ",".join({"a": "1.5*N*m", "b": "0.5*N*m"}[axis] for axis in order)
    said = Answers(
        columns={"torque_measured": names}, units={"torque": constants}, axes=axes, model_axes=("a", "b")
    )
    _, recording = imported(reversed_order, said)
    torque = dict(zip(recording.axes, recording.signals["torque_measured"].T, strict=True))
    np.testing.assert_allclose(torque["a"], LOG.tau[:, 0], atol=1e-4)
    np.testing.assert_allclose(torque["b"], LOG.tau[:, 1], atol=1e-4)


def test_a_torque_constant_is_per_ampere_of_milliampere_columns(reversed_order: Path) -> None:
    said = Answers(
        columns={"torque_measured": ("a_current [mA]", "b_current [mA]")},
        units={"torque": "2*N*m"},
        model_axes=("a", "b"),
    )
    proposal, _ = imported(reversed_order, said)
    assert proposal.description["units"]["torque"] == "0.002*N*m"
    assert any("2*N*m per A is 0.002*N*m per mA" in note for note in proposal.notes)
