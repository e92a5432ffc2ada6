"""``--into``: the user's own file with the numbers that were found, and nothing else new in it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.bench_arm import FAST, NUMBERS, SLOW, bench_arm, logged
from tests.cli.here import run
from workbench.recordings import save_recording

WRONG = {"lift_damping": 0.4, "yaw_armature": 0.09, "upper_centre": 0.14}


def own_words(file: Path) -> None:
    """The same arm as somebody else writes it: classes, degrees, comments, CRLF."""
    text = file.read_text()
    assert 'damping="0.4" armature="0.0868"' in text
    text = text.replace('damping="0.4" armature="0.0868"', 'class="lifting"')
    kind = '<default><default class="lifting"><joint damping="0.4" armature="0.0868"/></default></default>'
    head = f"<!-- Müllers Arm -->\n<compiler meshdir='meshes'/>\n{kind}"
    text = text.replace('<compiler angle="radian"/>', head)
    file.write_bytes(text.replace("\n", "\r\n").encode())


def finding(effect: str, axis: str, **values: float) -> dict[str, object]:
    parameters = {name: {"value": v, "std": 0.0, "unit": ""} for name, v in values.items()}
    return {"effect": effect, "axis": axis, "parameters": parameters}


FOUND = [
    finding("viscous_damping", "lift", damping=NUMBERS["lift_damping"] - WRONG["lift_damping"]),
    finding("reflected_inertia", "yaw", inertia=NUMBERS["yaw_armature"] - WRONG["yaw_armature"]),
    finding("first_moment_error", "lift", along=0.03 * NUMBERS["upper_mass"], across=0.0),
    finding("coulomb_friction", "bend", torque=0.5),
]
STRANGE = finding("cogging", "yaw", torque=0.02, order=7.0, phase=0.1)


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two logs of the true arm."""
    folder = tmp_path_factory.mktemp("logs")
    truth = bench_arm(folder, "truth")
    soft = '<joint name="bend" solreffriction="0.002 1" frictionloss="0.5"'
    truth.write_text(truth.read_text().replace('<joint name="bend"', soft))
    out = [folder / "slow.toml", folder / "fast.toml"]
    for k, (file, tones) in enumerate(zip(out, (SLOW, FAST), strict=True)):
        save_recording(logged(truth, tones, seconds=4.0, seed=k), file)
    return out


def compared(folder: Path, model: str, logs: list[Path]) -> float:
    ended = run("compare", model, *logs, "--json", "-", cwd=folder)
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)["error"]


