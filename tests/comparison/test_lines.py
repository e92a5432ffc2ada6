"""A rigid model of two masses on a spring fails at the resonance, and the comparison says so (measured)."""

import pytest

from tests.data_helpers import two_mass
from workbench.comparison import compare
from workbench.core import Comparison
from workbench.effects import load_model
from workbench.recordings import load_recording


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Comparison:
    model, recording = two_mass(tmp_path_factory.mktemp("two_mass"))
    return compare(load_model(model), [load_recording(recording)], draws=2)


def test_a_rigid_model_is_refused(rigid: Comparison) -> None:
    assert not rigid.consistent
    assert rigid.error > 10 * rigid.noise_error


def test_the_resonance_is_named(rigid: Comparison) -> None:
    response = [s for s in rigid.where if s.signal == "response"]
    low, high = response[0].range
    assert low < 77.0 < high and response[0].unit == "Hz"
    # the next bands are of the anti-resonance and the resonance, and nowhere else
    assert all(s.range[0] > 45.0 and s.range[1] < 95.0 for s in response)
