"""A bundle of a stranger: nothing in it runs, nothing leads out of it, nothing in it grows without end."""

from __future__ import annotations

import hashlib
import json
import stat
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from workbench.bundle import Policy, PolicyBundle, read_bundle
from workbench.bundle.network import MOST_NUMBERS, check_network
from workbench.core import InputError
from workbench.training.of_bundle import machine_of

CONTROL = {
    "joints": ["hip", "knee"], "transmission": [[1.0, 0.0], [1.0, 1.0]], "posture": [0.0, 0.0],
    "action_scale": 0.5, "kp": [1.0, 1.0], "kd": [0.1, 0.1], "torque_limit": [9.0, 9.0],
    "joint_limits": [[-1.0, 1.0]] * 2, "control_period_s": 0.003, "policy_period_s": 0.018, "delay_steps": 1,
}  # fmt: skip
SEEN = [{"name": "joint_offset", "start": 0, "size": 3, "scale": 1.0, "about": ""}]


def network(change: Callable[[onnx.ModelProto], None] = lambda model: None) -> bytes:
    """Two actions from three numbers, and a change."""
    weights = [numpy_helper.from_array(np.ones((2, 3), np.float32), "w")]
    nodes = [helper.make_node("Gemm", ["obs", "w"], ["actions"], transB=1)]
    wires = [
        helper.make_tensor_value_info(n, TensorProto.FLOAT, ["worlds", k])
        for n, k in (("obs", 3), ("actions", 2))
    ]
    graph = helper.make_graph(nodes, "policy", wires[:1], wires[1:], weights)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    change(model)
    return model.SerializeToString()


def bundle(
    path: Path, policy: bytes | None = None, parts: dict[str, bytes] | None = None, **changes: Any
) -> Path:
    """A bundle whose hashes are right, whatever is in it."""
    own = {"policy.onnx": policy or network(), "machine.xml": b"<mujoco/>", **(parts or {})}
    hashes = {name: hashlib.sha256(data).hexdigest() for name, data in own.items()}
    manifest = {"format": 1, "task": "reach", "variant": "exact", "observations": SEEN, "control": CONTROL}
    manifest |= {"sha256": hashes, **changes}
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in {"bundle.json": json.dumps(manifest).encode(), **own}.items():
            archive.writestr(name, data)
    return path


def refused(path: Path, says: str) -> None:
    with pytest.raises(InputError, match=says) as caught:
        Policy(read_bundle(path))
    assert str(caught.value).isprintable() and caught.value.file == path


def test_an_honest_one_is_read(tmp_path: Path) -> None:
    assert Policy(read_bundle(bundle(tmp_path / "a.zip")))(np.ones(3)).tolist() == [3.0, 3.0]


@pytest.mark.parametrize("name", ["../out", "/tmp/out", "model/../../out", "..\\out", "C:out"])
def test_names_that_lead_out(name: str, tmp_path: Path) -> None:
    refused(bundle(tmp_path / "a.zip", parts={name: b"x"}), "leads out of the bundle")
    assert [p.name for p in tmp_path.iterdir()] == ["a.zip"]


def test_links_and_doubles(tmp_path: Path) -> None:
    with zipfile.ZipFile(bundle(tmp_path / "link.zip"), "a") as archive:
        entry = zipfile.ZipInfo("model/leg.xml")
        entry.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(entry, "/etc/passwd")
    refused(tmp_path / "link.zip", "is a link")
    with zipfile.ZipFile(bundle(tmp_path / "twice.zip"), "a") as archive, pytest.warns(UserWarning):
        archive.writestr("machine.xml", "<mujoco/>")
    refused(tmp_path / "twice.zip", "occurs twice")


