"""A mechanism file becomes a model that passes its own check; what is wrong with it becomes one line."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from workbench.core import InputError, Mechanism
from workbench.core.paths import closed_chain_file
from workbench.importing import Drives, contents_of, import_model
from workbench.models import read_model
from workbench.verification import verify

LEG = Mechanism(closed_chain_file("leg"), limits=((-1.6, 1.6), (0.35, 2.6)))
MOTORS = Drives((9.0, 9.0), (2e-4, 2e-4), (1.2e-3, 1.2e-3), (24.0, 24.0))


def urdf_of_a_leg() -> str:
    """A parallelogram in URDF, written out by hand: thigh 0.2, shank 0.25 with a rear arm of 0.05."""

    def link(name: str, z: float, mass: float, about: float) -> str:
        inertia = f'ixx="{about}" iyy="{about}" izz="{about / 10}" ixy="0" ixz="0" iyz="0"'
        return (
            f'<link name="{name}"><inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>'
            f"<inertia {inertia}/></inertial></link>"
        )

    def joint(name: str, parent: str, child: str, z: float) -> str:
        return (
            f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0 0 {z}"/><axis xyz="0 -1 0"/>'
            '<limit lower="-1.5" upper="1.5" effort="20" velocity="30"/></joint>'
        )

    def tip(name: str, parent: str, z: float) -> str:
        return (
            f'<link name="{name}"/><joint name="{name}_weld" type="fixed"><parent link="{parent}"/>'
            f'<child link="{name}"/><origin xyz="0 0 {z}"/></joint>'
        )

    parts = [
        '<link name="world"/>',
        link("thigh", -0.1, 1.1, 0.004),
        link("shank", -0.08, 0.3, 0.002),
        link("crank", 0.02, 0.08, 1e-4),
        link("rod", -0.1, 0.06, 2e-4),
        joint("hip", "world", "thigh", 0.0),
        joint("motor", "world", "crank", 0.0),
        joint("knee", "thigh", "shank", -0.2),
        joint("rod_pin", "crank", "rod", 0.05),
        tip("rod_end", "rod", -0.2),
        tip("arm_end", "shank", 0.05),
        tip("toe", "shank", -0.25),
    ]
    return f'<robot name="own">{"".join(parts)}</robot>'


def test_the_reference_leg_comes_back_with_nothing_typed(tmp_path: Path) -> None:
    model = import_model(LEG, MOTORS, tmp_path / "own.toml", axes=("hip", "knee"))
    assert np.array_equal(model.transmission, [[1, 0], [1, 1]])
    assert model.actuators.inertia == pytest.approx((0.0162, 0.0162))
    assert model.linkage is not None
    np.testing.assert_allclose(model.linkage.M12, -0.05 * 0.0875 * 0.06)
    # its tree has all of thigh and shank; the shipped one lacks some of the shank, but not the crank
    shipped = read_model("leg").linkage
    assert model.linkage.crank is not None and shipped is not None and shipped.crank is not None
    for key, value in vars(model.linkage.crank).items():
        assert value == pytest.approx(getattr(shipped.crank, key), rel=1e-6), key
        assert value == getattr(model.linkage, key)
    read = read_model(tmp_path / "own.toml")
    assert verify(read, samples=10).passed


def test_a_leg_in_urdf(tmp_path: Path) -> None:
    file = tmp_path / "own.urdf"
    file.write_text(urdf_of_a_leg())
    contents = contents_of(file)
    assert {"hip", "motor", "knee", "rod_pin"} <= set(contents.joints) and "toe" in contents.frames
    mechanism = Mechanism(
        file,
        ("hip", "motor"),
        ("hip", "knee"),
        (("rod_end", "arm_end"),),
        "toe",
        limits=((-1, 1), (0.3, 1.4)),
    )
    import_model(mechanism, MOTORS, tmp_path / "own.toml")
    model = read_model(tmp_path / "own.toml")
    assert model.linkage is not None
    np.testing.assert_allclose(model.linkage.M11, 0.06 * 0.1**2 + 2e-4)
    assert verify(model, samples=10).passed


def test_a_mechanism_whose_transmission_changes(tmp_path: Path) -> None:
    known = read_model("four_bar").closed_chain
    assert known is not None
    model = import_model(known, MOTORS, tmp_path / "bent.toml")
    assert model.posture_dependent and model.linkage is None
    assert read_model(tmp_path / "bent.toml").posture_dependent


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"joints": ("hip", "coupler_pin")}, "the way to foot"),
        ({"drives": ("hip", "motor")}, "motor"),
        ({"loops": ()}, "degrees of freedom"),
        ({"loops": (("coupler_end", "nowhere"),)}, "nowhere"),
        ({"foot": "toe"}, "toe"),
    ],
)
def test_what_does_not_fit_is_said(tmp_path: Path, change: dict[str, object], told: str) -> None:
    with pytest.raises(InputError, match=told):
        import_model(replace(LEG, **change), MOTORS, tmp_path / "own.toml")
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "own.xml").write_text("mine")
    with pytest.raises(InputError):
        import_model(LEG, MOTORS, tmp_path / "own.toml")
    assert (tmp_path / "own.xml").read_text() == "mine" and not (tmp_path / "own.toml").exists()
