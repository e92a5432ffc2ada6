"""A joint that was held is an axis all the same, and a tool that is numbered like joints is none."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .make import Answers, imported, log, text

LOG = log()
TOOL = np.column_stack([np.sin(LOG.t * k) for k in (1.0, 2.0, 3.0)])


def with_held(values: np.ndarray, at: float = 0.0) -> np.ndarray:
    """A third joint (N, 3) between the two, at which nothing changes."""
    return np.column_stack([values[:, 0], np.full(len(values), at), values[:, 1]])


def test_a_held_joint_among_arrays_and_a_tool_beside_them(tmp_path: Path) -> None:
    torque, command = with_held(LOG.tau), with_held(LOG.cmd)
    torque[:, 1] = np.random.default_rng(3).normal(0, 0.02, len(torque))  # a sensor is never silent
    q, qd, reference = with_held(LOG.q, 0.25), with_held(LOG.v), with_held(LOG.ref, 0.3)
    np.savez(
        tmp_path / "run.npz", time=LOG.t, q=q, qd=qd, q_cmd=reference,
        tau_measured=torque, tau_command=command, ee_pos=TOOL,
    )  # fmt: skip
    named = ("a", "b", "c")
    proposal, recording = imported(tmp_path / "run.npz", Answers(model_axes=named, axes=named))
    assert recording.axes == named
    for name, values in (("position", q), ("velocity", qd), ("torque_command", command)):
        np.testing.assert_allclose(recording.signals[name], values, atol=1e-9)
    assert any("Not taken as axes" in note and "ee_0, ee_1, ee_2" in note for note in proposal.notes)
    assert not any("derivative" in note for note in proposal.notes), "what stands still has no slope to hold"


def test_units_in_names_hold_for_those_of_the_same_role_alone(tmp_path: Path) -> None:
    """As a German lab writes: "Ist" is measured, "Soll" is asked for, "Grad" are degrees, M is torque."""
    degrees = 180.0 / np.pi
    data = {"Zeit_ms": LOG.t * 1e3}
    for k, joint in enumerate("SE"):
        data |= {
            f"Ist_{joint}[Grad]": LOG.q[:, k] * degrees,
            f"w_{joint}[Grad/s]": LOG.v[:, k] * degrees,
            f"Soll_{joint}[Grad]": LOG.ref[:, k] * degrees,
            f"M_ist_{joint}[Nm]": LOG.tau[:, k],
            f"M_soll_{joint}": LOG.cmd[:, k],
        }
    (tmp_path / "run.csv").write_text(text(data))
    named = ("a", "b")
    proposal, recording = imported(tmp_path / "run.csv", Answers(model_axes=named, axes=named))
    assert proposal.description["units"]["velocity"] == "deg/s"
    for name, values in (("position_reference", LOG.ref), ("torque_command", LOG.cmd), ("velocity", LOG.v)):
        np.testing.assert_allclose(recording.signals[name], values, atol=1e-9)
    assert "velocity_reference" not in recording.signals, "M_soll_S is no speed in m/s"
    assert proposal.description["controller"]["kp"] == [60.0, 30.0]


def test_a_held_joint_among_columns(tmp_path: Path) -> None:
    data = {"t": LOG.t}
    for k, joint in enumerate(("hip", "roll", "knee")):
        data |= {
            f"{joint}_pos": with_held(LOG.q, 0.25)[:, k],
            f"{joint}_vel": with_held(LOG.v)[:, k],
            f"{joint}_torque_cmd": with_held(LOG.cmd)[:, k],
        }
    (tmp_path / "run.csv").write_text(text(data | {"status": np.ones(len(LOG.t))}))
    _, recording = imported(tmp_path / "run.csv")
    assert recording.axes == ("hip", "roll", "knee")
    assert np.ptp(recording.position[:, 1]) == 0.0 and recording.position[0, 1] == 0.25
    assert not recording.signals["torque_command"][:, 1].any()


def test_positions_alone_are_joints_where_no_more_is_logged(tmp_path: Path) -> None:
    np.savez(tmp_path / "run.npz", time=LOG.t, q=LOG.q, link_pos=TOOL)
    _, recording = imported(tmp_path / "run.npz")
    assert len(recording.axes) == 5
