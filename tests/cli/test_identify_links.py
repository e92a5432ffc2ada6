"""``workbench identify links`` as a user has it: a copy of the file with other links, and nothing else."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from tests.cli.here import run
from workbench.recordings import save_recording

WRONG = {"upper_mass": 3.2, "upper_centre": 0.13, "fore_mass": 0.9, "fore_centre": 0.18, "fore_across": 0.03}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A model with wrong links, and logs of a machine that has dry friction too."""
    there = tmp_path_factory.mktemp("links")
    machine = bench_arm(there, "machine", **WRONG)
    bench_arm(there, "own")
    size = np.array([0.5, 0.9, 0.4])
    for name, tones in (("slow", SLOW), ("fast", FAST)):
        log = logged(machine, tones, resisting=lambda q, w: -size * np.tanh(w / 0.01))
        save_recording(log, there / f"{name}.toml")
    return there


def test_a_copy_of_the_file_gets_the_links(folder):
    before = (folder / "own.xml").read_bytes()
    words = "-o", "fixed.xml", "--json", "links.json", "--html", "links.html", "--figure", "links.png"
    ended = run("identify", "links", "own.xml", "slow.toml", "fast.toml", *words, cwd=folder)
    assert ended.returncode == 0, ended.stderr
    said = " ".join(ended.stdout.split())
    assert "New numbers of the links explain" in said
    assert "workbench diagnose fixed.xml slow.toml fast.toml" in said
    found = json.loads((folder / "links.json").read_text())
    assert found["share"] > 0.95 and found["file"] == "fixed.xml" and not found["held_out"]
    assert {"mass", "first_moment_x", "inertia_zz"} < set(found["links"][0]["numbers"])
    assert (folder / "own.xml").read_bytes() == before
    after = (folder / "fixed.xml").read_bytes()
    bare = [re.sub(rb"<inertial[^>]*/>", b"", text) for text in (before, after)]
    assert after != before and bare[0] == bare[1]
    assert (folder / "links.png").read_bytes().startswith(b"\x89PNG")
    assert "The torque that stays" in (folder / "links.html").read_text()


def test_the_error_falls_with_the_new_file(folder):
    for name in ("own.xml", "again.xml"):
        if name == "again.xml":
            words = "own.xml", "slow.toml", "fast.toml", "-o", name
            assert run("identify", "links", *words, cwd=folder).returncode == 0
        run("compare", name, "fast.toml", "--json", f"{name}.json", cwd=folder)
    before, after = (
        json.loads((folder / f"{n}.json").read_text())["error"] for n in ("own.xml", "again.xml")
    )
    assert after < 0.7 * before


def test_what_would_not_do_is_refused_in_one_line(folder):
    for words, said in (
        (("own.xml", "fast.toml", "-o", "new.toml"), "give it the ending .xml"),
        (("leg", "fast.toml"), "identify leg"),
        (("own.xml", "none.toml"), "none.toml"),
    ):
        ended = run("identify", "links", *words, cwd=folder)
        assert ended.returncode == 2 and ended.stdout == ""
        assert ended.stderr.count("error: ") == 1 and said in " ".join(ended.stderr.split())
    assert not (folder / "new.toml").exists()


def test_where_links_explain_nothing_nothing_is_written(folder, tmp_path):
    """On its own motion a right model has nothing to gain: the answer is no."""
    log = logged(folder / "own.xml", FAST, seed=4)
    save_recording(log, tmp_path / "right.toml")
    ended = run("identify", "links", folder / "own.xml", "right.toml", "-o", "new.xml", cwd=tmp_path)
    assert ended.returncode == 1
    assert "explain nothing" in " ".join(ended.stdout.split()) and not (tmp_path / "new.xml").exists()