@pytest.mark.parametrize("ending", [".xml", ".urdf"])
def test_the_file_scores_what_the_model_with_effects_does(
    ending: str, logs: list[Path], tmp_path: Path
) -> None:
    own, fixed = tmp_path / f"own{ending}", tmp_path / f"fixed{ending}"
    found, model, models = [*FOUND, STRANGE], own.name, (own.name, fixed.name)
    if ending == ".xml":
        own_words(bench_arm(tmp_path, "own", **WRONG))
    else:  # it has no place for rotors, which a model file then states
        own.write_text(urdf())
        found, model, models = [*FOUND[:1], *FOUND[2:], STRANGE], "own.toml", ("own.toml", "fixed.toml")
        for file in (own, fixed):
            rotors = f"inertia = {[NUMBERS[f'{axis}_armature'] for axis in ('yaw', 'lift', 'bend')]}"
            text = f'format = 1\nname = "{file.stem}"\nserial = "{file.name}"\n[actuators]\n{rotors}\n'
            file.with_suffix(".toml").write_text(text)
    before = own.read_bytes()
    (tmp_path / "found.json").write_text(json.dumps({"format": 1, "findings": found}))
    (tmp_path / "named.json").write_text(json.dumps({"format": 1, "findings": found[:-1]}))
    words = "--from", "found.json", "--into", own.name, "-o", fixed.name, "--json", "a.json"
    ended = run("add", model, *words, cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert "cogging on the yaw drive" in ended.stdout and "lift: damping 0.8, not 0.4" in ended.stdout
    said = json.loads((tmp_path / "a.json").read_text())
    assert [row["effect"] for row in said["not_written"]] == ["cogging"]
    assert {(row["joint"], row["number"]) for row in said["written"]} - {("yaw", "armature")} == {
        ("lift", "damping"), ("lift", "centre"), ("bend", "frictionloss"),
    }  # fmt: skip
    assert own.read_bytes() == before
    lines = before.split(b"\n"), fixed.read_bytes().split(b"\n")
    assert len(lines[0]) == len(lines[1])
    assert sum(a != b for a, b in zip(*lines, strict=True)) == (4 if ending == ".xml" else 3)
    words = "--from", "named.json", "-o", "named.toml"
    assert run("add", model, *words, cwd=tmp_path).returncode == 0
    without, with_numbers, with_effects = (
        compared(tmp_path, name, logs[1:]) for name in (*models, "named.toml")
    )
    assert with_numbers == pytest.approx(with_effects, rel=1e-6)
    assert with_numbers < 0.2 * without


def test_improve_writes_what_it_found_and_keeps_its_promise(logs: list[Path], tmp_path: Path) -> None:
    own = bench_arm(tmp_path, "own", lift_damping=0.4)
    own.write_text(own.read_text().replace('<joint name="bend"', '<joint name="bend" frictionloss="0.5"'))
    own_words(own)
    ended = run("improve", "own.xml", logs[1], "--into", "own.xml", "-o", "fixed.xml", "--json", "i.json",
                cwd=tmp_path)  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert "lift: damping 0.8" in ended.stdout
    said = json.loads((tmp_path / "i.json").read_text())
    assert said["not_written"] == [] and [row["number"] for row in said["written"]] == ["damping"]
    assert compared(tmp_path, "fixed.xml", logs[1:]) == pytest.approx(said["error_after"], rel=1e-3)
    before, after = own.read_bytes().split(b"\r\n"), (tmp_path / "fixed.xml").read_bytes().split(b"\r\n")
    new = [(a, b) for a, b in zip(before, after, strict=True) if a != b]
    assert len(new) == 1 and new[0][1].startswith(new[0][0].removesuffix(b"/>") + b' damping="0.')


def refused(folder: Path, *words: object) -> str:
    """The one line in which `add` refuses; nothing is written."""
    before = sorted(folder.rglob("*"))
    ended = run("add", *words, cwd=folder)
    assert ended.returncode == 2 and ended.stderr.count("error: ") == 1 and ended.stdout == ""
    assert sorted(folder.rglob("*")) == before
    return " ".join(ended.stderr.split())


def test_what_would_not_do_is_refused_in_one_line(tmp_path: Path) -> None:
    own = bench_arm(tmp_path, "own", **WRONG)
    own_words(own)
    bench_arm(tmp_path, "other")
    dry = ["own.xml", "coulomb_friction@lift", "torque=0.1"]
    assert "no number for cogging on the yaw drive" in refused(
        tmp_path, "own.xml", "cogging@yaw", "torque=0.1", "order=7", "phase=0", "--into", "own.xml", "-o",
        "new.xml")  # fmt: skip
    assert "give it the ending .xml" in refused(tmp_path, *dry, "--into", "own.xml", "-o", "new.toml")
    assert "give it the ending .xml" in refused(tmp_path, *dry, "--into", "own.xml", "-o", "new.urdf")
    assert "is not based on this file" in refused(tmp_path, *dry, "--into", "other.xml", "-o", "new.xml")
    assert "no such file" in refused(tmp_path, *dry, "--into", "none.xml", "-o", "new.xml")
    assert "--force" in refused(tmp_path, *dry, "--into", "own.xml", "-o", "own.xml")
    assert "'meshes' relative to" in refused(tmp_path, *dry, "--into", "own.xml", "-o", "sub/new.xml")
    assert "--into ROBOT" in refused(tmp_path, *dry, "-o", "new.xml")
    words = "own.xml", "friction_as_in_mjcf", "--into", "own.xml", "-o", "new.xml"
    assert "is not a number in a file" in refused(tmp_path, *words)


def test_effects_that_a_model_file_has_already_are_written_too(tmp_path: Path) -> None:
    own = bench_arm(tmp_path, "own", **WRONG)
    words = "own.xml", "viscous_damping@lift", "damping=0.3", "-o", "first.toml"
    assert run("add", *words, cwd=tmp_path).returncode == 0
    words = "first.toml", "viscous_damping@lift", "damping=0.1", "--into", own, "-o", "sub/new.xml"
    ended = run("add", *words, cwd=tmp_path)
    assert ended.returncode == 0 and "delete those of its [[effects]]" in " ".join(ended.stdout.split())
    assert 'name="lift" axis="0 1 0" damping="0.8"' in (tmp_path / "sub/new.xml").read_text()


def urdf() -> str:
    """The same arm with its wrong numbers, but no rotors, of which a URDF knows nothing."""
    n = {**NUMBERS, **WRONG}
    upper, fore = n["upper_inertia"], n["fore_inertia"]
    links, joints = '<link name="base"/>', ""
    for link, pos, mass, moments in (
        ("turret", "0 0 0.05", 3, (0.01, 0.01, 0.008)),
        ("upper", f"{n['upper_centre']} 0 0", n["upper_mass"], (0.004, upper, upper)),
        ("fore", f"{n['fore_centre']} 0 0", n["fore_mass"], (n["fore_roll"], fore, fore)),
    ):
        xx, yy, zz = moments
        links += f"""
  <link name="{link}"><inertial>
    <origin xyz="{pos}"/><mass value="{mass}"/>
    <inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    for joint, parent, child, pos, axis in (
        ("yaw", "base", "turret", "0 0 0.2", "0 0 1"),
        ("lift", "turret", "upper", "0 0 0.1", "0 1 0"),
        ("bend", "upper", "fore", "0.35 0 0", "0 1 0"),
    ):
        joints += f"""
  <joint name="{joint}" type="continuous"><parent link="{parent}"/><child link="{child}"/>
    <origin xyz="{pos}"/><axis xyz="{axis}"/>
    <dynamics damping="{n[f"{joint}_damping"]}"/></joint>"""
    return f'<?xml version="1.0"?>\n<robot name="arm">{links}{joints}\n</robot>\n'


def test_improve_writes_no_file_where_nothing_was_added(tmp_path: Path) -> None:
    own = bench_arm(tmp_path, "own")
    save_recording(logged(own, FAST, seconds=1.5), tmp_path / "fast.toml")
    words = "own.xml", "cogging@yaw", "torque=1e-6", "order=7", "phase=0", "-o", "ripple.toml"
    assert run("add", *words, cwd=tmp_path).returncode == 0
    words = "ripple.toml", "fast.toml", "--into", "own.xml", "-o", "new.xml", "--json", "i.json"
    ended = run("improve", *words, cwd=tmp_path)
    assert ended.returncode == 0
    assert "Nothing was added, so new.xml was not written." in " ".join(ended.stdout.split())
    assert "explains the data" in ended.stdout and not (tmp_path / "new.xml").exists()
    assert json.loads((tmp_path / "i.json").read_text())["verdict"] == "consistent"
