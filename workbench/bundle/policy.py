"""A policy at work: observation in, action out, through ONNX Runtime on one core."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError

from .bundle import PolicyBundle
from .network import check_network


class Policy:
    """The network of a bundle.

    Args:
        bundle: where it comes from.

    Raises:
        InputError: ONNX Runtime is not installed, the network is more than a policy needs (see
            `check_network`), or it has other sizes than the bundle says.
    """

    def __init__(self, bundle: PolicyBundle) -> None:
        try:
            import onnx  # noqa: F401
            import onnxruntime
        except ImportError as error:
            raise InputError(
                "policies need ONNX Runtime",
                remedy="install the extra: pip install 'robot-workbench[training]'",
            ) from error
        check_network(bundle.policy, bundle.source)
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        options.log_severity_level = 4  # what is wrong becomes an error
        try:
            self._session = onnxruntime.InferenceSession(bundle.policy, options, ["CPUExecutionProvider"])
        except Exception as error:  # ONNX Runtime's errors have no common root but this
            raise InputError(f"ONNX Runtime cannot load the network: {error}", file=bundle.source) from error
        self.size = sum(entry.size for entry in bundle.observations)
        inputs, outputs = self._session.get_inputs(), self._session.get_outputs()
        if len(inputs) != 1 or len(outputs) != 1:
            problem = f"the network has {len(inputs)} inputs and {len(outputs)} outputs, not one each"
            raise InputError(problem, file=bundle.source)
        shapes = inputs[0].shape, outputs[0].shape
        sizes = tuple(shape[-1] if len(shape) == 2 else None for shape in shapes)
        if sizes != (self.size, len(bundle.control.joints)) or inputs[0].type != "tensor(float)":
            raise InputError(
                f"the network takes {sizes[0]} numbers of type {inputs[0].type} and returns {sizes[1]}",
                file=bundle.source, remedy="export the policy again",
            )  # fmt: skip
        self._name = self._session.get_inputs()[0].name

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        """Actions (W, n) for observations (W, k), or (n,) for (k,)."""
        rows = np.atleast_2d(np.asarray(observation, np.float32))
        out = np.asarray(self._session.run(None, {self._name: rows})[0], float)
        return out if np.ndim(observation) == 2 else out[0]
