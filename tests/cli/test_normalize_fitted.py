"""``workbench normalize`` of a mechanism whose transmission depends on the posture."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco

from tests.cli.here import run


def test_it_is_fitted_and_says_how_far_it_is_off(tmp_path: Path) -> None:
    file = tmp_path / "four_bar.xml"
    done = run("normalize", "four_bar", "-o", file, "--json", tmp_path / "n.json")
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "n.json").read_text())["fitted"]
    said = " ".join(done.stdout.split())
    assert "Not exact" in said and f"inertia by up to {told['inertia_max']:.2%}" in said
    assert 0.0 < told["inertia_rms"] < told["inertia_max"] < 0.05 and len(told["offsets"]) == 2
    assert mujoco.MjModel.from_xml_path(str(file)).nu == 2


def test_it_has_no_variants(tmp_path: Path) -> None:
    done = run("normalize", "four_bar", "-o", "x.xml", "--variant", "s3n_act", cwd=tmp_path)
    assert done.returncode == 2 and "does not change with the posture" in done.stderr
