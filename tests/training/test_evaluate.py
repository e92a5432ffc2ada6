"""A bundle on the closed chain in Drake, logged so that compare reads it."""

from pathlib import Path

import numpy as np
import pytest

from workbench.bundle import PolicyBundle, read_bundle, write_bundle
from workbench.comparison import compare
from workbench.effects import load_model
from workbench.mechanism import ClosedChain
from workbench.recordings import load_recordings, save_recording
from workbench.rigs.quadruped import quadruped_mechanism
from workbench.training.evaluate import evaluate, machine_of
from workbench.training.export import to_onnx
from workbench.training.plants import ClosedChainPlant, TrainedPlant, begin
from workbench.training.settings import control_table, layout
from workbench.training.tasks import TASKS

from .make import machine


def simple(task: str, folder: Path) -> PolicyBundle:
    """A bundle whose policy asks for the reference as it stands (reach), else for the posture."""
    wanted = TASKS[task]
    made = machine(wanted.machine)
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
            now = slice(entry["start"], entry["start"] + 2)
            actor["mlp.0.weight"][:, now] = np.eye(2) * 1.01 / wanted.action_scale
    manifest = {
        "task": task, "variant": "s3n_full", "observations": observations,
        "control": control_table(wanted, made), "record": None,
    }  # fmt: skip
    from workbench.models import write_model

    model = folder / "model.toml"
    write_model(load_model("leg"), model)
    files = {"model/model.toml": model.read_bytes()}
    return read_bundle(write_bundle(folder / "simple.zip", manifest, to_onnx(actor), made.xml, files))


def test_a_run_on_virtual_hardware_is_a_recording_that_the_right_model_explains(tmp_path: Path) -> None:
    result = evaluate(simple("reach", tmp_path), seconds=1.5, seed=1)
    assert result.fell_s is None and 0.02 < result.scores["rmse_rad"] < 0.3  # it lags behind
    save_recording(result.recording, tmp_path / "hardware.toml")
    read = load_recordings([str(tmp_path / "hardware.toml")])
    comparison = compare(load_model("leg"), read)
    assert comparison.error < 2.0 * comparison.noise_error
    assert read[0].excitation.kind == "policy" and read[0].controller.period_s == 0.003


def test_the_quadruped_stands_on_the_hardware_as_in_the_simulation(tmp_path: Path) -> None:
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
    one = ClosedChain(load_model("leg").closed_chain).reduced_dynamics(q, np.zeros(2)).mass
    four = chain.reduced_dynamics(np.tile([0.0, *q], 4), np.zeros(12)).mass
    np.testing.assert_allclose(four[np.ix_([1, 2], [1, 2])], one, atol=1e-9)
