"""A mechanism file becomes a model that passes its own check; what is wrong with it becomes one line."""

import json
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.cli.here import run
from tests.importing.leg_urdf import urdf_of_a_leg
from tests.mechanism.chains import open_loop
from workbench.core import InputError, Mechanism
from workbench.core.paths import closed_chain_file
from workbench.importing import Drives, contents_of, import_model
from workbench.mechanism import ClosedChain
from workbench.models import read_model
from workbench.s3n import compiled_dynamics
from workbench.verification import verify

LEG = Mechanism(closed_chain_file("leg"), limits=((-1.6, 1.6), (0.35, 2.6)))
MOTORS = Drives((9.0, 9.0), (2e-4, 2e-4), (1.2e-3, 1.2e-3), (24.0, 24.0))


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


def test_friction_below_zero_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "own.urdf"
    file.write_text(urdf_of_a_leg(dynamics='<dynamics friction="-0.1"/>'))
    with pytest.raises(InputError, match="joint 'hip' has a friction of"):
        contents_of(file)


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


_BARS = """<sdf version="1.9"><model name="bars">{links}
<joint name="hip" type="revolute"><parent>world</parent><child>thigh</child>{axis}</joint>
<joint name="knee" type="revolute"><parent>thigh</parent><child>shank</child>{axis}</joint>
<joint name="crank" type="revolute"><parent>world</parent><child>lever</child>{axis}</joint>
<joint name="pin" type="revolute"><parent>lever</parent><child>rod</child>{axis}</joint>
<frame name="below" attached_to="rod"><pose>0 0 -0.20 0 0 0</pose></frame>
<frame name="heel" attached_to="shank"><pose>0.01 0 0.05 0 0 0</pose></frame></model></sdf>"""


_BARS_MJCF = """<mujoco><compiler angle="radian"/><default><joint axis="0 -1 0"/></default><worldbody>
<body><joint name="hip"/><inertial pos="0 0 -0.1" mass="0.4" diaginertia="2e-3 2e-3 2e-3"/>
<body pos="0 0 -0.22"><joint name="knee"/><inertial pos="0 0 -0.1" mass="0.4" diaginertia="2e-3 2e-3 2e-3"/>
<site name="toe" pos="0 0 -0.25"/><site name="heel" pos="0.01 0 0.05"/></body></body>
<body><joint name="crank"/><inertial pos="0 0 -0.1" mass="0.4" diaginertia="2e-3 2e-3 2e-3"/>
<body pos="0 0 0.045"><joint name="pin"/><inertial pos="0 0 -0.1" mass="0.4" diaginertia="2e-3 2e-3 2e-3"/>
<site name="below" pos="0 0 -0.2"/></body></body></worldbody>
<equality><connect site1="below" site2="heel"/></equality>
<keyframe><key qpos="{keyframe}"/></keyframe></mujoco>"""


def unequal_bars(folder: Path) -> Path:
    """A four-bar leg whose bars are of unequal lengths, so that it can be put together in two ways."""
    links = ""
    placed = ("thigh", "", 0.0), ("shank", "thigh", -0.22), ("lever", "", 0.0), ("rod", "lever", 0.045)
    for name, above, z in placed:
        relative = f' relative_to="{above}"' if above else ""
        inertia = "".join(f"<{key}>0.002</{key}>" for key in ("ixx", "iyy", "izz"))
        links += (
            f'<link name="{name}"><pose{relative}>0 0 {z} 0 0 0</pose><inertial><pose>0 0 -0.1 0 0 0</pose>'
        )
        links += f"<mass>0.4</mass><inertia>{inertia}</inertia></inertial></link>"
    file = folder / "bars.sdf"
    file.write_text(_BARS.format(links=links, axis="<axis><xyz>0 -1 0</xyz></axis>"))
    return file


