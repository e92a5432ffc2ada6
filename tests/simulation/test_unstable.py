"""A run that diverges is named: because of what, when; nothing else is said, and no file is left."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import Controller, EffectKey, Estimate, Excitation, InputError, Recording, SimulationError
from workbench.effects import EFFECTS, compile_plant, load_model
from workbench.effects.check import check_effect
from workbench.models import AppliedEffect, Model
from workbench.simulation import Run, simulate


def recording(kp: float = 50.0) -> Recording:
    """A third of a second of both axes under a PD loop."""
    t = np.arange(120) * 0.003
    wave = np.column_stack([0.1 * np.sin(9 * t), 0.1 * np.sin(9 * t) + 1.0])
    signals = {"position": wave, "velocity": np.gradient(wave, 0.003, axis=0), "position_reference": wave}
    return Recording(
        name="short", axes=("hip", "knee"), coordinates="joint", time=t,
        signals={**signals, "torque_measured": wave}, units=("rad", "rad"),
        controller=Controller("pd", "joint", (kp, kp), (1.5, 1.5), period_s=0.003),
        excitation=Excitation(kind="reference"), valid=np.ones(120, bool),
    )  # fmt: skip


def with_effect(name: str, value: float) -> Model:
    """The leg with an effect all whose parameters have this value."""
    model = load_model("leg")
    effect = next(e for e in EFFECTS if e.name == name)
    key = EffectKey(name, None if not effect.locations else "hip")
    values = {p.name: Estimate(value, 0.0, p.unit) for p in effect.parameters}
    return model.with_effect(check_effect(model, AppliedEffect(key, values)))


@pytest.mark.parametrize("value", [-1e6, 1e12])
@pytest.mark.parametrize("name", [e.name for e in EFFECTS])
def test_every_effect_at_its_worst_is_simulated_or_named(
    name: str,
    value: float,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        (made,) = simulate([Run(with_effect(name, value), recording())])
        assert np.isfinite(made.position).all() and np.isfinite(made.get("torque_measured")).all()
    except (SimulationError, InputError) as error:
        assert str(error).isprintable() and ("t = " not in str(error) or name in str(error))
    assert capfd.readouterr() == ("", "") and list(tmp_path.iterdir()) == []


def test_an_inertia_that_a_held_damping_is_too_much_for() -> None:
    model = load_model("leg_kin_only")
    free = replace(model, actuators=replace(model.actuators, torque_limit=(np.inf, np.inf)))
    short = recording()
    with pytest.raises(SimulationError) as caught:
        simulate([Run(free, replace(short, controller=replace(short.controller, kd=(1.5, 40.0))))])
    said = str(caught.value)
    assert "with a period of 3 ms its damping gain of knee needs at least 0.06 kg m^2" in said
    assert 0.0 < float(said.split("the model has ")[1].split(":")[0]) < 0.06
    with pytest.raises(SimulationError) as caught:
        simulate([Run(with_effect("torque_bias", 1e9), short)])
    assert "damping of" not in str(caught.value), "it is not the loop"


def test_the_effect_its_value_and_the_time_are_named() -> None:
    with pytest.raises(SimulationError, match=r"at t = 0\.\d{3} s.*torque_bias@hip \(torque = 1e\+09 N m\)"):
        simulate([Run(with_effect("torque_bias", 1e9), recording())])


def test_gains_are_named_where_no_effect_is_to_blame() -> None:
    model = load_model("leg")
    free = replace(model, actuators=replace(model.actuators, torque_limit=(np.inf, np.inf)))
    with pytest.raises(SimulationError, match="no single effect causes this, and its loop has kp 1e"):
        simulate([Run(free, recording(kp=1e7))])


def test_the_speed_has_the_unit_of_its_axis(tmp_path: Path) -> None:
    bodies = """<body><joint name="rail" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="3" diaginertia=".1 .1 .1"/>
      <body><joint name="arm" type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .01"/></body></body>"""
    (tmp_path / "a.xml").write_text(f"<mujoco><worldbody>{bodies}</worldbody></mujoco>")
    run = replace(recording(), axes=("rail", "arm"), units=("m", "rad"))
    pushed = AppliedEffect(EffectKey("torque_bias", "arm"), {"torque": Estimate(1e9, 0.0, "N*m")})
    with pytest.raises(SimulationError, match=r"\(arm was last at [0-9.e+]+ rad/s\)"):
        simulate([Run(load_model(tmp_path / "a.xml").with_effect(pushed), run)])


def test_a_joint_without_inertia_is_named(tmp_path: Path) -> None:
    joint = '<body><joint name="{}" type="hinge" axis="0 1 0"/>'
    inertia = '<inertial pos="0 0 0" mass="{0}" diaginertia="{0} {0} {0}"/>'
    bodies = joint.format("hip") + inertia.format(1) + joint.format("knee") + inertia.format(1e-14)
    (tmp_path / "a.xml").write_text(f"<mujoco><worldbody>{bodies}</body></body></worldbody></mujoco>")
    with pytest.raises(SimulationError, match="'knee' moves an inertia of 1e-14"):
        compile_plant(load_model(tmp_path / "a.xml"))
    (tmp_path / "a.toml").write_text(
        'format = 1\nname = "a"\nserial = "a.xml"\n[actuators]\ninertia = [0.0, 0.01]\n'
    )
    compile_plant(load_model(tmp_path / "a.toml"))


@pytest.mark.parametrize("text", ["inertia = 1e300", "damping = -1.0", "inertia = nan", "torque_limit = 0.0"])
def test_numbers_that_no_drive_has(text: str, tmp_path: Path) -> None:
    source = load_model("leg").serial
    (tmp_path / "a.toml").write_text(f'format = 1\nname = "a"\nserial = "{source}"\n[actuators]\n{text}\n')
    with pytest.raises(InputError, match=r"actuators\."):
        load_model(tmp_path / "a.toml")