def test_what_unpacks_for_ever(tmp_path: Path) -> None:
    with (
        zipfile.ZipFile(tmp_path / "large.zip", "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("bundle.json", "w") as part,
    ):
        for _ in range(300):
            part.write(bytes(2**20))
    refused(tmp_path / "large.zip", "unpacks to more than")
    nameless = bytearray(bundle(tmp_path / "nameless.zip").read_bytes())
    place = nameless.index(b"PK\1\2") + 28  # the length of the first part's name
    nameless[place : place + 2] = b"\0\0"
    (tmp_path / "nameless.zip").write_bytes(nameless)
    refused(tmp_path / "nameless.zip", "not a policy bundle")
    with zipfile.ZipFile(tmp_path / "many.zip", "w") as archive:
        for k in range(1100):
            archive.writestr(str(k), b"")
    refused(tmp_path / "many.zip", "1100 parts")


def test_damage_behind_the_directory(tmp_path: Path) -> None:
    path = bundle(tmp_path / "a.zip")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("bundle.json", b"{}" * 5000)
    raw = bytearray(path.read_bytes())
    raw[45:60] = bytes(15)
    path.write_bytes(raw)
    with pytest.raises((zlib.error, zipfile.BadZipFile)), zipfile.ZipFile(path) as archive:
        archive.read("bundle.json")
    refused(path, "not a policy bundle")


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"control": {**CONTROL, "kp": [1.0]}}, "kp has 1 entries for 2 joints"),
        ({"control": {**CONTROL, "kp": [float("nan"), 1.0]}}, "control.kp.0"),
        ({"control": {**CONTROL, "control_period_s": 0.0}}, "control_period_s"),
        ({"control": []}, "column 'control'"),
        ({"observations": [{**SEEN[0], "size": 10**9}]}, "observations.0.size"),
        ({"sha256": []}, "missing or was changed"),
        ({"task": None}, "column 'task'"),
    ],
)
def test_a_manifest_that_is_not_whole(changes: dict[str, Any], says: str, tmp_path: Path) -> None:
    refused(bundle(tmp_path / "a.zip", **changes), says)


def _external(model: onnx.ModelProto) -> None:
    weights = model.graph.initializer[0]
    weights.ClearField("raw_data")
    weights.data_location = TensorProto.EXTERNAL
    entry = weights.external_data.add()
    entry.key, entry.value = "location", "../../etc/passwd"


def _operator(model: onnx.ModelProto) -> None:
    model.graph.node[0].op_type, model.graph.node[0].domain = "Run", "com.stranger"
    model.opset_import.append(helper.make_opsetid("com.stranger", 1))


def _loop(model: onnx.ModelProto) -> None:
    model.graph.node.append(helper.make_node("ConstantOfShape", ["w"], ["large"]))


def _growing(model: onnx.ModelProto) -> None:
    side = int(np.sqrt(MOST_NUMBERS)) + 1
    for name, shape in (("column", (side, 1)), ("row", (1, side))):
        model.graph.initializer.append(numpy_helper.from_array(np.zeros(shape, np.float32), name))
    model.graph.node.append(helper.make_node("MatMul", ["column", "row"], ["large"]))


def _claims(model: onnx.ModelProto) -> None:
    model.graph.initializer[0].dims[0] = 2**40


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (_external, "in another file"),
        (_operator, "operator 'com.strangerRun'"),
        (_loop, "operator 'ConstantOfShape'"),
        (_growing, "larger than a policy needs"),
        (_claims, r"policy\.onnx"),
    ],
)
def test_networks_that_are_more_than_a_policy(change: Any, says: str, tmp_path: Path) -> None:
    refused(bundle(tmp_path / "a.zip", policy=network(change)), says)


def test_what_is_no_network(tmp_path: Path) -> None:
    refused(bundle(tmp_path / "a.zip", policy=b"\x08\x08noise"), r"policy\.onnx")
    with pytest.raises(InputError, match="larger than"):
        check_network(bytes(2**26 + 1), None)


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ({"model/model.toml": b'format = 1\nname = "x"\nserial = "/etc/hostname"\n'}, "names|MuJoCo|XML"),
        ({"model/model.toml": b'format = 1\nname = "x"\nserial = "../../leg.xml"\n'}, "its model names"),
    ],
)
def test_a_model_that_names_files_elsewhere(parts: dict[str, bytes], says: str, tmp_path: Path) -> None:
    source = Path(__file__).parents[2] / "models" / "serial" / "leg.xml"
    (tmp_path / "leg.xml").write_bytes(source.read_bytes())
    unpacked = tmp_path / "deep" / "er"
    unpacked.mkdir(parents=True)
    (tmp_path / "deep" / "leg.xml").write_bytes(source.read_bytes())
    from workbench.training.tasks import TASKS

    seen = [
        {"name": o.name, "start": 0, "size": 1, "scale": 1.0, "about": ""}
        for o in TASKS["reach"].observations
    ]
    read: PolicyBundle = read_bundle(bundle(tmp_path / "a.zip", parts=parts, observations=seen))
    with pytest.raises(InputError, match=says):
        machine_of(read, unpacked)
