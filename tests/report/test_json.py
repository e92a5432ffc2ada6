from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from workbench.core import InputError
from workbench.report import comparison_dict, diagnosis_dict, improvement_dict, write_json

from . import build


def starts_with(mapping, *keys):
    return list(mapping)[: len(keys)] == list(keys)


def test_comparison_has_the_documented_keys_in_order(comparison):
    out = comparison_dict(comparison)
    assert starts_with(out, "format", "model", "error", "noise_error", "recordings")
    signals = ("position_rmse", "torque_rmse", "position_noise", "torque_noise")
    assert starts_with(out["recordings"][0], "name", "axes", *signals, "error")
    assert out["recordings"][1]["position_rmse"] == list(comparison.recordings[1].position_rmse)
    assert out["consistent"] is False


def test_nan_becomes_null(without_torque):
    out = comparison_dict(replace(without_torque, error=float("nan"), noise_error=np.float64("inf")))
    assert out["recordings"][0]["torque_rmse"] == [None, None]
    assert out["error"] is None and out["noise_error"] is None
    json.dumps(out, allow_nan=False)


def test_diagnosis_has_the_documented_keys_in_order(diagnosis):
    out = diagnosis_dict(diagnosis)
    keys = (
        "format",
        "verdict",
        "error",
        "noise_error",
        "findings",
        "unexplained",
        "next_experiment",
        "not_excited",
    )
    assert starts_with(out, *keys)
    finding = out["findings"][0]
    errors = ("error_after", "holdout_error_before", "holdout_error_after", "probability")
    assert list(finding) == [
        "effect",
        "axis",
        "location",
        "parameters",
        *errors,
        "indistinguishable_from",
        "evidence",
    ]
    assert finding["parameters"] == {"torque": {"value": 0.2541, "std": 0.0016, "unit": "N*m"}}
    assert starts_with(finding["indistinguishable_from"][0], "effect", "axis")
    assert starts_with(out["unexplained"]["where"][0], "axis", "signal", "range", "unit", "share")
    assert out["unexplained"]["evidence"] == []
    assert out["not_excited"][1]["axis"] is None


def test_holdout_is_null_where_there_is_none(diagnosis):
    finding = replace(diagnosis.findings[0], holdout_error_before=None, holdout_error_after=None)
    out = diagnosis_dict(replace(diagnosis, findings=(finding,)))["findings"][0]
    assert out["holdout_error_before"] is None and out["holdout_error_after"] is None


def test_improvement_has_the_documented_keys_and_the_truth_last(improvement):
    out = improvement_dict(improvement)
    errors = ("error_before", "error_after", "holdout_error_before", "holdout_error_after", "noise_error")
    assert starts_with(out, "format", "steps", *errors, "verdict")
    step = ("effect", "axis", "location", "parameters", "error", "holdout_error", "indistinguishable_from")
    assert starts_with(out["steps"][0], *step)
    assert "truth" not in out
    told = improvement_dict(improvement, build.TRUTH)
    assert list(told)[-1] == "truth"
    assert all(starts_with(t, "effect", "axis", "parameters") for t in told["truth"])


def test_write_json_is_whole_and_does_not_overwrite(tmp_path, comparison):
    path = tmp_path / "out.json"
    write_json(comparison_dict(comparison), path)
    text = path.read_text()
    assert json.loads(text)["format"] == 1
    with pytest.raises(InputError, match="the file exists"):
        write_json({}, path)
    assert path.read_text() == text
    write_json({"a": float("nan")}, path, force=True)
    assert json.loads(path.read_text()) == {"a": None}
    assert [p.name for p in tmp_path.iterdir()] == ["out.json"]


def test_a_failed_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "out.json"
    path.write_text("old")
    with pytest.raises(TypeError):
        write_json({"a": object()}, path, force=True)
    assert path.read_text() == "old"


def test_dash_is_standard_output(capsys):
    write_json({"format": 1}, "-")
    assert json.loads(capsys.readouterr().out) == {"format": 1}


def test_a_missing_folder_is_made_and_a_folder_is_no_file(tmp_path):
    write_json({"format": 1}, tmp_path / "new" / "out.json")
    assert json.loads((tmp_path / "new" / "out.json").read_text()) == {"format": 1}
    with pytest.raises(InputError, match="is a folder"):
        write_json({}, tmp_path / "new", force=True)
