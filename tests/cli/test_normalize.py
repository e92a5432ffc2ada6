"""``workbench normalize`` as a user runs it."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import pytest

from tests.cli.here import run


def test_a_model_becomes_a_plain_mjcf_file(tmp_path: Path) -> None:
    file = tmp_path / "leg.xml"
    done = run("normalize", "leg", "-o", file, "--variant", "s3n_full", "--json", tmp_path / "n.json")
    assert done.returncode == 0, done.stderr
    for word in ("tendon knee", "armature", "0.0162", "body shank", "free base", f"Wrote {file}"):
        assert word in " ".join(done.stdout.split())
    told = json.loads((tmp_path / "n.json").read_text())
    assert (told["format"], told["model"], told["variant"]) == (1, "leg", "s3n_full")
    armature = [a for a in told["added"] if (a["element"], a["quantity"]) == ("tendon knee", "armature")]
    assert armature == [
        {"element": "tendon knee", "quantity": "armature", "before": None, "after": 0.0162, "unit": "kg*m^2"}
    ]
    assert told["floating_base"]["true_mass"] == pytest.approx(2.13, abs=1e-6)
    assert mujoco.MjModel.from_xml_path(str(file)).nu == 2


def test_an_mjcf_without_drives_is_a_model_too(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(
        '<mujoco><worldbody><body><joint name="j"/><geom size="0.1"/></body></worldbody></mujoco>'
    )
    done = run("normalize", "arm.xml", "-o", "new.xml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "names no closed chain" in " ".join(done.stdout.split())
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "new.xml")).nu == 1


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("leg",), "-o leg.xml"),
        (("no_such_model", "-o", "x.xml"), "no such model file"),
        (("leg", "-o", "x.xml", "--variant", "magic"), "no plain variant is called 'magic'"),
        (("leg", "-o", "x.xml", "--variant", "explicit"), "no plain variant is called 'explicit'"),
        (("emps", "-o", "x.xml", "--variant", "s3n_full"), "parallelogram"),
    ],
)
def test_mistakes_end_in_one_line_and_two(words: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = run("normalize", *words, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr and len(done.stderr.strip().splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    words = ("normalize", "leg", "-o", tmp_path / "leg.xml", "-q")
    assert run(*words).returncode == 0
    first = (tmp_path / "leg.xml").read_text()
    again = run(*words)
    assert again.returncode == 2 and "--force" in again.stderr
    assert run(*words, "--force").returncode == 0
    assert (tmp_path / "leg.xml").read_text() == first


def test_help_has_an_example() -> None:
    assert "Example: workbench normalize" in run("normalize", "--help").stdout
