"""A policy at work: observation in, action out, through ONNX Runtime on one core."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError

from .bundle import PolicyBundle


class Policy:
    """The network of a bundle.

    Args:
        bundle: where it comes from.

    Raises:
        InputError: ONNX Runtime is not installed, or the network has other sizes than the bundle says.
    """

    def __init__(self, bundle: PolicyBundle) -> None:
        try:
            import onnxruntime
        except ImportError as error:
            raise InputError(
                "policies need ONNX Runtime", remedy="install the extra: pip install 'workbench[training]'"
            ) from error
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = options.inter_op_num_threads = 1
        self._session = onnxruntime.InferenceSession(bundle.policy, options, ["CPUExecutionProvider"])
        self.size = sum(entry.size for entry in bundle.observations)
        sizes = self._session.get_inputs()[0].shape[-1], self._session.get_outputs()[0].shape[-1]
        if sizes != (self.size, len(bundle.control.joints)):
            raise InputError(f"the network has {sizes[0]} inputs and {sizes[1]} outputs", file=bundle.source)
        self._name = self._session.get_inputs()[0].name

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        """Actions (W, n) for observations (W, k), or (n,) for (k,)."""
        rows = np.atleast_2d(np.asarray(observation, np.float32))
        out = np.asarray(self._session.run(None, {self._name: rows})[0], float)
        return out if np.ndim(observation) == 2 else out[0]
