"""A network of a stranger, looked through before it runs: a small feed-forward policy and nothing else."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from workbench.core import InputError

MOST_BYTES = 64 * 2**20
MOST_NUMBERS = 2**24  # of one tensor, a row of the batch
#: What a layer may be; none of these reads a file, runs a loop, or makes a tensor of a size that data say.
OPERATORS = frozenset(
    ("Add", "Clip", "Div", "Elu", "Gemm", "Identity", "LeakyRelu", "MatMul", "Mul", "Relu", "Selu", "Sigmoid",
     "Softplus", "Softsign", "Sub", "Tanh")
)  # fmt: skip
_REMEDY = "export the policy again"


def check_network(raw: bytes, file: Path | None) -> None:
    """Look through an ONNX file.

    Raises:
        InputError: no ONNX; too large; weights in other files; operators that are not ONNX's own or that no
            policy needs; tensors that would grow beyond all bounds.
    """
    import onnx
    from google.protobuf.message import DecodeError

    def refuse(problem: str) -> InputError:
        return InputError(f"policy.onnx {problem}", file=file, remedy=_REMEDY)

    if len(raw) > MOST_BYTES:
        raise refuse(f"is larger than {MOST_BYTES >> 20} MiB")
    try:
        model = onnx.load_model_from_string(raw)
    except (DecodeError, ValueError) as error:
        raise refuse("is no ONNX file") from error
    if model.functions or model.training_info or model.graph.sparse_initializer:
        raise refuse("holds more than a network")
    for node in model.graph.node:
        if node.domain not in ("", "ai.onnx") or node.op_type not in OPERATORS:
            raise refuse(f"uses the operator '{node.domain}{node.op_type}', which no policy needs")
    for weights in model.graph.initializer:
        if weights.data_location == onnx.TensorProto.EXTERNAL or weights.external_data:
            raise refuse(f"has the weights '{weights.name}' in another file")
    try:
        onnx.checker.check_model(model)
        inferred = onnx.shape_inference.infer_shapes(model, check_type=True, strict_mode=True)
    except Exception as error:  # the checker's and the inference's errors have no common root
        raise refuse(
            f"is not a readable network: {str(error).splitlines()[0] if str(error) else 'damaged'}"
        ) from error
    for value in (*inferred.graph.value_info, *inferred.graph.input, *inferred.graph.output):
        if not _bounded(value):
            raise refuse(f"makes '{value.name}' larger than a policy needs")
    for weights in model.graph.initializer:
        if math.prod(weights.dims) > MOST_NUMBERS:
            raise refuse(f"states more weights than a policy needs in '{weights.name}'")


def _bounded(value: Any) -> bool:
    """Whether a tensor has at most two dimensions (rows of the batch, numbers), and those within bounds."""
    shape = value.type.tensor_type.shape.dim
    return len(shape) <= 2 and math.prod(d.dim_value for d in shape if d.dim_value > 0) <= MOST_NUMBERS
