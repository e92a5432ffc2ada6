"""The experiment that is proposed tells two explanations apart, by as much as is said."""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.diagnosis.rig import recordings
from workbench.core import Controller, EffectKey, Estimate
from workbench.diagnosis.data import Data, gather
from workbench.diagnosis.evidence.experiment_design import Option, designed, in_a_loop
from workbench.diagnosis.evidence.next_experiment import separation, tell_apart
from workbench.effects import load_model
from workbench.frf import chirp
from workbench.models import AppliedEffect, Model, write_model
from workbench.simulation import held_posture

LEG = load_model("leg")


@pytest.fixture(scope="module")
def data() -> Data:
    training, _ = recordings()
    return gather(LEG, training, (), seed=0)[0]


def having(key: EffectKey, model: Model = LEG, *, std: float = 0.0, **values: float) -> Model:
    return model.with_effect(AppliedEffect(key, {k: Estimate(v, std, "") for k, v in values.items()}))


def sweep(amplitude: float):
    return chirp(
        LEG.axes, f_min_hz=0.2, f_max_hz=2.0, duration_s=3.0, rate_hz=1000.0,
        amplitude=amplitude, hold=held_posture(LEG, {}),
    )  # fmt: skip


def test_a_model_is_not_told_from_itself(data: Data) -> None:
    model = having(EffectKey("coulomb_friction", "knee"), torque=0.2)
    assert separation(model, model, sweep(0.2), data) == pytest.approx(1.0)


def test_free_parameters_follow_as_far_as_they_may(data: Data) -> None:
    key = EffectKey("viscous_damping", "knee")
    ours = having(key, damping=0.10)
    stiff, loose = (
        separation(ours, having(key, std=std, damping=0.13), sweep(0.2), data) for std in (1e-6, 0.05)
    )
    assert stiff > 1.2
    assert loose == pytest.approx(1.0, abs=0.01)


def test_more_motion_tells_more(data: Data) -> None:
    ours = having(EffectKey("torque_bias", "hip"), std=0.01, torque=0.4)
    theirs = having(EffectKey("parallel_spring", "hip"), std=0.01, stiffness=1.0, rest=-0.15)
    small, large = (separation(ours, theirs, sweep(a), data) for a in (0.02, 0.3))
    assert 1.0 <= small < large


def test_the_proposed_command_runs_and_keeps_its_promise(data: Data, tmp_path: Path) -> None:
    from typer.testing import CliRunner

    from workbench.cli.app import app
    from workbench.frf import load_design

    one, other = EffectKey("torque_bias", "hip"), EffectKey("parallel_spring", "hip")
    # a leg in a file of its own, whose name no shipped model has
    write_model(LEG, tmp_path / "my leg.toml")
    own = load_model(tmp_path / "my leg.toml")
    ours = having(one, own, std=0.005, torque=0.4)
    theirs = having(other, own, std=0.005, stiffness=1.0, rest=-0.15)
    said = tell_apart(ours, theirs, one, other, data)
    assert said.startswith(
        "To tell torque bias on the hip drive from parallel spring on the hip drive: workbench "
    )
    command = re.search(r"workbench (excite .*?)\. If one is true.* error of ([\d.]+) times", said)
    assert command is not None, said
    file = tmp_path / "next.toml"
    words = shlex.split(command[1].replace("next.toml", str(file)))
    assert CliRunner().invoke(app, words, catch_exceptions=False).exit_code == 0
    ratio = separation(ours, theirs, load_design(file), data)
    assert np.isclose(ratio, float(command[2]), rtol=0.15)


def test_logs_without_velocity_get_a_proposal_too(data: Data) -> None:
    one, other = EffectKey("torque_bias", "hip"), EffectKey("parallel_spring", "hip")
    ours = having(one, std=0.005, torque=0.4)
    theirs = having(other, std=0.005, stiffness=1.0, rest=-0.15)
    bare = tuple(
        replace(r, signals={k: v for k, v in r.signals.items() if k != "velocity"}) for r in data.recordings
    )
    assert "workbench excite" in tell_apart(ours, theirs, one, other, replace(data, recordings=bare))


def test_what_two_effects_have_in_common_is_asked_for_once(data: Data) -> None:
    one, other = EffectKey("command_delay", None), EffectKey("sensor_delay", None)
    ours, theirs = (having(key, std=1e-4, time=0.002) for key in (one, other))
    silent = tuple(
        replace(r, signals={k: v for k, v in r.signals.items() if k != "torque_measured"})
        for r in data.recordings
    )
    said = tell_apart(ours, theirs, one, other, replace(data, recordings=silent))
    assert said.count("a quarter of the control rate") == 1 and "with measured torque" in said


def test_a_model_without_a_loop_is_lent_that_of_a_recording() -> None:
    loose = replace(LEG, controller=Controller("unknown"))
    training, _ = recordings()
    assert in_a_loop(loose, training) == (loose, ""), "a command names a file"
    logged = [replace(r, source=Path("a run.toml")) for r in training]
    closed, option = in_a_loop(loose, logged)
    assert (closed.controller, option) == (training[0].controller, " --loop 'a run.toml'")
    assert in_a_loop(LEG, logged) == (LEG, "")
    _, command = designed(loose, Option("chirp", "position", 0.2, 2.0, 0.5), logged)
    assert "workbench excite leg --loop 'a run.toml' -o next.toml --kind chirp" in command
