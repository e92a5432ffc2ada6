"""A run becomes one file that says everything; changed or foreign files are refused."""

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest
import torch
from rsl_rl.models import MLPModel
from tensordict import TensorDict

from workbench.bundle import Policy, read_bundle, write_bundle
from workbench.core import InputError
from workbench.training.export import export, to_onnx

from .make import machine, run


@pytest.fixture(scope="module")
def bundle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    run(folder / "run", 2)
    return export(folder / "run", folder / "reach.zip")


def test_onnx_gives_what_rsl_rl_s_actor_gives() -> None:
    torch.manual_seed(0)
    seen = TensorDict({"policy": 3.0 * torch.randn(64, 7)}, batch_size=[64])
    noise = {"class_name": "GaussianDistribution", "init_std": 1.0, "std_type": "log"}
    actor = MLPModel(
        seen,
        {"actor": ["policy"]},
        "actor",
        3,
        [32, 16],
        "elu",
        obs_normalization=True,
        distribution_cfg=noise,
    )
    actor.train()
    actor.update_normalization(seen)
    actor.eval()
    policy = to_onnx({k: v.numpy() for k, v in actor.state_dict().items()})
    import onnxruntime

    session = onnxruntime.InferenceSession(policy, providers=["CPUExecutionProvider"])
    found = session.run(None, {"obs": seen["policy"].numpy()})[0]
    np.testing.assert_allclose(found, actor(seen).detach().numpy(), atol=1e-6)


def test_a_bundle_says_what_actions_mean(bundle: Path) -> None:
    made, read = machine("leg"), read_bundle(bundle)
    assert (read.task, read.variant, read.verified) == ("reach", "s3n_full", False)
    np.testing.assert_array_equal(read.control.transmission, [[1.0, 0.0], [1.0, 1.0]])
    np.testing.assert_array_equal(read.control.kp, made.kp)
    assert (read.control.control_period_s, read.control.policy_period_s, read.control.delay_steps) == (
        0.003,
        0.018,
        1,
    )
    assert [o.start for o in read.observations] == list(
        np.cumsum([0] + [o.size for o in read.observations])[:-1]
    )
    assert read.machine == made.xml
    assert {"model/model.toml", "model/leg.xml", "model/leg.sdf"} == set(read.files)
    assert read.manifest["training"]["iterations"] == 2
    actions = Policy(read)(np.zeros((5, 18)))
    assert actions.shape == (5, 2) and Policy(read)(np.zeros(18)).shape == (2,)
    np.testing.assert_array_equal(actions[0], actions[4])


def test_the_same_run_gives_the_same_file(bundle: Path, tmp_path: Path) -> None:
    again = export(bundle.parent / "run", tmp_path / "again.zip")
    assert again.read_bytes() == bundle.read_bytes()
    with pytest.raises(InputError, match="the file exists"):
        export(bundle.parent / "run", tmp_path / "again.zip")


def test_a_part_that_was_changed_is_noticed(bundle: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(bundle) as old, zipfile.ZipFile(tmp_path / "bad.zip", "w") as new:
        for name in old.namelist():
            data = old.read(name)
            new.writestr(name, data.replace(b"0.0162", b"0.0163") if name == "machine.xml" else data)
    with pytest.raises(InputError, match=r"'machine.xml' is missing or was changed"):
        read_bundle(tmp_path / "bad.zip")


@pytest.mark.parametrize(
    ("content", "says"),
    [(None, "no such bundle"), (b"PK nonsense", "not a policy bundle"), (b"", "not a policy")],
)
def test_what_is_no_bundle_is_refused(content: bytes | None, says: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "x.zip").write_bytes(content)
    with pytest.raises(InputError, match=says):
        read_bundle(tmp_path / "x.zip")


def test_another_format_and_a_manifest_with_holes_are_refused(bundle: Path, tmp_path: Path) -> None:
    read = read_bundle(bundle)
    write_bundle(tmp_path / "holes.zip", {"task": "reach"}, read.policy, read.machine, {})
    with pytest.raises(InputError, match="has no 'control'"):
        read_bundle(tmp_path / "holes.zip")
    with zipfile.ZipFile(tmp_path / "new.zip", "w") as archive:
        archive.writestr("bundle.json", json.dumps({"format": 99}))
    with pytest.raises(InputError, match="format 99"):
        read_bundle(tmp_path / "new.zip")
