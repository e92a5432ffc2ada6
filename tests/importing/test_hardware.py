"""Virtual hardware of any model: it moves as the reference leg's own simulator and as textbooks say."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.can.make import config, motor
from tests.cli.here import run
from tests.deployment.robot import LIMITS, RANGES
from tests.importing.test_bonds import _mjcf
from workbench.cli.record_can import virtual_motors
from workbench.core import Controller, Excitation, InputError
from workbench.effects import load_model
from workbench.importing import own_plants, own_rig
from workbench.models import Model, read_model, write_model
from workbench.rigs import (
    PERFECT,
    Experiment,
    HiddenEffect,
    HiddenIn,
    LiveLeg,
    MotorBank,
    OwnExperiment,
    VirtualLeg,
    demo_experiments,
)
from workbench.rigs.live import ROW

_STRIBECK = {"coulomb": 0.2, "static": 0.4, "speed": 0.1}
_HIDDEN = {
    "nothing": None,
    "friction at the pin": ("coulomb_friction", "knee", "joint", {"torque": 0.3}),
    "friction in the drive": ("stribeck_friction", "hip", "actuator", _STRIBECK),
    "a soft drive": ("joint_compliance", "knee", "actuator", {"stiffness": 200.0, "damping": 0.3}),
    "late commands": ("command_delay", None, "actuator", {"time": 0.0017}),
    "late sensors": ("sensor_delay", None, "actuator", {"time": 0.0022}),
    "a slow current loop": ("current_loop_lag", "knee", "actuator", {"time_constant": 0.004}),
    "a payload": ("payload_mass", None, "actuator", {"mass": 0.4}),
    "a spring": ("parallel_spring", "knee", "joint", {"stiffness": 2.0, "rest": 0.8}),
    "a wrong encoder": ("encoder_eccentricity", "hip", "actuator", {"amplitude": 0.01, "phase": 0.4}),
    "a tired drive": ("thermal_derating", "hip", "actuator", {"coefficient": 0.004, "time_constant": 0.5}),
    "a gap": ("backlash", "knee", "actuator", {"gap": 0.02, "stiffness": 350.0, "damping": 0.7}),
}  # fmt: skip


def _short() -> Experiment:
    """Half a second of a motion of both axes, slow enough for every loop."""
    whole = demo_experiments(3)[-1]
    return Experiment("short", whole.reference[:500], whole.feedforward[:500], whole.excitation)


@pytest.mark.parametrize("what", _HIDDEN)
def test_the_reference_leg_moves_as_in_its_own_simulator(what: str) -> None:
    """Integrators that share no step: closed forms with located stops, and Drake in pieces."""
    hidden, model, experiment = _HIDDEN[what], read_model("leg"), _short()
    one = [HiddenEffect(*hidden)] if hidden else []  # pyright: ignore[reportArgumentType]
    (wanted,) = VirtualLeg(one, sensors=PERFECT).run([experiment])
    rig = own_rig(model, [HiddenIn(*hidden)] if hidden else [], sensors=PERFECT)
    own = OwnExperiment("short", experiment.reference, experiment.feedforward, experiment.excitation)
    found = rig.run(own)
    size = np.ptp(wanted.signals["position"], axis=0).max()
    for key, scale in (
        ("position", size),
        ("torque_measured", np.abs(wanted.signals["torque_measured"]).max()),
    ):
        off = np.sqrt(np.mean((found.signals[key] - wanted.signals[key]) ** 2))
        # what is hidden changes the motion by far more than the two differ
        assert off < (2e-2 if what == "a gap" else 2e-3) * scale, (key, off / scale)  # flanks bounce
    if hidden:
        (clean,) = VirtualLeg((), sensors=PERFECT).run([experiment])
        changed = np.sqrt(np.mean((wanted.signals["position"] - clean.signals["position"]) ** 2))
        off = np.sqrt(np.mean((found.signals["position"] - wanted.signals["position"]) ** 2))
        assert off < 0.1 * changed


def _sled(folder: Path) -> Model:
    (folder / "sled.xml").write_text(
        '<mujoco><worldbody><body name="sled"><joint name="way" type="slide" axis="1 0 0" armature="0.5"/>'
        '<inertial pos="0 0 0" mass="1.5" diaginertia="0.01 0.01 0.01"/></body></worldbody></mujoco>'
    )
    return replace(read_model(folder / "sled.xml"), controller=Controller("none"))


def test_a_sled_slides_stops_and_stays(tmp_path: Path) -> None:
    """2 kg with 3 N of friction, pushed with 5 N for 0.2 s: a = 1 m/s^2, stops after 0.2 + 0.1333 s."""
    rig = own_rig(
        _sled(tmp_path), [HiddenIn("coulomb_friction", "way", "actuator", {"torque": 3.0})], sensors=PERFECT
    )
    push = np.zeros((600, 1))
    push[:200] = 5.0
    push[400:] = 2.9  # not enough to start it again
    found = rig.run(OwnExperiment("push", None, push, Excitation("steps")))
    x, v = found.signals["position"][:, 0], found.signals["velocity"][:, 0]
    assert found.units == ("m",)
    assert v[200] == pytest.approx(0.2, rel=1e-6)
    assert x[200] == pytest.approx(0.02, rel=1e-6)
    assert v[300] == pytest.approx(0.2 - 0.1 * 1.5, rel=1e-6)
    assert np.abs(v[340:]).max() < 1e-12
    assert x[-1] == pytest.approx(0.02 + 0.2**2 / (2 * 1.5), rel=1e-3)


def test_what_cannot_be_hidden_is_said_in_one_line(tmp_path: Path) -> None:
    model = _sled(tmp_path)
    for effect, told in (
        (HiddenIn("linkage_gravity", None, "actuator", {"g1": 1.0, "g2": 0.0}), "the reference leg alone"),
        (HiddenIn("gremlins", "way"), "is not an effect that can be hidden"),
        (HiddenIn("backlash", "knee"), "no axis 'knee'; axes are way"),
        (HiddenIn("backlash", "way", "joint"), "cannot sit in a joint"),
        (HiddenIn("backlash", "way", "actuator", {"gap": 0.1}), "do not fit"),
        (HiddenIn("payload_mass", None, "actuator", {"mass": 1.0}), "no foot"),
    ):
        with pytest.raises(InputError, match=told):
            own_rig(model, [effect])


def test_a_leg_of_ones_own_hides_what_its_model_lacks(tmp_path: Path) -> None:
    text = _mjcf(tmp_path).read_text()
    even = text.replace('name="rod_end" pos="0 0 -0.2"', 'name="rod_end" pos="0 0 -0.22"')
    (tmp_path / "leg.xml").write_text(
        even.replace('name="heel" pos="0 0 0.05"', 'name="heel" pos="0 0 0.045"')
    )
    words = ["--drive", "hip", "--drive", "crank", "--joint", "hip", "--joint", "knee", "--foot", "toe"]
    words += [
        "--limits",
        "hip=-0.8:0.8",
        "--limits",
        "knee=0.5:1.8",
        "--rotor-inertia",
        0.01,
        "--delay",
        0.002,
    ]
    loop = ["--kp", 50, "--kd", 1.5, "--period", 0.002]
    made = run(
        "import", tmp_path / "leg.xml", *words, "--torque-limit", 20, *loop, "-o", tmp_path / "own.toml"
    )
    assert made.returncode == 0, made.stderr
    (tmp_path / "own.toml").write_text((tmp_path / "own.toml").read_text().replace('"kin_only"', '"exact"'))
    excite = ["excite", "own.toml", "-o", "design.toml", "--period", 1, "--periods", 1, "--amplitude", 3]
    assert run(*excite, cwd=tmp_path).returncode == 0
    refused = run("record", "own.toml", "design.toml", "-o", "data", cwd=tmp_path)
    assert refused.returncode == 2 and "add --virtual" in refused.stderr
    hidden = ["--hide", "coulomb_friction@crank", "--set", "torque=0.4"]
    done = run("record", "own.toml", "design.toml", "-o", "data", "--virtual", *hidden, cwd=tmp_path)
    assert done.returncode == 0 and "Virtual hardware of own: the closed chain of own.sdf" in done.stdout
    files = sorted((tmp_path / "data").glob("*.toml"))
    assert run("compare", "own.toml", *files, "--fail-above", 0.05, cwd=tmp_path).returncode == 1
    add = ["add", "own.toml", "coulomb_friction@crank", "torque=0.4", "-o", "found.toml"]
    assert run(*add, cwd=tmp_path).returncode == 0
    explained = run("compare", "found.toml", *files, cwd=tmp_path)
    assert "explains the data to the noise" in explained.stdout
    # and hardware of the model that has it by itself has it too
    assert len(own_rig(load_model(tmp_path / "found.toml")).machine.frictions) == 1


@pytest.mark.parametrize("stated", ["in the model file", "in the MJCF"])
def test_demo_of_a_machine_of_ones_own(tmp_path: Path, stated: str) -> None:
    """A hinge of a tree: what is hidden is found, nothing of it is told before, and the truth comes last."""
    servo = '<actuator><position joint="axle" kp="40" kv="1.5"/></actuator>' * (stated == "in the MJCF")
    loop = '[controller]\nkind = "pd"\ncoordinates = "joint"\nkp = 40.0\nkd = 1.5\nperiod_s = 0.002\n'
    (tmp_path / "fan.xml").write_text(
        '<mujoco><compiler angle="radian"/><worldbody><body name="fan"><joint name="axle" range="-2 2" '
        'axis="0 0 1" armature="0.01"/><inertial pos="0 0 0" mass="1" diaginertia="0.02 0.02 0.02"/></body>'
        f"</worldbody>{servo}</mujoco>"
    )
    file = 'format = 1\nname = "fan"\nserial = "fan.xml"\n[actuators]\ntorque_limit = 20.0\ndelay_s = 0.002\n'
    (tmp_path / "fan.toml").write_text(file + loop)
    excite = ["excite", "fan.toml", "-o", "plan.toml", "--period", 2, "--periods", 1, "--amplitude", 3]
    assert run(*excite, cwd=tmp_path).returncode == 0
    (tmp_path / "fan.toml").write_text(file + loop * (not servo))
    hidden = ["--hide", "viscous_damping@axle", "--set", "damping=0.12"]
    done = run("demo", "fan.toml", "plan.toml", "-o", "out", *hidden, "--json", "out.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "out.json").read_text())
    assert told["truth"][0]["effect"] == "viscous_damping" and told["truth"][0]["axis"] == "axle"
    assert ("loop is that of the position actuators" in done.stdout) == bool(servo)
    assert "found" in done.stdout and "0.12" not in done.stdout.split("hidden in it")[0]
    assert (tmp_path / "out" / "report.html").is_file() and (tmp_path / "out" / "improved.toml").is_file()


def test_demo_of_a_machine_whose_transmission_changes(tmp_path: Path) -> None:
    """What is hidden at a drive is found in the torque; the model with it explains the recordings."""
    folder = _four_bar(tmp_path)
    excite = ["excite", "four_bar.toml", "-o", "plan.toml", "--period", 2, "--periods", 1, "--amplitude", 2]
    assert run(*excite, cwd=folder).returncode == 0
    done = run("demo", "four_bar.toml", "plan.toml", "-o", "out", *_RUBS, "--json", "out.json", cwd=folder)
    assert done.returncode == 0, done.stderr
    (step,) = json.loads((folder / "out.json").read_text())["steps"]
    assert (step["effect"], step["axis"], step["location"]) == ("coulomb_friction", "knee", "actuator")
    found = step["parameters"]["torque"]
    assert abs(found["value"] - 0.3) < 3.0 * found["std"] < 0.03
    recordings = (folder / "out" / "recordings").glob("*.toml")
    compared = run("compare", "out/improved.toml", *recordings, "--json", "left.json", cwd=folder)
    assert compared.returncode == 0, compared.stderr
    left = json.loads((folder / "left.json").read_text())
    assert left["error"] < 1.1 * left["noise_error"]


def test_a_shipped_model_by_its_name(tmp_path: Path) -> None:
    """As any other model: with --virtual, and no folder of the reference leg is called after it."""
    excite = ["excite", "four_bar", "-o", "plan.toml", "--period", 1, "--periods", 1, "--amplitude", 2]
    assert run(*excite, cwd=tmp_path).returncode == 0
    record = ["record", "four_bar", "plan.toml", "-o", "data"]
    assert "add --virtual" in run(*record, cwd=tmp_path).stderr
    done = run(*record, "--virtual", *_RUBS, cwd=tmp_path)
    assert done.returncode == 0 and done.stdout.startswith("Virtual hardware of four_bar"), done.stderr
    done = run("demo", "four_bar", "plan.toml", "-o", "out", "--hide", "payload_mass", cwd=tmp_path)
    assert done.returncode == 2 and "it needs mass; give --set mass=VALUE" in done.stderr
    done = run("demo", "nothing", "--hide", "payload_mass", cwd=tmp_path)
    assert done.returncode == 2 and "by its file or name" in done.stderr


_RUBS = ["--hide", "coulomb_friction@knee", "--set", "torque=0.3"]


def _four_bar(folder: Path) -> Path:
    write_model(read_model("four_bar"), folder / "four_bar.toml")
    return folder


def test_motors_over_can_turn_the_mechanism_that_is_named(tmp_path: Path) -> None:
    """The same leg in its own simulator and as a model of its own: one motion, over the same buses."""
    loaded = config(
        tmp_path,
        [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))],
        mechanism=[{"model": "leg", "axes": ["hip", "knee"]}],
        loop={"soft_start_s": 0.1},
    )
    told: list[str] = []
    assert isinstance(virtual_motors(loaded, (None, None), told.append)(0, None), MotorBank)
    assert told == ["Virtual hardware: the reference leg on its stand."]
    own = own_plants()("leg", 3, ROW)
    first = [position for position, _, _ in own.look()]
    (leg, _), *rest = MotorBank(loaded, make=lambda name, seed, row: own)._plants
    assert leg is own and not rest
    known = LiveLeg(start=(first[0], first[1] - first[0]), sensors=PERFECT)
    shown = []
    for plant in (own, known):
        rows = []
        for k in range(800):
            plant.command((2.0 * np.sin(0.02 * k), 1.0 * np.cos(0.03 * k)))
            plant.advance()
            rows.append(plant.look())
        shown.append(np.array(rows))
    way = np.ptp(shown[1][:, :, 0], axis=0)
    assert way.min() > 0.05
    np.testing.assert_allclose(shown[0][:, :, 0], shown[1][:, :, 0], atol=1.5e-3)  # four steps of the encoder


def test_hidden_delay_of_the_loop_is_all_that_stays_over_can() -> None:
    late = own_plants([HiddenIn("command_delay", None, "actuator", {"time": 0.001})])("leg", 0, ROW)
    late.command((5.0, 0.0))
    late.advance()
    assert abs(late.look()[0][2]) < 0.2  # the noise alone
    for _ in range(4):
        late.command((5.0, 0.0))
        late.advance()
    assert late.look()[0][2] == pytest.approx(5.0, abs=0.2)
