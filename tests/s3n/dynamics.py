"""Whether a compiled tree moves as a model does."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.effects import compile_plant
from workbench.models import Model
from workbench.s3n import compiled_dynamics


def states(size: int, count: int = 12) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(1)
    return generator.uniform(-1.5, 1.5, (count, size)), generator.normal(0, 6, (count, size))


def same_dynamics(model: Model, m: mujoco.MjModel, tolerance: float = 1e-12) -> None:
    q, v = states(model.size)
    wanted = compiled_dynamics(compile_plant(model).mujoco, model.joints, q, v)
    found = compiled_dynamics(m, model.joints, q, v)
    for name, value in vars(wanted).items():
        size = max(np.abs(value).max(), 1e-3)
        np.testing.assert_allclose(getattr(found, name), value, rtol=0, atol=tolerance * size, err_msg=name)
