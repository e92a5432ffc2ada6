"""A motor and a load on a spring are recovered from a response, and other responses are refused."""

from __future__ import annotations

import numpy as np
import pytest
from two_mass_fit import fit_two_mass, two_mass_numbers

from tests.frf.machines import leg_recordings
from tests.frf.two_mass import two_mass_frf
from workbench.core import InputError
from workbench.frf import estimate


@pytest.mark.parametrize("load", [False, True])
def test_two_masses_are_recovered(load) -> None:
    theta, frf = two_mass_frf(0.01, load)
    fit = fit_two_mass(frf)
    numbers = two_mass_numbers(fit)
    assert fit.adequate
    assert max(abs(e.value - x) / e.std for e, x in zip(fit.parameters.values(), theta, strict=True)) < 4
    assert numbers["inertia_ratio"].value == pytest.approx(theta[1] / theta[0], rel=0.02)
    assert numbers["antiresonance_hz"].value == pytest.approx(np.sqrt(600 / 0.0053) / (2 * np.pi), rel=1e-3)
    true = np.sqrt(600 * (1 / 0.0053 + 1 / 0.0048)) / (2 * np.pi)
    assert abs(numbers["resonance_hz"].value - true) < 4 * numbers["resonance_hz"].std


def test_responses_of_the_wrong_kind_are_refused() -> None:
    with pytest.raises(InputError, match="a response from") as caught:
        fit_two_mass(estimate(leg_recordings((-0.55, 0.497))))
    assert caught.value.remedy
