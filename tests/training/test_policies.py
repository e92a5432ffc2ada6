"""The shipped policies do on virtual hardware what they were trained for."""

from pathlib import Path

import numpy as np
import pytest

from workbench.bundle import Policy, read_bundle
from workbench.training.evaluate import evaluate

FOLDER = Path(__file__).resolve().parents[2] / "policies"


@pytest.mark.parametrize("file", sorted(FOLDER.glob("*.zip")), ids=lambda file: file.stem)
def test_every_shipped_policy_is_whole(file: Path) -> None:
    bundle = read_bundle(file)
    policy = Policy(bundle)
    assert np.isfinite(policy(np.zeros(policy.size))).all()
    found = b"[[effects]]" in bundle.files["model/model.toml"]
    assert file.stem.startswith(f"{bundle.task}_{'found' if found else bundle.variant}")
    assert bundle.manifest["training"]["onnx_against_torch"] < 1e-6


@pytest.mark.parametrize(
    ("name", "score", "low", "high"),
    [
        ("reach_s3n_full", "rmse_rad", 0.0, 0.02),
        ("pitch-in-place_s3n_full", "pitch_rate_peak_to_peak_rad_s", 3.2, 7.0),
        ("circular_s3n_full", "forward_m_s", 0.7, 0.9),
        ("circular_s3n_full", "yaw_rad_s", 0.7, 0.9),
    ],
)
def test_policies_transfer_to_the_closed_chain(name: str, score: str, low: float, high: float) -> None:
    result = evaluate(read_bundle(FOLDER / f"{name}.zip"), seconds=2.0)
    assert result.fell_s is None and low < result.scores[score] < high