@pytest.mark.parametrize("crank", [1.0, -1.5])
def test_the_start_chooses_the_way_to_put_a_leg_together(tmp_path: Path, crank: float) -> None:
    file = unequal_bars(tmp_path)
    words = [
        "--drive",
        "hip",
        "--drive",
        "crank",
        "--joint",
        "hip",
        "--joint",
        "knee",
        "--loop",
        "below:heel",
    ]
    words += ["--limits", "hip=-0.5:0.5", "--limits", "knee=0.6:1.6"]
    words += ["--start", "knee=1", "--start", f"crank={crank}"]
    done = run("import", file, *words, "-o", "own.toml", "--json", "own.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "close in 2 ways" in done.stdout
    assert f"As asked, the loops are closed near knee = 1, crank = {crank:.3g}: at" in done.stdout
    model = read_model(tmp_path / "own.toml")
    assert model.closed_chain is not None
    chain = ClosedChain(model.closed_chain)
    at = chain.drive_position(np.array([0.0, 1.1]))
    # the rod's ends are where the two bars have them, and the crank lies on the side that was asked for
    assert np.sign(at[1]) == np.sign(crank)
    assert open_loop(chain, at) < 1e-9
    told = json.loads((tmp_path / "own.json").read_text())["assemblies"]
    at = chain.drive_position(np.array(list(told["joints"].values())))
    (other,) = told["others"]
    assert told["own"]["crank"] == pytest.approx(at[1]) and np.sign(other["crank"]) == -np.sign(crank)
    # what is told chooses it
    chosen = replace(model.closed_chain, start=(*told["joints"].items(), ("crank", other["crank"])))
    again = ClosedChain(chosen).drive_position(np.array(list(told["joints"].values())))
    assert again[1] == pytest.approx(other["crank"])


def test_a_start_that_is_no_closed_posture_is_told(tmp_path: Path) -> None:
    asked = (("hip", 0.0), ("knee", 1.0), ("crank", 0.1))
    bars = Mechanism(
        unequal_bars(tmp_path), ("hip", "crank"), ("hip", "knee"), (("below", "heel"),), None, start=asked
    )
    told = list[str]()
    import_model(bars, MOTORS, tmp_path / "own.toml", tell_start=told.append)
    (said,) = told
    assert said.startswith("no closed posture is near hip = 0, knee = 1, crank = 0.1; the nearest has hip = ")


@pytest.mark.parametrize("crank", [1.2, -1.6])
def test_the_start_goes_before_the_keyframe_of_an_mjcf(tmp_path: Path, crank: float) -> None:
    sides = {1.2: ("0.0 1.1 1.3110 -1.2936", -1.6), -1.6: ("0.0 1.1 -1.7296 1.2936", 1.2)}
    keyframe, other = sides[crank]
    file = tmp_path / "bars.xml"
    file.write_text(_BARS_MJCF.format(keyframe=keyframe))
    for asked, side in (((), crank), ((("crank", other),), other)):
        bars = Mechanism(
            file, ("hip", "crank"), ("hip", "knee"), (), "toe", start=asked, limits=((-0.5, 0.5), (0.8, 1.6))
        )
        model = import_model(bars, MOTORS, tmp_path / "own.toml", force=True)
        assert model.closed_chain is not None
        chain = ClosedChain(replace(model.closed_chain, file=tmp_path / "own.sdf"))
        assert np.sign(chain.drive_position(np.array([0.0, 1.1]))[1]) == np.sign(side)


def test_what_import_made_is_normalised_and_agrees_with_check(tmp_path: Path) -> None:
    model = import_model(LEG, MOTORS, tmp_path / "own.toml")
    done = run("normalize", tmp_path / "own.toml", "-o", tmp_path / "n.xml", "--json", tmp_path / "n.json")
    said = " ".join(done.stdout.split())
    assert done.returncode == 0 and "variant s3n_full" in said
    assert "leaves out the linkage's weight (g1" in said and "Exact" not in said
    told = json.loads((tmp_path / "n.json").read_text())
    assert told["variant"] == "s3n_full" and len(told["variant_leaves_out"]) == 1
    bent = np.array([[0.0, np.pi / 2]])
    table = verify(model, samples=3).variants["s3n_full"]
    compiled = mujoco.MjModel.from_xml_path(str(tmp_path / "n.xml"))
    written = compiled_dynamics(compiled, model.joints, bent, 0 * bent).mass[0]
    assert [written[0, 0], written[0, 1], written[1, 1]] == pytest.approx(table, rel=1e-9)
    plain = run("normalize", tmp_path / "own.toml", "-o", tmp_path / "k.xml", "--variant", "kin_only")
    said = " ".join(plain.stdout.split())
    assert "Exact" not in said and "drives' inertia" in said and "linkage's inertia" in said


def test_the_transmission_is_of_the_posture_that_the_file_says(tmp_path: Path) -> None:
    """The start is written to six digits; more digits gave another J, where it is steep."""
    rod = '<child link="rod"/><origin xyz="0 0 0.05"/>'
    assert rod in urdf_of_a_leg()
    (tmp_path / "own.urdf").write_text(urdf_of_a_leg().replace(rod, rod.replace("0.05", "0.04")))
    frames, limits = (("rod_end", "arm_end"),), ((-0.5, 0.5), (0.9, 1.2))
    mechanism = Mechanism(
        tmp_path / "own.urdf", ("hip", "motor"), ("hip", "knee"), frames, "toe", limits=limits
    )
    import_model(mechanism, MOTORS, tmp_path / "own.toml")
    model = read_model(tmp_path / "own.toml")
    assert model.posture_dependent and model.closed_chain is not None
    chain = ClosedChain(model.closed_chain)
    np.testing.assert_allclose(model.transmission, chain.jacobian(chain.start[1]), atol=1e-10)
