from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.core import Comparison, Diagnosis, Improvement, Recording

from . import build


@pytest.fixture(scope="session")
def improvement() -> Improvement:
    return build.improvement()


@pytest.fixture(scope="session")
def diagnosis(improvement: Improvement) -> Diagnosis:
    assert improvement.diagnosis
    return improvement.diagnosis


@pytest.fixture(scope="session")
def comparison(improvement: Improvement) -> Comparison:
    assert improvement.before
    return improvement.before


@pytest.fixture(scope="session")
def without_torque(comparison: Comparison) -> Comparison:
    """The same recordings on a rig that measures no torque."""

    def strip(r: Recording) -> Recording:
        return replace(r, signals={k: v for k, v in r.signals.items() if not k.startswith("torque")})

    entries = tuple(
        replace(
            e, recording=strip(e.recording), torque_rmse=np.full(2, np.nan), torque_noise=np.full(2, np.nan)
        )
        for e in comparison.recordings
    )
    return replace(comparison, recordings=entries, inverse_dynamics=None)
