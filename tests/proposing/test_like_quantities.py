"""Joints that are called like a quantity, and names that stand beside whole arrays."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import KP, columns, imported, log, same, text
from workbench.proposing import Answers

LOG = log()


@pytest.mark.parametrize("word", ["effort", "time", "position", "load", "current", "motor"])
def test_a_joint_is_called_like_a_quantity(tmp_path: Path, word: str) -> None:
    short = {"pos_ref": "qref", "pos": "q", "vel": "dq", "cmd_torque": "cmd", "torque": "tau"}
    data = {"t": LOG.t}
    for name, values in columns(LOG).items():
        stem, _, joint = name.rpartition("_")
        if joint == "hip":
            data[f"{short[stem]}_{word}"] = values
    path = tmp_path / "run.csv"
    path.write_text(text(data))
    _, recording = imported(path, Answers(model_axes=(word,), linear=(False,)))
    assert recording.axes == (word,)
    assert np.allclose(recording.position[:, 0], LOG.q[:, 0])
    assert np.allclose(recording.signals["torque_measured"][:, 0], LOG.tau[:, 0])
    assert np.allclose(recording.controller.kp, KP[:1], rtol=0.01)


def test_numbered_motors_with_a_state(tmp_path: Path) -> None:
    data = {"t": LOG.t}
    for i in range(2):
        data |= {
            f"motor_state_{i}_q": LOG.q[:, i],
            f"motor_state_{i}_dq": LOG.v[:, i],
            f"motor_state_{i}_tau_est": LOG.tau[:, i],
            f"motor_cmd_{i}_q": LOG.ref[:, i],
            f"motor_cmd_{i}_tau": LOG.cmd[:, i],
        }
    path = tmp_path / "run.csv"
    path.write_text(text(data))
    _, recording = imported(path)
    same(recording, LOG, tolerance=1e-9)


@pytest.mark.parametrize("kind", ["npz", "json"])
def test_a_list_of_names_beside_the_arrays(tmp_path: Path, kind: str) -> None:
    arrays = {"t": LOG.t, "q": LOG.q[:, ::-1], "dq": LOG.v[:, ::-1], "q_des": LOG.ref[:, ::-1]}
    names = ["knee", "hip"]
    path = tmp_path / f"run.{kind}"
    if kind == "npz":
        np.savez(path, **{"joint_names": np.array(names), **arrays})  # pyright: ignore[reportArgumentType]
    else:
        path.write_text(json.dumps({"joint_names": names, **{n: a.tolist() for n, a in arrays.items()}}))
    proposal, recording = imported(path, Answers(model_axes=("hip", "knee"), linear=(False, False)))
    assert not proposal.questions and recording.axes == ("hip", "knee")
    assert np.allclose(recording.position, LOG.q)
