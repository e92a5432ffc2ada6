"""Many postures: recordings grouped by posture, one response for each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import Recording

from .estimate import estimate
from .response import Frf

_NEAR = 0.05  # of one posture, on every axis, from the first of its recordings [rad or m]


def group_by_posture(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """Return groups of recordings whose mean positions agree, in order of the postures' first appearance.

    Args:
        recordings: with the same axes.
    """
    groups: list[tuple[np.ndarray, list[Recording]]] = []
    for recording in recordings:
        mean = recording.position[recording.valid].mean(axis=0)
        for posture, members in groups:
            if posture.shape == mean.shape and np.abs(mean - posture).max() <= _NEAR:
                members.append(recording)
                break
        else:
            groups.append((mean, [recording]))
    return [members for _, members in groups]


def estimate_postures(recordings: Sequence[Recording], **options: object) -> list[Frf]:
    """Return one response per posture; `options` are those of `estimate`.

    Raises:
        InputError: as `estimate`, for any of the postures.
    """
    return [estimate(group, **options) for group in group_by_posture(recordings)]  # type: ignore[arg-type]
