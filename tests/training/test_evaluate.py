"""A bundle on the closed chain in Drake, logged so that compare reads it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.bundle import PolicyBundle, read_bundle, write_bundle
from workbench.comparison import compare
from workbench.core import Controller, InputError
from workbench.core.paths import closed_chain_file
from workbench.effects import load_model
from workbench.mechanism import ClosedChain
from workbench.models import Model, read_model
from workbench.recordings import load_recordings, save_recording
from workbench.rigs.quadruped import quadruped_mechanism
from workbench.training.evaluate import evaluate
from workbench.training.export import to_onnx
from workbench.training.machine import make_machine
from workbench.training.of_bundle import hardware_of, machine_of, robot_files
from workbench.training.plant import begin
from workbench.training.plants import ClosedChainPlant, TrainedPlant
from workbench.training.settings import control_table, layout
from workbench.training.tasks import TASKS

from .make import machine

POLICIES = Path(__file__).resolve().parents[2] / "policies"


def simple(task: str, folder: Path, of: Model | None = None) -> PolicyBundle:
    """A bundle whose policy asks for the reference as it stands (reach), else for the posture."""
    wanted = TASKS[task]
    made = machine(wanted.machine) if of is None else make_machine(wanted.machine, of)
    observations = layout(wanted, made)
    size = sum(o["size"] for o in observations)
    actor = {
        "obs_normalizer._mean": np.zeros((1, size), np.float32),
        "obs_normalizer._std": np.ones((1, size), np.float32),
        "mlp.0.weight": np.zeros((made.size, size), np.float32),
        "mlp.0.bias": np.zeros(made.size, np.float32),
    }
    for entry in observations:
        if entry["name"] == "reach_ahead":
            now = slice(entry["start"], entry["start"] + made.size)
            actor["mlp.0.weight"][:, now] = np.eye(made.size) * 1.01 / wanted.action_scale
    manifest = {
        "task": task, "variant": made.model.variant, "observations": observations,
        "control": control_table(wanted, made), "record": None,
    }  # fmt: skip
    from workbench.models import write_model

    model = folder / "model.toml"
    files = {}
    if of is not None:
        (folder / "own.xml").write_bytes(of.serial.read_bytes())
        files["model/own.xml"] = of.serial.read_bytes()
        of = replace(of, serial=folder / "own.xml")
    write_model(of or load_model("leg"), model)
    files["model/model.toml"] = model.read_bytes()
    return read_bundle(write_bundle(folder / "simple.zip", manifest, to_onnx(actor), made.xml, files))


def test_a_run_on_hardware_is_explained_by_the_right_model(tmp_path: Path) -> None:
    result = evaluate(simple("reach", tmp_path), seconds=1.5, seed=1)
    assert result.fell_s is None and 0.02 < result.scores["rmse_rad"] < 0.3  # it lags behind
    save_recording(result.recording, tmp_path / "hardware.toml")
    read = load_recordings([str(tmp_path / "hardware.toml")])
    comparison = compare(load_model("leg"), read)
    assert comparison.error < 2.0 * comparison.noise_error
    assert read[0].excitation.kind == "policy" and read[0].controller.period_s == 0.003


def test_a_machine_of_ones_own_is_evaluated_on_its_own_hardware(tmp_path: Path) -> None:
    """Three axes without a loop, which the reference leg stood in for; its own damping is in the hardware."""
    (tmp_path / "arm.xml").write_text(
        '<mujoco><compiler angle="radian"/><default><joint armature="0.05" damping="0.3"/></default>'
        '<worldbody><body><joint name="turn" axis="0 0 1" range="-2 2"/><inertial pos="0 0 0" mass="2" '
        'diaginertia="0.01 0.01 0.01"/><body pos="0 0 0.1"><joint name="lift" axis="0 1 0" range="-1 1.2"/>'
        '<inertial pos="0.01 0 0.15" mass="1.8" diaginertia="0.02 0.02 0.002"/><body pos="0 0 0.3">'
        '<joint name="bend" axis="0 1 0" range="0.2 2"/><inertial pos="0 0 0.12" mass="1" '
        'diaginertia="0.008 0.008 0.001"/></body></body></body></worldbody></mujoco>'
    )
    loop = Controller("pd", "joint", kp=(120.0,) * 3, kd=(5.0,) * 3, period_s=0.003)
    own = replace(read_model(tmp_path / "arm.xml"), controller=loop)
    bundle = simple("reach", tmp_path, own)
    assert "the tree of own.xml" in hardware_of(bundle) and "3 drives" in hardware_of(bundle)
    (tmp_path / "walks").mkdir()
    assert "reference quadruped" in hardware_of(simple("circular", tmp_path / "walks"))
    result = evaluate(bundle, seconds=1.5, seed=1)
    assert set(result.scores) == {"turn_rmse_rad", "lift_rmse_rad", "bend_rmse_rad", "rmse_rad"}
    goal = result.recording.signals["position_reference"]
    assert np.all(goal[:, 2] > 0.2) and np.all(goal[:, 1] < 1.2)
    save_recording(result.recording, tmp_path / "hardware.toml")
    comparison = compare(own, load_recordings([str(tmp_path / "hardware.toml")]))
    assert comparison.error < 1.3 * comparison.noise_error


def test_a_policy_of_other_legs_does_not_walk_on_the_reference(tmp_path: Path) -> None:
    made = machine("quadruped")
    other = tmp_path / "other.sdf"
    other.write_text(closed_chain_file("leg").read_text().replace("<mass>1.8", "<mass>1.9"))
    chain = made.model.closed_chain
    assert chain is not None
    legs = replace(made, model=replace(made.model, closed_chain=replace(chain, file=other)))
    with pytest.raises(InputError, match="the only walking virtual hardware is the reference quadruped"):
        ClosedChainPlant(legs)


def test_quadruped_recordings_are_read_with_base_and_model(tmp_path: Path) -> None:
    bundle = simple("pitch-in-place", tmp_path)
    result = evaluate(bundle, seconds=1.5, hardware=False)
    save_recording(result.recording, tmp_path / "simulation.toml")
    (read,) = load_recordings([str(tmp_path / "simulation.toml")])
    assert {"base_position", "base_orientation", "ground_force"} <= set(read.extra)
    for file, text in robot_files(bundle, tmp_path).items():
        file.write_text(text)
    robot = load_model(tmp_path / "robot.toml")
    assert robot.floats and robot.ground is not None and len(robot.ground.feet) == 4
    comparison = compare(robot, [read])
    assert comparison.error < 1.5 * comparison.noise_error
    (tmp_path / "leg").mkdir()
    assert robot_files(simple("reach", tmp_path / "leg"), tmp_path) == {}


def test_the_quadruped_stands_on_hardware_as_in_simulation(tmp_path: Path) -> None:
    made = simple("pitch-in-place", tmp_path)
    for hardware in (True, False):
        result = evaluate(made, seconds=1.5, hardware=hardware)
        assert result.fell_s is None and result.scores["planted_share"] == 1.0
        assert result.scores["pitch_rate_peak_to_peak_rad_s"] < 0.3
        weight = result.recording.extra["ground_force"][-100:].reshape(100, 4, 3).sum(axis=1).mean(axis=0)[2]
        assert weight == pytest.approx(16.4 * 9.81, rel=0.06)


def test_both_plants_begin_alike_and_name_the_same_things(tmp_path: Path) -> None:
    made = machine_of(simple("circular", tmp_path), tmp_path / "files")
    states = []
    for plant in (ClosedChainPlant(made), TrainedPlant(made)):
        begin(plant, made)
        states.append(plant.state())
        plant.advance(np.full(12, 3.0))
        states.append(plant.state())
    before, after, twin, twin_after = states
    np.testing.assert_allclose(before.position, twin.position, atol=1e-12)
    np.testing.assert_allclose(before.pose, twin.pose, atol=1e-12)
    np.testing.assert_allclose(after.velocity, twin_after.velocity, atol=0.06)
    np.testing.assert_allclose(after.rate, twin_after.rate, atol=0.02)


def test_the_quadruped_s_legs_are_the_reference_leg() -> None:
    chain, leg = ClosedChain(quadruped_mechanism()), machine("leg")
    q = leg.transmission @ leg.posture
    reference = load_model("leg").closed_chain
    assert reference is not None
    one = ClosedChain(reference).reduced_dynamics(q, np.zeros(2)).mass
    four = chain.reduced_dynamics(np.tile([0.0, *q], 4), np.zeros(12)).mass
    np.testing.assert_allclose(four[np.ix_([1, 2], [1, 2])], one, atol=1e-9)


def test_a_quadrupeds_own_simulation_is_explained(tmp_path: Path) -> None:
    """Run in the steps that made it, with the contact that priorities name: it was 13.5 times its noise."""
    bundle = read_bundle(POLICIES / "pitch-in-place_s3n_full.zip")
    log = evaluate(bundle, seconds=1.5, hardware=False).recording
    assert log.timing.stepped
    for file, text in robot_files(bundle, tmp_path).items():
        file.write_text(text)
    result = compare(load_model(tmp_path / "robot.toml"), [log])
    assert result.consistent
    (entry,) = result.recordings
    assert (entry.position_rmse < 1.5 * entry.position_noise).all()
