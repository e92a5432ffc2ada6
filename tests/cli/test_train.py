"""``workbench train``, ``export``, ``evaluate`` and ``approve`` as a user runs them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.cli.here import run

SMALL = "--envs", 8, "--threads", 1


def test_from_training_to_a_recording(tmp_path: Path) -> None:
    done = run(
        "train", "reach", "--variant", "s3n_full", "--iterations", 1, *SMALL, "--unverified", "-o", "run",
        cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "Trained 1 iterations; wrote run/bundle.zip." in done.stdout
    done = run(
        "train", "reach", "--variant", "s3n_full", "--iterations", 2, *SMALL, "--unverified", "-o", "run",
        "--resume", "--json", "-", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    trained = json.loads(done.stdout)
    assert (trained["task"], trained["variant"], trained["iterations"]) == ("reach", "s3n_full", 2)
    assert trained["unverified"] and not trained["verified"] and trained["episode_s"] > 0
    done = run("export", "run", "-o", "reach.zip", "--json", "-", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    exported = json.loads(done.stdout)
    assert exported["bundle"] == "reach.zip" and trained["bundle"] == "run/bundle.zip"
    same = "task", "variant", "joints", "iterations", "onnx_against_torch", "verified"
    assert [exported[key] for key in same] == [trained[key] for key in same]
    assert {each["file"] for each in exported["provenance"]["inputs"]} == {"config.json", "checkpoint.pt"}
    assert (tmp_path / "reach.zip").read_bytes() == (tmp_path / "run" / "bundle.zip").read_bytes()
    done = run("evaluate", "reach.zip", "-o", "out", "--seconds", 1.5, "--json", "e.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "e.json").read_text())
    assert told["task"] == "reach" and told["hardware"]["scores"]["rmse_rad"] < 2.0
    done = run("compare", "leg", "out/hardware.toml", "--quiet", "--json", "-", cwd=tmp_path)
    assert done.returncode == 0 and json.loads(done.stdout)["model"] == "leg"


def test_an_approved_model_trains_only_as_it_was_compared(tmp_path: Path) -> None:
    done = run("record", "leg", "slow", "-o", "data", "--json", "-", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    [recorded] = json.loads(done.stdout)["recordings"]
    assert (recorded["name"], recorded["file"]) == ("slow", "data/slow.toml")
    assert recorded["rows"] == 15000 and recorded["rate_hz"] == pytest.approx(1000.0)
    add = "add", "leg", "payload_mass", "mass=0.0001", "-o", "mine.toml"
    done = run(*add, "--json", "-", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    added = json.loads(done.stdout)
    assert (added["model"], added["from"], added["file"]) == ("mine", "leg", "mine.toml")
    [effect] = added["effects"]
    assert (effect["effect"], effect["axis"]) == ("payload_mass", None)
    assert effect["parameters"]["mass"]["value"] == 1e-4 and effect["parameters"]["mass"]["unit"] == "kg"
    train = "train", "reach", "--model", "mine.toml", "--iterations", 1, *SMALL
    done = run(*train, "-o", "a", cwd=tmp_path)
    assert done.returncode == 2 and "no verification record" in done.stderr
    done = run("approve", "mine.toml", "data/slow.toml", "--json", "-", cwd=tmp_path)
    assert done.returncode == 0, done.stderr + done.stdout
    told = json.loads(done.stdout)
    assert told["approved"] and told["objections"] == [] and told["file"] == "mine.record.json"
    kept = json.loads((tmp_path / "mine.record.json").read_text())
    assert (told["error"], told["recordings"]) == (kept["error"], kept["recordings"])
    done = run(*train, "-o", "a", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "compared with slow" in done.stdout
    assert json.loads((tmp_path / "a" / "config.json").read_text())["record"]["consistent"]
    # the record says which model it is of, and another one is refused by that
    short = "train", "reach", "--record", "mine.record.json", "--iterations", 1, *SMALL
    done = run(*short, "-o", "c", "--json", "-", cwd=tmp_path)
    assert done.returncode == 0 and json.loads(done.stdout)["model"] == "mine", done.stderr
    done = run(*short, "--model", "four_bar", "-o", "d", cwd=tmp_path)
    assert done.returncode == 2 and "the record is of model 'mine', not of 'four_bar'" in done.stderr
    done = run(*train, "--variant", "kin_only", "-o", "b", cwd=tmp_path)
    assert done.returncode == 2 and "not kin_only" in done.stderr
    (tmp_path / "mine.toml").write_text((tmp_path / "mine.toml").read_text() + "# changed\n")
    done = run(*train, "-o", "b", cwd=tmp_path)
    assert done.returncode == 2 and "stale" in done.stderr


def test_approve_says_no_where_the_data_say_no(tmp_path: Path) -> None:
    assert run("record", "leg", "slow", "-o", "data", cwd=tmp_path).returncode == 0
    approve = "approve", "leg_kin_only", "data/slow.toml", "-o", "record.json", "--json", "told.json"
    done = run(*approve, cwd=tmp_path)
    assert done.returncode == 1 and "Not approved: its error is" in done.stdout
    told = json.loads((tmp_path / "told.json").read_text())
    assert not told["approved"] and told["objections"][0].startswith("its error is")


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("train", "dance", "-o", "x"), "choose one of reach, pitch-in-place, circular"),
        (("train", "reach"), "-o runs/reach"),
        (("train", "reach", "-o", "x", "--legs", "some", "--unverified"), "heavy_leg_rand"),
        (("train", "reach", "-o", "x", "--variant", "magic", "--unverified"), "no plain variant"),
        (("train", "reach", "-o", "x", "--resume", "--unverified"), "no run to continue"),
        (("train", "reach", "-o", "x", "--device", "cuda:99", "--unverified"), "this machine has"),
        (("train", "reach", "-o", "x", "--device", "gpu", "--unverified"), "'gpu' is not a device"),
        (("export", "nowhere", "-o", "x.zip"), "no run here"),
        (("evaluate", "nothing.zip", "-o", "x"), "no such bundle"),
    ],
)
def test_mistakes_end_in_one_line_and_two(words: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 2, done.stdout
    assert says in done.stderr and len(done.stderr.strip().splitlines()) == 1
