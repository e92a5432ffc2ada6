"""Legs made for tests of S3N."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.effects import load_model
from workbench.models import Model

HOLD = np.array([-0.55, np.pi / 3])  # joint coordinates of the leg [rad]


def leg_with_linkage(**increments: float) -> Model:
    """The reference leg, Kin-Only, with some increments of its linkage multiplied by a factor."""
    model = load_model("leg_kin_only")
    assert model.linkage is not None
    changed = {name: getattr(model.linkage, name) * factor for name, factor in increments.items()}
    return replace(model, linkage=replace(model.linkage, **changed))


def chirp_torque(rows: int = 400, period: float = 0.003) -> np.ndarray:
    """Torque that swings both drives about the hold posture, (rows, 2) [N m]."""
    t = np.arange(rows) * period
    swing = np.sin(2 * np.pi * (2.0 + 2.0 * t) * t)
    weight = np.array([1.85, 0.274]) * np.sin([HOLD[0], HOLD.sum()])
    return weight + np.stack([1.5 * swing, 0.7 * swing[::-1]], axis=1)
