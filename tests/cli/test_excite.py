"""Excitations designed for a model, small enough for its limits."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from workbench.cli.app import app
from workbench.core import InputError
from workbench.effects import load_model
from workbench.frf import estimate, load_design
from workbench.identification import fit_leg
from workbench.simulation import Run, as_recording, simulate, whole_period

HOLD = ("--posture", "hip=-0.55", "--posture", "knee=1.0472")
SHORT = ("--period", "1", "--f-min", "1", "--f-max", "40", *HOLD)


def run(*words: object):
    return CliRunner().invoke(app, ["excite", *map(str, words)])


def test_a_design_small_enough_is_left_as_it_is(tmp_path: Path) -> None:
    done = run("leg", "-o", tmp_path / "leg.toml", "--amplitude", 0.9, "--amplitude", 0.54, *SHORT)
    assert done.exit_code == 0, done.output
    assert "2 experiments of" in done.output and "Left at the requested amplitude" in done.output
    design = load_design(tmp_path / "leg.toml")
    assert design.hold == (-0.55, 1.0472) and [t.mode for t in design.trials] == ["sum", "difference"]
    # a whole number of ticks of 3 ms
    assert design.period_s == pytest.approx(0.999)
    assert np.sqrt(np.mean(design.experiments**2, axis=1)) == pytest.approx(np.tile([0.9, 0.54], (2, 1)))


def test_too_large_is_scaled_and_the_limit_is_named(tmp_path: Path) -> None:
    words = ("leg", "-o", tmp_path / "big.toml", "--amplitude", 30, "--speed-limit", 10, *SHORT)
    done = run(*words, "--json", tmp_path / "big.json")
    assert done.exit_code == 0, done.output
    said = json.loads((tmp_path / "big.json").read_text())
    assert said["factor"] < 0.5 and 0.8 < max(u["share"] for u in said["usage"]) <= 0.951
    assert said["binding"]["quantity"] in ("speed", "torque")
    assert (tmp_path / "big_sum.csv.gz").exists()
    assert max(said["rms"]) == pytest.approx(30 * said["factor"])


def test_what_a_model_plays_is_what_a_fit_returns(tmp_path: Path) -> None:
    """From design to simulated recordings to a response to the leg's inertia."""
    done = run("leg", "-o", tmp_path / "leg.toml", "--amplitude", 0.6, "--amplitude", 0.4, *SHORT)
    assert done.exit_code == 0, done.output
    model, design = load_model("leg"), load_design(tmp_path / "leg.toml")
    recordings = simulate([Run(model, as_recording(model, design, e)) for e in range(2)])
    fit = fit_leg(estimate(recordings))
    assert fit.parameters["M11"].value == pytest.approx(0.04793, rel=0.01)
    assert fit.parameters["M12"].value == pytest.approx(0.005413, rel=0.05)
    assert fit.parameters["M22"].value == pytest.approx(0.02368, rel=0.01)
    assert fit.parameters["delay"].value == pytest.approx(0.003, rel=0.01)


def test_chirps_and_machines_without_limits(tmp_path: Path) -> None:
    chirp = run(
        "leg", "-o", tmp_path / "c.toml", "--kind", "chirp", "--drive", "position", "--amplitude", 0.1,
        "--f-max", 10, "--period", 2, *HOLD,
    )  # fmt: skip
    assert chirp.exit_code == 0, chirp.output
    assert load_design(tmp_path / "c.toml").driven == "position_reference"
    slide = run("emps", "-o", tmp_path / "e.toml", "--f-min", 1, "--f-max", 20, "--period", 1)
    assert slide.exit_code == 0 and "no limits" in slide.output


CHIRP = ("--kind", "chirp", "--drive", "position", "--amplitude", 0.05, "--f-max", 10, "--period", 2, *HOLD)


def test_a_chirp_takes_what_a_sweep_can_have(tmp_path: Path) -> None:
    plain, asked = tmp_path / "plain.toml", tmp_path / "asked.toml"
    assert run("leg", "-o", plain, *CHIRP).exit_code == 0
    design = load_design(plain)
    assert (design.periods, design.transient_periods) == (1, 0)
    assert [t.mode for t in design.trials] == ["single", "single"]
    more = ("--periods", 4, "--transient", 2, "--mixing", "orthogonal")
    done = run("leg", "-o", asked, *CHIRP, *more)
    assert done.exit_code == 0, done.output
    design = load_design(asked)
    assert (design.periods, design.transient_periods) == (4, 2)
    assert [t.mode for t in design.trials] == ["sum", "difference"]


