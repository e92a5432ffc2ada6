"""Makes a policy bundle from the folder of a run: the network as ONNX, and everything that it needs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from workbench.bundle import write_bundle
from workbench.core import InputError, SimulationError

from .folder import CHECKPOINT, CONFIG, MJCF, MODEL

_EPS = 1e-2  # rsl_rl's EmpiricalNormalization adds it to the deviation
_SAME = 1e-6  # ONNX against torch, relative to an action of 1 and above
_OPSET = 17
#: Entries of a run's configuration that go with its policy.
_OF_POLICY = "task", "variant", "observations", "control", "model", "record"
_OF_TRAINING = "settings", "rewards", "versions", "processes"


def export(run: str | Path, path: str | Path, *, force: bool = False) -> Path:
    """Write the policy of a run's last checkpoint as a bundle.

    Raises:
        InputError: the folder holds no run, or the file exists and `force` is not set.
        SimulationError: the ONNX network gives other actions than torch.
    """
    from .checkpoint import load

    folder = Path(run)
    try:
        config = json.loads((folder / CONFIG).read_text(encoding="utf-8"))
        machine = (folder / MJCF).read_text(encoding="utf-8")
    except (OSError, ValueError, RecursionError) as error:
        raise InputError("no run here", file=folder, remedy="name a folder of `workbench train`") from error
    if not isinstance(config, dict):
        raise InputError("no run here", file=folder / CONFIG, remedy="name a folder of `workbench train`")
    checkpoint = load(folder / CHECKPOINT, "cpu")
    try:
        actor = {k: v.numpy() for k, v in checkpoint["learner"]["actor_state_dict"].items()}
        iterations, seconds = int(checkpoint["iteration"]), float(checkpoint["seconds"])
        if bad := next((k for k, v in actor.items() if not np.isfinite(v).all()), None):
            raise ValueError(f"'{bad}' is not finite")
        policy = to_onnx(actor)
        with np.errstate(over="raise", invalid="raise"):
            difference = compare_with_torch(policy, actor)
    except Exception as error:  # weights of no network: numpy, torch and ONNX each say so in their own way
        raise InputError(
            f"the checkpoint holds no policy: {error}", file=folder / CHECKPOINT, remedy="train again"
        ) from error
    if missing := [key for key in (*_OF_POLICY, *_OF_TRAINING) if key not in config]:
        raise InputError("is missing", file=folder / CONFIG, column=missing[0], remedy="train again")
    if not difference <= _SAME:
        raise SimulationError(f"the exported network differs from the trained one by {difference:.1e}")
    manifest = {
        **{key: config[key] for key in _OF_POLICY},
        "normalisation": {
            "mean": actor["obs_normalizer._mean"].ravel().tolist(),
            "std": (actor["obs_normalizer._std"].ravel() + _EPS).tolist(),
            "about": "inside the network: (observation - mean) / std",
        },
        "training": {
            **{key: config[key] for key in _OF_TRAINING},
            "iterations": iterations,
            "seconds": seconds,
            "onnx_against_torch": difference,
        },
    }
    files = {
        f"model/{f.relative_to(folder / MODEL).as_posix()}": f.read_bytes() for f in _files(folder / MODEL)
    }
    return write_bundle(path, manifest, policy, machine, files, force=force)


def _files(folder: Path) -> list[Path]:
    return sorted(f for f in folder.rglob("*") if f.is_file())


def layers(actor: dict[str, np.ndarray]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return weight (out, in) and bias (out,) of each layer, in order."""
    numbers = sorted(int(k.split(".")[1]) for k in actor if k.startswith("mlp.") and k.endswith(".weight"))
    return [(actor[f"mlp.{i}.weight"], actor[f"mlp.{i}.bias"]) for i in numbers]


def to_onnx(actor: dict[str, np.ndarray]) -> bytes:
    """Return the deterministic policy of an rsl_rl actor as one ONNX file: normalisation, then layers
    with ELU.
    """
    from onnx import TensorProto, checker, helper, numpy_helper

    mean, std = actor["obs_normalizer._mean"], actor["obs_normalizer._std"]
    stack = layers(actor)
    constants: dict[str, Any] = {"mean": mean, "std": std + np.float32(_EPS)}
    nodes = [helper.make_node("Sub", ["obs", "mean"], ["shifted"])]
    nodes.append(helper.make_node("Div", ["shifted", "std"], ["x0"]))
    for i, (weight, bias) in enumerate(stack):
        constants |= {f"w{i}": weight, f"b{i}": bias}
        last = i == len(stack) - 1
        out = "actions" if last else f"y{i}"
        nodes.append(helper.make_node("Gemm", [f"x{i}", f"w{i}", f"b{i}"], [out], transB=1))
        if not last:
            nodes.append(helper.make_node("Elu", [out], [f"x{i + 1}"], alpha=1.0))

    def wire(name: str, size: int) -> Any:
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, ["worlds", size])

    graph = helper.make_graph(
        nodes, "policy", [wire("obs", mean.shape[-1])], [wire("actions", stack[-1][0].shape[0])],
        [numpy_helper.from_array(np.asarray(v, np.float32), k) for k, v in constants.items()],
    )  # fmt: skip
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", _OPSET)], ir_version=8)
    checker.check_model(model)
    return model.SerializeToString()


def compare_with_torch(policy: bytes, actor: dict[str, np.ndarray]) -> float:
    """Return the largest difference between ONNX Runtime and torch, relative to the largest action of an
    observation.
    """
    import onnxruntime
    import torch

    generator = torch.Generator().manual_seed(0)
    tensors = {k: torch.from_numpy(v) for k, v in actor.items()}
    mean, std = tensors["obs_normalizer._mean"], tensors["obs_normalizer._std"]
    seen = mean + std * torch.randn((256, mean.shape[-1]), generator=generator)
    x = (seen - mean) / (std + _EPS)
    stack = layers(actor)
    for i, (weight, bias) in enumerate(stack):
        x = torch.nn.functional.linear(x, torch.from_numpy(weight), torch.from_numpy(bias))
        x = x if i == len(stack) - 1 else torch.nn.functional.elu(x)
    session = onnxruntime.InferenceSession(policy, providers=["CPUExecutionProvider"])
    found = np.asarray(session.run(None, {"obs": seen.numpy()})[0])
    wanted = x.numpy()
    return float((np.abs(found - wanted) / np.maximum(1.0, np.abs(wanted).max(axis=1, keepdims=True))).max())
