"""Other kinds than two cranks: one drive alone, which pushes along a line, on a link that turns."""

from pathlib import Path

import numpy as np
import pytest

from workbench.core import Mechanism
from workbench.mechanism import ClosedChain, simulate

from .chains import simulate_discrete

PIVOT, REST, ARM = 0.2, 0.15, 0.05  # m: shoulder to cylinder's pin, cylinder, elbow to rod's end
BOX = "<inertial><mass>{}</mass><inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-3</izz></inertia></inertial>"
SDF = f"""<sdf version="1.9"><model name="boom">
  <link name="boom">{BOX.format(2)}</link>
  <link name="cylinder"><pose>0 0 {-PIVOT} 0 0 0</pose>{BOX.format(0.4)}</link>
  <link name="rod"><pose relative_to="cylinder">0 0 {REST} 0 0 0</pose>{BOX.format(0.3)}</link>
  <joint name="pitch" type="revolute"><parent>world</parent><child>boom</child>
    <axis><xyz>0 -1 0</xyz></axis></joint>
  <joint name="pin" type="revolute"><parent>world</parent><child>cylinder</child>
    <axis><xyz>0 -1 0</xyz></axis></joint>
  <joint name="stroke" type="prismatic"><parent>cylinder</parent><child>rod</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <frame name="eye" attached_to="boom"><pose>{ARM} 0 0 0 0 0</pose></frame>
</model></sdf>"""


@pytest.fixture(scope="module")
def boom(tmp_path_factory: pytest.TempPathFactory) -> Mechanism:
    file: Path = tmp_path_factory.mktemp("sdf") / "boom.sdf"
    file.write_text(SDF)
    start = (("pin", -0.24), ("stroke", 0.06))
    return Mechanism(file, ("stroke",), ("pitch",), (("rod", "eye"),), "eye", start, ((-0.8, 0.8),))


@pytest.mark.parametrize("pitch", [-0.8, 0.0, 0.7])
def test_the_law_of_cosines(boom: Mechanism, pitch: float) -> None:
    """The eye is at ARM (cos, sin); its distance from the pin below is cylinder and stroke."""
    chain = ClosedChain(boom)
    length = np.sqrt(PIVOT**2 + ARM**2 + 2 * PIVOT * ARM * np.sin(pitch))
    at = np.array([pitch])
    np.testing.assert_allclose(chain.drive_position(at), [length - REST], atol=1e-12)
    np.testing.assert_allclose(chain.jacobian(at), [[PIVOT * ARM * np.cos(pitch) / length]], atol=1e-12)


def test_continuous_and_discrete_motion_agree(boom: Mechanism) -> None:
    """The drive's inertia is a mass [kg], its torque a force [N]."""
    chain, force = ClosedChain(boom), np.full((100, 1), 12.0)
    q0 = chain.drive_position(np.zeros(1))
    exact = simulate(chain, [5.0], [20.0], force, 1e-3, q0)
    discrete = simulate_discrete(boom, [5.0], [20.0], force, 1e-3, q0)
    assert np.ptp(exact.position) > 0.002
    np.testing.assert_allclose(discrete.position, exact.position, atol=1e-4)  # first order in the step
