from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from workbench.rigs import VirtualLeg, demo_experiments
from workbench.rigs.hidden import HiddenEffect

pytest.importorskip("panel")

FRICTION = 0.25  # N m, of the knee's drive


@pytest.fixture(scope="session")
def leg_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A few seconds of a leg that hides friction: ``slow.toml`` and ``validation.toml``."""
    folder = tmp_path_factory.mktemp("leg")
    short = [
        replace(e, reference=e.reference[:3000], feedforward=e.feedforward[:3000])
        for e in demo_experiments(0)
        if e.name in ("slow", "validation")
    ]
    hidden = HiddenEffect("coulomb_friction", "knee", parameters={"torque": FRICTION})
    VirtualLeg((hidden,), seed=0).record_to(folder, short)
    return folder
