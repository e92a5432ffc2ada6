"""Data of the moving picture: links along the measured motion and along that of the model."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from workbench.core import DriveMap, Recording
from workbench.models import Model
from workbench.models.skeleton import Skeleton, facing
from workbench.s3n import drive_map

#: Runs that were drawn last: a measured motion stays while the model's moves.
_LAST: deque[tuple[Recording, Path, tuple[np.ndarray, np.ndarray]]] = deque(maxlen=6)


@lru_cache(maxsize=4)
def _skeleton(serial: Path) -> Skeleton:
    return Skeleton.of(serial)


_MAPS: dict[Path, DriveMap] = {}


def _map(model: Model) -> DriveMap | None:
    """How joints follow the drives where that changes with the posture; of a file, found once."""
    if model.posture_dependent and model.serial not in _MAPS:
        found = drive_map(model)
        assert found is not None
        _MAPS[model.serial] = found
    return _MAPS.get(model.serial)


def _along(model: Model, run: Recording) -> tuple[np.ndarray, np.ndarray]:
    """The segments along a run; of the last few, remembered."""
    for known, serial, found in _LAST:
        if known is run and serial == model.serial:
            return found
    own = _map(model) if run.coordinates == "actuator" else None
    segments = _skeleton(model.serial).along(model, run, None if own is None else own.joints)
    _LAST.append((run, model.serial, segments))
    return _LAST[-1][2]


def moving_picture(
    model: Model, recording: Recording, runs: Mapping[str, Recording | None]
) -> dict[str, np.ndarray]:
    """Return columns of equal length, so that they can be sent as one table.

    Returns:
        ``t`` [s] (T,); of every run and segment six coordinates [m], ``measured_0_0`` to ``after_S_5``;
        ``scene``: number of segments, tip, azimuth [rad], then radii, then zeros.
    """
    skeleton = _skeleton(model.serial)
    times, measured = _along(model, recording)
    columns: dict[str, np.ndarray] = {"t": times}
    for name, run in {"measured": recording, **runs}.items():
        if run is None:
            continue
        segments = _along(model, run)[1]
        flat = segments.reshape(len(times), -1, 6).astype(np.float32)
        for s in range(flat.shape[1]):
            for c in range(6):
                columns[f"{name}_{s}_{c}"] = np.ascontiguousarray(flat[:, s, c])
    scene = np.zeros(len(times))
    facts = [len(skeleton.radius), skeleton.tip, facing(measured), *skeleton.radius]
    scene[: len(facts)] = facts[: len(scene)]
    columns["scene"] = scene
    return columns
