"""Resonances and anti-resonances without a model of the whole."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core import InputError
from workbench.frf import find_resonances

from .sure import within
from .two_mass import two_mass_frf


def test_frequencies_dampings_and_intervals() -> None:
    theta, frf = two_mass_frf(0.01, load=False)
    jm, jl, k, c, *_ = theta
    found = find_resonances(frf)
    assert [r.kind for r in found] == ["antiresonance", "resonance"]
    low, high = found
    # damped by the coupling and a little by the bearings
    natural = np.sqrt(k / jl)
    assert abs(low.frequency.value - natural / (2 * np.pi)) < 4 * low.frequency.std + 0.02
    assert low.damping.value == pytest.approx((c + theta[5]) / (2 * jl * natural), abs=4 * low.damping.std)
    assert abs(high.frequency.value - np.sqrt(k * (1 / jm + 1 / jl)) / (2 * np.pi)) < 0.05
    assert 0.001 < high.frequency.std < 0.2


def test_noise_makes_no_resonance() -> None:
    _, frf = two_mass_frf(1.0, load=False)
    assert len(find_resonances(frf, prominence_db=1.0)) <= 4
    with pytest.raises(InputError, match="too few"):
        find_resonances(within(frf, 50, 52))