@pytest.mark.parametrize(
    "words",
    [
        ("--grid", "full"), ("--per-decade", 8), ("--phases", "random"), ("--realisations", 2), ("--seed", 0),
        ("--grid", "odd", "--seed", 3),
    ],
)  # fmt: skip
def test_a_chirp_refuses_what_only_a_multisine_has(words: tuple, tmp_path: Path) -> None:
    done = run("leg", "-o", tmp_path / "c.toml", *CHIRP, *words)
    named = ", ".join(word for word in words if str(word).startswith("--"))
    assert isinstance(done.exception, InputError) and done.exception.exit_code == 2
    assert f"a chirp has no {named};" in str(done.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ((), "no output file"),
        (("-o", "x.toml", "--posture", "foot=1"), "foot"),
        (("-o", "x.toml", "--posture", "knee=3"), "at rest"),
        (("-o", "x.toml", "--f-max", "600"), "rate"),
        (("-o", "x.toml", "--speed-limit", "-1"), "speed"),
        (("-o", "x.toml", "--period", "nan"), "period"),
        (("-o", "x.txt"), ".toml"),
    ],
)
def test_mistakes_are_one_clear_line(words, part, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = run("leg", *words)
    assert isinstance(done.exception, InputError) and part in str(done.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (("--drive", "position", "--amplitude", "0.01"), "no loop that follows a position reference"),
        (("--posture", "z=0.1"), "no loop that holds a posture"),
        ((), "0 m at rest, not inside position of z"),
    ],
)
def test_a_machine_without_a_loop_is_told_to_state_one(words, part, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bare.xml").write_text(
        '<mujoco><worldbody><body><joint name="z" type="slide" limited="true" range="0 0.25"/>'
        '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody></mujoco>'
    )
    done = run("bare.xml", "-o", "x.toml", *words)
    assert isinstance(done.exception, InputError) and part in str(done.exception)
    assert "[controller]" in str(done.exception)
    assert [p.name for p in tmp_path.iterdir()] == ["bare.xml"]


PENDULUM = (
    '<mujoco><compiler angle="radian"/><worldbody><body><joint name="lift" axis="0 1 0" limited="true" '
    'range="-1 1"/><geom size="0.02" fromto="0 0 0 {} 0 {}" type="capsule" mass="1"/></body></worldbody>'
    "</mujoco>"
)
RUN = """format = 1
table = "run.csv"
axes = ["{}"]
columns = {{time = "t", position = ["q"]}}
"""
PD = '[controller]\nkind = "pd"\ncoordinates = "joint"\nkp = [80.0]\nkd = [4.0]\nperiod_s = 0.002\n'


def test_what_falls_without_a_loop_is_told_before_shrinking(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.xml").write_text(PENDULUM.format(0.3, 0.0))
    monkeypatch.setattr("workbench.frf.scale_to_limits", None)
    done = run("arm.xml", "-o", "x.toml", *SHORT[:6])
    assert isinstance(done.exception, InputError), done.exception
    assert "'arm.xml' has no loop" in str(done.exception) and "--loop REC" in str(done.exception)
    assert not Path("x.toml").exists()


def test_what_hangs_needs_no_loop(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.xml").write_text(PENDULUM.format(0.0, -0.3))
    done = run("arm.xml", "-o", "x.toml", *SHORT[:6], "--amplitude", 0.05)
    assert done.exit_code == 0, done.output


def test_a_recording_lends_its_loop(tmp_path: Path, monkeypatch) -> None:
    """The remedy that a model without a loop is given works, and of the recording no table is needed."""
    monkeypatch.chdir(tmp_path)
    Path("arm.xml").write_text(PENDULUM.format(0.3, 0.0))
    Path("run.toml").write_text(RUN.format("lift") + PD)
    words = ("arm.xml", "-o", "x.toml", *SHORT[:6], "--posture", "lift=0.4")
    done = run(*words, "--loop", "run.toml", "--json", "x.json")
    assert done.exit_code == 0, done.output
    assert load_design(Path("x.toml")).hold == (0.4,)
    inputs = json.loads(Path("x.json").read_text())["provenance"]["inputs"]
    assert {Path(i["file"]).name for i in inputs} == {"arm.xml", "run.toml"}


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (RUN.format("lift"), "states no loop that holds a posture"),
        (RUN.format("other") + PD, "its loop is that of other; give a recording of lift"),
    ],
)
def test_a_recording_without_this_machines_loop_is_refused(
    text: str, part: str, tmp_path: Path, monkeypatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.xml").write_text(PENDULUM.format(0.3, 0.0))
    Path("run.toml").write_text(text)
    done = run("arm.xml", "-o", "x.toml", "--loop", "run.toml")
    assert isinstance(done.exception, InputError) and part in str(done.exception)
    assert not Path("x.toml").exists()


def test_periods_fit_the_ticks() -> None:
    leg, slide = load_model("leg"), load_model("emps")
    assert whole_period(leg, 5.0, 1000.0) == pytest.approx(5.001)
    assert whole_period(leg, 3.0, 1000.0) == pytest.approx(3.0)
    assert whole_period(leg, 1.0, 500.0) == pytest.approx(1.002)
    assert whole_period(slide, 1.0, 1000.0) == pytest.approx(1.0)
