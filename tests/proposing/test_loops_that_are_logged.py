"""Gains and references that stand in a log under common names are the loop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.planar_leg import moved
from workbench.core import Recording
from workbench.proposing import Answers, Proposal, complete, open_table, propose

RAD = Answers(units={"position": "rad"})


def put(folder: Path, columns: dict[str, np.ndarray]) -> Path:
    path = folder / "run.csv"
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.9g")
    return path


def mit(
    recording: Recording, ahead: np.ndarray | float = 0.0, kp: np.ndarray | float = 40.0
) -> dict[str, np.ndarray]:
    """Columns as drives in impedance mode are logged: what was seen, and what each was sent."""
    rows = len(recording)
    out = {"t": recording.time}
    for i, axis in enumerate(("thigh", "calf")):
        s = {name: x[:, i] for name, x in recording.signals.items()}
        out |= {f"{axis}.state.q": s["position"], f"{axis}.state.dq": s["velocity"]}
        out |= {f"{axis}.state.tau_est": s["torque_measured"], f"{axis}.cmd.q": s["position_reference"]}
        out |= {f"{axis}.cmd.{name}": np.zeros(rows) + value for name, value in (("dq", 0.0), ("tau", ahead))}
        out |= {f"{axis}.cmd.kp": np.zeros(rows) + kp, f"{axis}.cmd.kd": np.ones(rows)}
    return out


def read(path: Path, answers: Answers = RAD) -> tuple[Proposal, Recording]:
    table = open_table(path)
    return complete(propose(table, answers), table, answers)


def test_gains_beside_the_references_are_the_loop(tmp_path: Path) -> None:
    proposal, recording = read(put(tmp_path, mit(moved())))
    law = recording.controller
    assert (law.kind, law.kp, law.kd) == ("pd", (40.0, 40.0), (1.0, 1.0))
    assert not any("Not used" in note for note in proposal.notes)
    assert "torque_feedforward" not in recording.signals and "torque_command" not in recording.signals


def test_a_torque_that_is_sent_beside_gains_is_a_feedforward(tmp_path: Path) -> None:
    ahead = np.sin(5 * moved().time)
    _, recording = read(put(tmp_path, mit(moved(), ahead)))
    np.testing.assert_allclose(recording.signals["torque_feedforward"][:, 0], ahead, atol=1e-6)
    assert recording.controller.kp == (40.0, 40.0)


def test_gains_that_change_are_no_loop_and_that_is_said(tmp_path: Path) -> None:
    growing = np.linspace(0, 40.0, len(moved()))
    proposal, recording = read(put(tmp_path, mit(moved(), kp=growing)))
    assert recording.controller.kind == "unknown"
    assert any("kp of thigh changes from 0 to 40" in note for note in proposal.notes)


def test_stated_gains_go_before_logged_ones(tmp_path: Path) -> None:
    answers = Answers(units={"position": "rad"}, kp=(7.0,), kd=(0.1,))
    assert read(put(tmp_path, mit(moved())), answers)[1].controller.kp == (7.0, 7.0)


def chirp(top_hz: float, kp: float) -> dict[str, np.ndarray]:
    """One axis behind a loop that follows its reference well, or cannot."""
    t = np.arange(3000) * 0.002
    ref = 0.3 * np.sin(2 * np.pi * (0.2 + (top_hz - 0.2) * t / 12) * t)
    q, v, tau = np.zeros(len(t)), np.zeros(len(t)), np.zeros(len(t))
    for k in range(1, len(t)):
        tau[k] = kp * (ref[k - 1] - q[k - 1]) - 0.3 * v[k - 1]
        v[k] = v[k - 1] + 0.002 * tau[k] / 0.03
        q[k] = q[k - 1] + 0.002 * v[k]
    return {"t": t, "hip_position": q, "hip_velocity": v, "ref": ref, "hip_torque": tau}


@pytest.mark.parametrize("word", ["target", "ref", "goal", "setpoint", "des", "desired", "sp"])
@pytest.mark.parametrize(("top_hz", "kp"), [(2.0, 40.0), (8.0, 40.0), (10.0, 5.0)])
def test_a_reference_by_its_name_however_well_it_is_followed(
    tmp_path: Path, word: str, top_hz: float, kp: float
) -> None:
    columns = {f"hip_{word}" if name == "ref" else name: x for name, x in chirp(top_hz, kp).items()}
    proposal, _ = read(put(tmp_path, columns))
    assert proposal.description["columns"]["position_reference"] == [f"hip_{word}"]


def test_a_reference_of_speed_or_torque_is_none_of_position(tmp_path: Path) -> None:
    columns = chirp(8.0, 40.0)
    for other in ("hip_velocity", "hip_torque"):
        proposal, _ = read(
            put(
                tmp_path, {**columns, "ref": 1.02 * columns[other]} | {"hip_ref": np.roll(columns[other], -2)}
            )
        )
        assert "position_reference" not in proposal.description["columns"]
