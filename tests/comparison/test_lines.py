"""A rigid model of two masses on a spring fails at the resonance, and the comparison says so (measured)."""

from pathlib import Path

import pytest

from tests.data_helpers import data_folder, write_toml
from workbench.comparison import compare
from workbench.core import Comparison
from workbench.effects import load_model
from workbench.recordings import load_recording

RIGID = """<mujoco model="rigid"><worldbody><body name="a">
<joint name="motor" type="hinge" axis="0 0 1"/>
<inertial pos="0 0 0" mass="1e-9" diaginertia="1e-12 1e-12 1e-12"/></body></worldbody></mujoco>"""


@pytest.fixture(scope="module")
def rigid(tmp_path_factory: pytest.TempPathFactory) -> Comparison:
    folder = tmp_path_factory.mktemp("two_mass")
    table: Path = data_folder("two_mass") / "MultisineTypeA.mat"
    recording = write_toml(
        folder / "two_mass.toml",
        {
            "format": 1,
            "name": "two_mass",
            "table": str(table.resolve()),
            "axes": ["motor"],
            "columns": {
                "time": {"column": "time", "scale": 1e-6},
                "position": "theta_mx",
                "torque_command": "iq_refx",
                "torque_measured": "iq_adx",
            },
            "controller": {"kind": "none"},
            "excitation": {"kind": "multisine", "period_s": 1.0, "f_min_hz": 11.0, "f_max_hz": 250.0},
        },
    )
    (folder / "rigid.xml").write_text(RIGID)
    both_masses = {"inertia": [0.00956], "damping": [0.1]}  # of the two, from a fit to the response
    model = {"format": 1, "name": "rigid", "serial": "rigid.xml", "actuators": both_masses}
    write_toml(folder / "rigid.toml", model)
    return compare(load_model(folder / "rigid.toml"), [load_recording(recording)], draws=2)


def test_a_rigid_model_is_refused(rigid: Comparison) -> None:
    assert not rigid.consistent
    assert rigid.error > 10 * rigid.noise_error


def test_the_resonance_is_named(rigid: Comparison) -> None:
    response = [s for s in rigid.where if s.signal == "response"]
    low, high = response[0].range
    assert low < 77.0 < high and response[0].unit == "Hz"
