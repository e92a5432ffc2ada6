"""What the moving picture needs: links along the measured motion and along the model's."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from workbench.core import Recording
from workbench.models import Model

from .skeleton import Skeleton, facing


@lru_cache(maxsize=4)
def _skeleton(serial: Path) -> Skeleton:
    return Skeleton.of(serial)


def moving_picture(
    model: Model, recording: Recording, runs: Mapping[str, Recording | None]
) -> dict[str, np.ndarray]:
    """Columns of one length, so that they travel as one table.

    Returns:
        ``t`` [s] (T,); of every run and segment six coordinates [m], ``measured_0_0`` to ``after_S_5``;
        ``scene``: number of segments, tip, azimuth [rad], then radii, then zeros.
    """
    skeleton = _skeleton(model.serial)
    times, measured = skeleton.along(model, recording)
    columns: dict[str, np.ndarray] = {"t": times}
    for name, run in {"measured": recording, **runs}.items():
        if run is None:
            continue
        segments = measured if name == "measured" else skeleton.along(model, run)[1]
        flat = segments.reshape(len(times), -1, 6).astype(np.float32)
        for s in range(flat.shape[1]):
            for c in range(6):
                columns[f"{name}_{s}_{c}"] = np.ascontiguousarray(flat[:, s, c])
    scene = np.zeros(len(times))
    facts = [len(skeleton.radius), skeleton.tip, facing(measured), *skeleton.radius]
    scene[: len(facts)] = facts[: len(scene)]
    columns["scene"] = scene
    return columns
