"""Where a base that floats was: known by names and numbers where the model's base floats, else stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.proposing.make import columns, imported, log, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose

LOG = log()
N = len(LOG.t)
STANDS = Answers(model_axes=("hip", "knee"), floats=True)


def put(folder: Path, place: str, turn: str, more: str = "") -> Path:
    """The log with a pose: columns of these names, a letter at each."""
    x, y, z, w = Rotation.from_euler("xyz", 0.1 * np.column_stack([LOG.q, LOG.q[:, 0]])).as_quat().T
    pose = {place.format(k): 0.1 * v for k, v in zip("xyz", (x, y, z + 5.0), strict=True)}
    pose |= {turn.format(k): v for k, v in zip("xyzw", (x, y, z, w), strict=True)}
    pose |= {more.format(k): v for k, v in zip("xyz", (y, z, x), strict=True)} if more else {}
    (folder / "run.csv").write_text(text(columns(LOG) | pose))
    return folder / "run.csv"


@pytest.mark.parametrize(
    ("place", "turn", "more"),
    [
        ("base_pos_{}", "base_quat_{}", "base_vel_{}"),
        ("mocap_{}", "mocap_q{}", "imu_gyro_{}"),
        ("/odom/pose/position.{}", "/odom/pose/orientation.{}", "/odom/twist/linear.{}"),
        ("trunk position [{}]", "trunk orientation [{}]", ""),
    ],
)
def test_the_pose_is_found_and_is_no_joint(tmp_path: Path, place: str, turn: str, more: str) -> None:
    proposal, recording = imported(put(tmp_path, place, turn, more), STANDS)
    assert recording.axes == ("hip", "knee")
    assert recording.extra["base_position"].shape == (N, 3) and recording.extra["base_position"][0, 2] > 0.4
    np.testing.assert_allclose(np.linalg.norm(recording.extra["base_orientation"], axis=1), 1.0, atol=1e-5)
    assert (recording.extra["base_orientation"][:, 0] > 0.9).all(), "w comes first"
    assert not any("Not among the axes" in note for note in proposal.notes)


def test_what_is_not_known_is_asked_for_and_can_be_stated(tmp_path: Path) -> None:
    file = put(tmp_path, "p{}", "angle_{}")
    turn = tuple(f"angle_{k}" for k in "wxyz")
    stated = {"base_position": ("px", "py", "pz"), "base_orientation": turn}
    told = propose(open_table(file), Answers(model_axes=STANDS.model_axes, floats=True, columns=stated))
    assert told.description["columns"]["base_position"] == ["px", "py", "pz"]
    (tmp_path / "bare.csv").write_text(text(columns(LOG)))
    bare = propose(open_table(tmp_path / "bare.csv"), STANDS)
    assert any("--column base_position=X,Y,Z" in note for note in bare.notes)
    fixed = propose(open_table(file), Answers(model_axes=STANDS.model_axes))
    assert "base_position" not in fixed.description["columns"]
    with pytest.raises(InputError, match="base_orientation has 4 columns, not 1"):
        propose(open_table(file), Answers(floats=True, columns={"base_orientation": ("px",)}))
