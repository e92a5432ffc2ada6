"""Two inertias on a flexible coupling, measured: resonance, anti-resonance, inertia ratio."""

from __future__ import annotations

import numpy as np
import pytest
from two_mass_fit import fit_two_mass, two_mass_numbers

from workbench.frf import estimate, find_resonances
from workbench.recordings import load_recording

from ..data_helpers import two_mass_recording, write_toml


@pytest.fixture(scope="module")
def frf(tmp_path_factory):
    toml = write_toml(tmp_path_factory.mktemp("two_mass") / "two_mass.toml", two_mass_recording())
    return estimate([load_recording(toml)], input="current", output=("position", "link_position"))


def test_lines_and_periods(frf) -> None:
    assert frf.frequency == pytest.approx(np.arange(11.0, 251.0))
    assert 15 <= frf.periods <= 20 and frf.hold_s is None
    assert np.median(frf.coherence[:100]) > 0.99


def test_resonance_and_antiresonance(frf) -> None:
    low, high = (
        next(r for r in find_resonances(frf) if r.kind == kind and 40 < r.frequency.value < 100)
        for kind in ("antiresonance", "resonance")
    )
    assert low.frequency.value == pytest.approx(53.0, abs=1.5)
    assert high.frequency.value == pytest.approx(77.0, abs=1.5)
    assert 0 < low.frequency.std < 0.5 and 0 < high.frequency.std < 0.5
    # seen from the motor the squared ratio of the two is 1 + J_load / J_motor
    ratio = (high.frequency.value / low.frequency.value) ** 2
    assert ratio - 1 == pytest.approx(1.1, abs=0.1)
    # the load's own response has the resonance and no anti-resonance
    assert [r.kind for r in find_resonances(frf, output=1) if 40 < r.frequency.value < 100] == ["resonance"]


def test_a_two_mass_model_of_it(frf) -> None:
    for chosen in (frf.select(["position_motor"], ["motor"]), frf):
        fit = fit_two_mass(chosen)
        assert two_mass_numbers(fit)["antiresonance_hz"].value == pytest.approx(53.0, abs=1.5)
        assert two_mass_numbers(fit)["resonance_hz"].value == pytest.approx(77.0, abs=1.5)
        # 1.11 from the lines of 1 Hz at which the response is least and most; less between the lines
        assert two_mass_numbers(fit)["inertia_ratio"].value == pytest.approx(1.1, rel=0.15)
        # the bearings' friction distorts in the same way every period: the fit says that it is not all
        assert not fit.adequate
        assert fit.parameters["stiffness"].unit == "A/rad"
