"""Every command on shipped and foreign machines with every output it has: no traceback, all is read again."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import tomli_w
import typer
from mcap.reader import make_reader

from tests.can.make import motor, table
from tests.cli.here import run
from tests.cli.test_options import commands
from workbench.cli import options
from workbench.cli.app import app
from workbench.effects import load_model
from workbench.frf.design_file import load_design
from workbench.recordings import load_recordings

REPOSITORY = Path(__file__).parents[2]
LEG = REPOSITORY / "examples/leg/clean"
#: They run until they are interrupted: `test_interrupted`.
ELSEWHERE = {"ui", "can bus", "can motors", "can virtual", "can log"}
#: What they begin with takes minutes to make; their own tests hold what they write.
REFUSED = {"export", "evaluate", "demo"}

ARM = """<mujoco><compiler angle="radian"/><worldbody><body name="upper" pos="0 0 1">
<joint name="lift" axis="0 1 0" armature="0.05" damping="0.8" frictionloss="0.6"/>
<inertial pos="0 0 -0.15" mass="2" diaginertia="0.02 0.02 0.002"/><body name="fore" pos="0 0 -0.3">
<joint name="bend" axis="0 1 0" armature="0.03" damping="0.4" frictionloss="0.3"/>
<inertial pos="0 0 -0.1" mass="1" diaginertia="0.006 0.006 0.001"/><site name="tool" pos="0 0 -0.2"/></body>
</body></worldbody></mujoco>"""
_LINK = """<link name="{}"><inertial><origin xyz="0 0 {}"/><mass value="{}"/>
<inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
_JOINT = """<joint name="{}" type="continuous"><parent link="{}"/><child link="{}"/><origin xyz="0 0 {}"/>
<axis xyz="0 1 0"/><dynamics damping="{}" friction="{}"/></joint>"""
URDF = "".join(
    [
        '<robot name="arm"><link name="base"/>',
        _LINK.format("upper", -0.15, 2, 0.02, 0.02, 0.002),
        _LINK.format("fore", -0.1, 1, 0.006, 0.006, 0.001),
        _JOINT.format("lift", "base", "upper", 1, 0.8, 0.6),
        _JOINT.format("bend", "upper", "fore", -0.3, 0.4, 0.3),
        "</robot>",
    ]
)
FREE = ARM.replace('<body name="upper" pos="0 0 1">', '<body name="trunk" pos="0 0 1"><freejoint/>'
    '<inertial pos="0 0 0" mass="5" diaginertia="0.1 0.1 0.1"/><body name="upper">').replace(
    "</body></worldbody>", "</body></body></worldbody>")  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Models and a recording of the arm, made by MuJoCo alone, and a CAN configuration."""
    folder = tmp_path_factory.mktemp("matrix")
    for name, text in (("arm.xml", ARM), ("arm.urdf", URDF), ("free.xml", FREE)):
        (folder / name).write_text(text)
    m = mujoco.MjModel.from_xml_string(
        ARM.replace('frictionloss="', 'solreffriction="0.002 1" frictionloss="')
    )
    m.opt.timestep = 0.0005
    d, rows, rng = mujoco.MjData(m), [], np.random.default_rng(0)
    for k in range(800):
        t = 0.002 * k
        reference = 0.4 * np.sin(2 * np.pi * np.array([0.7, 1.1]) * t) * min(t, 1.0)
        q, w = d.qpos + 1e-4 * rng.standard_normal(2), d.qvel + 1e-3 * rng.standard_normal(2)
        torque = 40.0 * (reference - q) - 1.5 * w
        rows.append([t, *q, *w, *torque, *(torque + 0.02 * rng.standard_normal(2)), *reference])
        for _ in range(4):
            d.qfrc_applied[:] = torque
            mujoco.mj_step(m, d)
    names = ["t", *(f"{s}_{a}" for s in "qwcmr" for a in ("lift", "bend"))]
    np.savetxt(folder / "arm.csv", rows, delimiter=",", header=",".join(names), comments="")
    signals = {"q": "position", "w": "velocity", "c": "torque_command", "m": "torque_measured"}
    signals["r"] = "position_reference"
    described = {
        "format": 1, "name": "arm", "table": "arm.csv", "rig": "arm",
        "coordinates": "joint", "axes": ["lift", "bend"],
        "columns": {"time": "t", **{s: [f"{c}_lift", f"{c}_bend"] for c, s in signals.items()}},
        "units": {"time": "s", "position": "rad", "velocity": "rad/s", "torque": "N*m"},
        "controller": {"kind": "pd", "coordinates": "joint", "kp": [40.0] * 2, "kd": [1.5] * 2,
                       "period_s": 0.002},
        "excitation": {"kind": "reference"},
    }  # fmt: skip
    (folder / "arm.toml").write_text(tomli_w.dumps(described))
    (folder / "can.toml").write_text(tomli_w.dumps(table([motor("lift", 1), motor("bend", 2)])))
    return {p.name: p for p in folder.iterdir()}


SUM, DIFFERENCE = LEG / "multisine_sum.toml", LEG / "multisine_diff.toml"
FOREIGN = ("arm.xml", "arm.urdf", "free.xml")
MODELS = ("leg", "leg_kin_only", "actuator", "four_bar", "five_bar", "ankle", "emps", *FOREIGN)
#: What an argument stands for, so that a new command is in the matrix by itself; a model is each of FOREIGN.
ARGUMENTS = {"recordings": "arm.toml", "config": "can.toml", "run": "arm.toml", "bundle": "arm.toml",
             "output": "arm.toml"}  # fmt: skip
#: What commands are asked that need other words, or more; a word that is one of the made files stands for it.
ASKED: dict[str, list[list[Any]]] = {
    "add": [[m, "coulomb_friction@" + a, "torque=0.1"] for m, a in
            (("leg", "knee"), ("actuator", "drive"), ("arm.xml", "lift"), ("arm.urdf", "bend"),
             ("free.xml", "lift"))] + [["arm.xml", "friction_as_in_mjcf"]],
    "approve": [["arm.xml", "arm.toml"]],
    "check": [[m] for m in MODELS],
    "demo": [["arm.toml"]],
    "compare": [["leg", SUM], *([m, "arm.toml"] for m in FOREIGN)],
    "inspect": [[SUM, DIFFERENCE], ["arm.toml"]],
    "excite": [[m, "--amplitude", "0.5", "--period", "1", "--periods", "1", "--f-max", "20", "--rate", "500",
                "--speed-limit", "40", *more]
               for m, more in (("leg", []), *((f, ["--loop", "arm.toml"]) for f in FOREIGN))],
    "fleet": [["arm.toml", "--model", "arm.xml", "--jobs", "1"]],
    "frf": [["leg", SUM, DIFFERENCE], ["arm.xml", "arm.toml"]],
    "identify actuator": [[SUM], ["arm.toml"]],
    "identify leg": [[SUM, DIFFERENCE]],
    "import": [["arm.csv", "--model", "arm.xml", "-y"], ["arm.urdf"]],
    "normalize": [[m] for m in MODELS],
    "record": [["leg", "slow"]],
    "show": [["arm.toml", "--model", "arm.xml"]],
    "train": [["reach", "--variant", "kin_only", "--iterations", "1", "--envs", "4", "--threads", "1",
               "--unverified"]],
    "deploy": [["tracker", "can.toml", "--dry-run", "--seconds", "1"]],
}  # fmt: skip
#: What reads the file that a command writes.
READ: dict[str, Callable[[Path], object]] = {
    "add": lambda p: load_model(str(p)),
    "improve": lambda p: load_model(str(p)),
    "normalize": lambda p: mujoco.MjModel.from_xml_path(str(p)),
    "excite": load_design,
    "record": lambda p: load_recordings(sorted(p.glob("*.toml"))),
    "approve": lambda p: strictly(p.read_text()),
    "identify actuator": lambda p: load_model(str(p)),
    "identify leg": lambda p: load_model(str(p)),
    "import": lambda p: load_recordings([p]),
    "fleet": lambda p: [strictly(each.read_text()) for each in p.glob("*.json")],
}
SUFFIX = {"normalize": ".xml", "can dbc": ".dbc", "approve": ".json", "show": ".html", "export": ".zip"}
SUFFIX |= dict.fromkeys(("record", "fleet", "train", "evaluate"), "")
ENDINGS = {
    "--json": ".json",
    "--html": ".html",
    "--mcap": ".mcap",
    "--rerun": ".rrd",
    "--trace": ".html",
    "--mp4": ".mp4",
}  # of an option that writes a FILE; of others: a picture
READS = {"--record", "--task"}  # options of a FILE that is there already


def tree() -> dict[str, Any]:
    return dict(commands(typer.main.get_command(app)))


def asked_of(name: str, command: Any) -> list[list[Any]]:
    """The words after each call of a command: those stated, else one for every argument that it has."""
    if name in ASKED:
        return ASKED[name]
    arguments = [p.name for p in command.params if p.param_type_name == "argument"]
    unknown = [a for a in arguments if a != "model" and a not in ARGUMENTS]
    assert not unknown, f"say in ASKED what '{name}' is asked: nobody knows its {', '.join(unknown)}"
    machines = FOREIGN if "model" in arguments else ("",)
    return [[m if a == "model" else ARGUMENTS[a] for a in arguments] for m in machines]


def outputs(command: Any, folder: Path, suffix: str) -> dict[str, Path]:
    """Every option by which a command writes, with a file for it."""
    found = {}
    for p in command.params:
        option = p.opts[0]
        if option == "--output":
            found[option] = folder / f"written{suffix}"
        elif p.param_type_name == "option" and p.metavar == "FILE" and option not in READS:
            found[option] = folder / f"{option.strip('-')}{ENDINGS.get(option, '.png')}"
    return found


def strictly(text: str) -> Any:
    def refuse(word: str) -> Any:
        raise AssertionError(f"{word} is no JSON")

    return json.loads(text, parse_constant=refuse)


def fine(ended: Any, words: list[object]) -> bool:
    """Whether it gave an answer; otherwise it was refused in one line."""
    said = ended.stdout + ended.stderr
    assert "Traceback" not in said and "Warning:" not in said, (words, said[-2000:])
    assert ended.returncode in (0, 1, 2), words
    if ended.returncode == 2:
        assert len(re.findall(r"^error: |^Usage|^╭", ended.stderr, re.M)) == 1, (words, ended.stderr)
    return ended.returncode != 2


def test_a_new_command_is_in_the_matrix_by_itself() -> None:
    made = typer.Typer()

    @made.command()
    def weigh(model: options.Model, recordings: options.Recordings, html: options.Html = None) -> None: ...

    command = typer.main.get_command(made)
    assert asked_of("weigh", command) == [[m, "arm.toml"] for m in FOREIGN]
    assert set(outputs(command, Path("x"), ".toml")) == {"--html"}


TREE = tree()
CALLS = {name: asked_of(name, command) for name, command in TREE.items() if name not in ELSEWHERE}
CASES = [(name, k) for name, calls in CALLS.items() for k in range(len(calls))]


@pytest.mark.parametrize(("name", "k"), CASES, ids=[f"{n} {k}" for n, k in CASES])
def test_every_output_of_every_command(name: str, k: int, files: dict[str, Path], tmp_path: Path) -> None:
    words: list[object] = [*name.split(), *(files.get(str(w), w) for w in CALLS[name][k])]
    made = outputs(TREE[name], tmp_path, SUFFIX.get(name, ".toml"))
    asked = [*words, *(w for pair in made.items() for w in pair)]
    ended = run(*asked, cwd=tmp_path)
    if not fine(ended, words):
        assert not any(p.exists() for p in made.values()), (words, "something was written all the same")
        return
    assert name not in REFUSED, "it works now: hold what it writes"
    if "--json" in made:
        assert strictly(made["--json"].read_text())["format"] == 1
    for file in (p for p in made.values() if p.suffix == ".html"):
        page = file.read_text()
        assert page.lstrip().lower().startswith("<!doctype html") and page.rstrip().endswith("</html>")
    for picture in (p for p in made.values() if p.suffix == ".png" and p.exists()):
        assert picture.read_bytes().startswith(b"\x89PNG")
    if "--mcap" in made:
        with made["--mcap"].open("rb") as stream:
            assert any(make_reader(stream, validate_crcs=True).iter_messages())
    if "--rerun" in made:
        assert made["--rerun"].read_bytes().startswith(b"RRF2")
    if "--output" in made and made["--output"].exists() and name in READ:
        READ[name](made["--output"])
    before = {p: p.read_bytes() for p in made.values() if p.is_file()}
    again = run(*asked, cwd=tmp_path)
    assert again.returncode == 2 and "--force" in again.stderr, (words, again.stderr)
    assert {p: p.read_bytes() for p in made.values() if p.is_file()} == before
    if "--json" in made and k == 0:  # what stands on standard output does not depend on the machine
        rest = [w for o, p in made.items() if o == "--output" for w in (o, p)]
        forced = run(*words, *rest, "--json", "-", "--force", cwd=tmp_path)
        assert fine(forced, words) and strictly(forced.stdout)["format"] == 1
        silent = run(*asked, "--force", "--quiet", cwd=tmp_path)
        assert fine(silent, words) and silent.stdout == ""
