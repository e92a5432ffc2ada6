"""What a file binds beside its tree (loops, followers, balls, held joints), in every form, is one machine."""

from __future__ import annotations

import warnings
from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.cli.here import run
from workbench.core import Coupling, InputError, Mechanism
from workbench.importing import Drives, contents_of, import_model
from workbench.mechanism import ClosedChain
from workbench.models import Model, read_model
from workbench.s3n import PostureChain, compiled_dynamics
from workbench.verification import verify

_MOTORS = Drives((9.0, 9.0), (2e-4, 2e-4), (1e-3, 1e-3), (20.0, 20.0))
_LIMITS = ((-0.6, 0.6), (0.6, 1.6))

# links of a leg with unequal bars: name, parent's joint place, centre of mass, mass, inertia
_LINKS = (
    ("thigh", "world", "hip", (0.0, 0.0, 0.0), (0.01, 0.0, -0.11), 0.9, 0.004),
    ("shank", "thigh", "knee", (0.0, 0.0, -0.22), (0.0, 0.0, -0.1), 0.35, 0.002),
    ("lever", "world", "crank", (0.0, 0.0, 0.0), (0.0, 0.0, 0.02), 0.1, 1e-4),
    ("rod", "lever", "pin", (0.0, 0.0, 0.045), (0.0, 0.0, -0.11), 0.07, 3e-4),
)
_BARS = {"unequal": (-0.20, 0.05), "a parallelogram": (-0.22, 0.045)}
_ENDS = (("rod_end", "rod", -0.20), ("heel", "shank", 0.05), ("toe", "shank", -0.24))
_Ends = tuple[tuple[str, str, float], ...]


def _words(values: tuple[float, ...]) -> str:
    return " ".join(map(str, values))


def _mjcf(folder: Path, ends: _Ends = _ENDS) -> Path:
    text = {name: "" for name, *_ in _LINKS} | {"world": ""}
    for name, parent, joint, at, centre, mass, about in reversed(_LINKS):
        sites = "".join(f'<site name="{n}" pos="0 0 {z}"/>' for n, link, z in ends if link == name)
        text[parent] += (
            f'<body name="{name}" pos="{_words(at)}"><joint name="{joint}" axis="0 -1 0"/>'
            f'<inertial pos="{_words(centre)}" mass="{mass}" diaginertia="{_words((about,) * 3)}"/>'
            f"{sites}{text[name]}</body>"
        )
    bound = '<equality><connect site1="rod_end" site2="heel"/></equality>'
    file = folder / "leg_mjcf.xml"
    file.write_text(f"<mujoco><worldbody>{text['world']}</worldbody>{bound}</mujoco>")
    return file


def _urdf(folder: Path, ends: _Ends = _ENDS) -> Path:
    parts = ['<link name="world"/>']
    for name, parent, joint, at, centre, mass, about in _LINKS:
        inertia = f'ixx="{about}" iyy="{about}" izz="{about}" ixy="0" ixz="0" iyz="0"'
        parts += [
            f'<link name="{name}"><inertial><origin xyz="{_words(centre)}"/><mass value="{mass}"/>',
            f'<inertia {inertia}/></inertial></link><joint name="{joint}" type="continuous">',
            f'<parent link="{parent}"/><child link="{name}"/><origin xyz="{_words(at)}"/>',
            '<axis xyz="0 -1 0"/></joint>',
        ]
    for name, link, z in ends:
        parts += [
            f'<link name="{name}"/><joint name="{name}_fixed" type="fixed"><parent link="{link}"/>',
            f'<child link="{name}"/><origin xyz="0 0 {z}"/></joint>',
        ]
    file = folder / "leg_urdf.urdf"
    file.write_text(f'<robot name="leg">{"".join(parts)}</robot>')
    return file


def _sdf(folder: Path, ends: _Ends = _ENDS) -> Path:
    parts = []
    for name, parent, joint, at, centre, mass, about in _LINKS:
        above = "" if parent == "world" else f' relative_to="{parent}"'
        inertia = "".join(f"<{key}>{about}</{key}>" for key in ("ixx", "iyy", "izz"))
        parts += [
            f'<link name="{name}"><pose{above}>{_words(at)} 0 0 0</pose><inertial>',
            f"<pose>{_words(centre)} 0 0 0</pose><mass>{mass}</mass><inertia>{inertia}</inertia>",
            "</inertial></link>",
            f'<joint name="{joint}" type="revolute"><parent>{parent}</parent><child>{name}</child>',
            "<axis><xyz>0 -1 0</xyz></axis></joint>",
        ]
    for name, link, z in ends:
        parts.append(f'<frame name="{name}" attached_to="{link}"><pose>0 0 {z} 0 0 0</pose></frame>')
    file = folder / "leg_sdf.sdf"
    file.write_text(f'<sdf version="1.9"><model name="leg">{"".join(parts)}</model></sdf>')
    return file


def _imported(file: Path, loops: tuple[tuple[str, str], ...] = (("rod_end", "heel"),)) -> Model:
    start = (("knee", 1.1), ("crank", 1.3))
    own = () if file.suffix == ".xml" else loops
    mechanism = Mechanism(file, ("hip", "crank"), ("hip", "knee"), own, "toe", start, _LIMITS)
    target = file.with_name(f"{file.stem}_model.toml")
    import_model(mechanism, _MOTORS, target)
    return read_model(target)


@pytest.mark.parametrize("bars", _BARS)
def test_one_robot_in_three_forms_is_one_s3n(tmp_path: Path, bars: str) -> None:
    below, above = _BARS[bars]
    ends = (("rod_end", "rod", below), ("heel", "shank", above), _ENDS[2])
    models = [_imported(make(tmp_path, ends)) for make in (_mjcf, _urdf, _sdf)]
    generator = np.random.default_rng(1)
    low, high = np.transpose(_LIMITS)
    q = generator.uniform(low, high, (6, 2))
    v = generator.uniform(-4.0, 4.0, q.shape)
    written = []
    for model in models:
        assert model.posture_dependent == (bars == "unequal") and verify(model, samples=4).passed
        done = run("normalize", model.source, "-o", tmp_path / f"{model.name}_s3n.xml")
        assert done.returncode == 0, done.stderr
        compiled = mujoco.MjModel.from_xml_path(str(tmp_path / f"{model.name}_s3n.xml"))
        written.append(compiled_dynamics(compiled, model.joints, q, v))
    # the closed chains are one to rounding; the file is a fit to it, which rounding moves a little
    exact = [PostureChain(model).dynamics(q, v) for model in models]
    for results, accuracy in ((exact, 1e-9), (written, 1e-2 if bars == "unequal" else 1e-9)):
        for other in results[1:]:
            for key, value in vars(results[0]).items():
                if value is not None:
                    size = float(np.abs(value).max())
                    np.testing.assert_allclose(getattr(other, key), value, atol=accuracy * size, err_msg=key)


def test_a_whole_robot_with_two_legs_on_one_base_is_checked(tmp_path: Path) -> None:
    """Each leg has a loop of its own; serial coordinates are those of both, and no end is the foot."""
    text = _mjcf(tmp_path).read_text()
    leg = text[text.index("<worldbody>") + len("<worldbody>") : text.index("</worldbody>")]
    left, right = (leg.replace('name="', f'name="{side}_') for side in ("left", "right"))
    right = right.replace('pos="0.0 0.0 0.0"><joint', 'pos="0 -0.2 0"><joint')
    bound = "".join(f'<connect site1="{s}_rod_end" site2="{s}_heel"/>' for s in ("left", "right"))
    file = tmp_path / "both.xml"
    file.write_text(f"<mujoco><worldbody>{left}{right}</worldbody><equality>{bound}</equality></mujoco>")
    names = [
        tuple(f"{side}_{name}" for side in ("left", "right") for name in pair)
        for pair in (("hip", "crank"), ("hip", "knee"))
    ]
    bent = (("knee", 1.1), ("crank", 1.3))
    start = tuple((f"{side}_{k}", v) for side in ("left", "right") for k, v in bent)
    mechanism = Mechanism(file, names[0], names[1], (), None, start, _LIMITS * 2)
    import_model(mechanism, Drives((1.0,) * 4, (1.0,) * 4, (1.0,) * 4, (1.0,) * 4), tmp_path / "own.toml")
    result = verify(read_model(tmp_path / "own.toml"), samples=4)
    assert result.passed and {"posture_mass_matrix", "posture_drives"} <= {c.name for c in result.checks}
    assert any("import each limb" in told for told in result.not_checked)


_PAIR = """<mujoco><compiler angle="radian"/><worldbody>
<body name="one"><joint name="one" axis="0 1 0" ref="0.2"/>
<geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.02"/>
<body name="tip" pos="0.2 0 0"><joint name="tip" axis="0 1 0" ref="-0.1"/>
<geom type="capsule" fromto="0 0 0 0.1 0 0" size="0.01"/><site name="toe" pos="0.1 0 0"/></body></body>
<body name="two" pos="0 0.1 0"><joint name="two" axis="0 1 0"/><geom type="box" size="0.1 0.02 0.02"/></body>
</worldbody><equality><joint joint1="tip" joint2="two" polycoef="0.1 0.5 0.02 0 0"/></equality></mujoco>"""


def test_a_follower_is_where_mujoco_has_it_and_moves_alike(tmp_path: Path) -> None:
    """A finger whose tip follows a pulley along a curve: velocity terms need how the curve bends."""
    file = tmp_path / "finger.xml"
    file.write_text(_PAIR)
    refused = run("check", file)
    assert refused.returncode == 2 and "'tip' and 'two'" in refused.stderr and "import" in refused.stderr
    assert "tip follows two" in run("import", file).stdout
    mechanism = Mechanism(file, ("one", "two"), ("one", "tip"), (), "toe", limits=((-0.5, 0.5), (0.1, 0.5)))
    model = import_model(mechanism, _MOTORS, tmp_path / "own.toml")
    assert verify(read_model(tmp_path / "own.toml"), samples=6).passed
    assert model.closed_chain is not None
    chain, x = ClosedChain(model.closed_chain), 0.4
    theta = chain.tree_position(np.array([0.0, x]))
    # both angles count from where the MJCF begins: tip from -0.1
    assert theta[chain.coordinates.index("tip")] == pytest.approx(
        -0.1 + 0.1 + 0.5 * x + 0.02 * x**2, abs=1e-9
    )
    # at rest acceleration of the pulley, what it feels is what MuJoCo's stiff constraint lets it feel
    m = mujoco.MjModel.from_xml_path(str(file))
    data = mujoco.MjData(m)
    m.eq_solref[:], m.eq_solimp[0, :2] = (1e-4, 1.0), 0.99999
    m.opt.timestep, m.opt.disableflags = 1e-5, 0
    data.qpos[:] = [theta[chain.coordinates.index(n)] for n in ("one", "tip", "two")]
    slope = 0.5 + 0.04 * x
    data.qvel[:] = 1.5, slope * 2.0, 2.0
    mujoco.mj_forward(m, data)
    at = chain.reduced_dynamics(np.array([data.qpos[0], x]), np.array([1.5, 2.0]))
    np.testing.assert_allclose(
        np.linalg.solve(at.mass, at.gravity - at.bias), data.qacc[[0, 2]], rtol=2e-3, atol=2e-2
    )


def test_mimic_of_a_urdf_is_the_same_as_a_follower_of_an_mjcf(tmp_path: Path) -> None:
    straight = _PAIR.replace("0.1 0.5 0.02", "0.1 0.5 0").replace('ref="0.2"', "").replace('ref="-0.1"', "")
    (tmp_path / "m.xml").write_text(straight)
    box = "<mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>"
    (tmp_path / "u.urdf").write_text(
        "<robot name='u'><link name='world'/>"
        + "".join(f"<link name='{n}'><inertial>{box}</inertial></link>" for n in ("one", "tip", "two"))
        + "<link name='toe'/>"
        + "".join(
            f"<joint name='{n}' type='{kind}'><parent link='{p}'/><child link='{n}'/>"
            f"<origin xyz='{at}'/><axis xyz='0 1 0'/>{more}</joint>"
            for n, p, at, kind, more in (
                ("one", "world", "0 0 0", "continuous", ""),
                ("tip", "one", "0.2 0 0", "continuous", "<mimic joint='two' multiplier='0.5' offset='0.1'/>"),
                ("two", "world", "0 0.1 0", "continuous", ""),
                ("toe", "tip", "0.1 0 0", "fixed", ""),
            )
        )
        + "</robot>"
    )
    found = []
    for file in (tmp_path / "m.xml", tmp_path / "u.urdf"):
        mechanism = Mechanism(file, ("one", "two"), ("one", "tip"), (), "toe", limits=((-0.5, 0.5), (0, 0.5)))
        model = import_model(mechanism, _MOTORS, tmp_path / f"{file.stem}_model.toml")
        assert verify(read_model(tmp_path / f"{file.stem}_model.toml"), samples=4).passed
        found.append(model.transmission)
        assert contents_of(file).couplings == (Coupling("tip", "two", (0.1, 0.5)),)
    np.testing.assert_allclose(found[0], found[1], atol=1e-9)


# an ankle in a plane whose push rod hangs on balls at both ends, behind a spring that is as good as stiff
_ROD = """<mujoco><compiler angle="radian"/><worldbody>
<body name="shin"><joint name="spring" axis="0 1 0" stiffness="3000"/>
<geom type="capsule" fromto="0 0 0 0 0 -0.3" size="0.02"/>
<body name="foot" pos="0 0 -0.3"><joint name="pitch" axis="0 1 0" range="-0.4 0.4"/>
<geom type="box" pos="0.05 0 0" size="0.08 0.03 0.01"/><site name="sole" pos="0 0 -0.05"/></body>
<body name="crank" pos="0 0.04 -0.05"><joint name="motor" axis="0 1 0" armature="0.01"/>
<geom type="capsule" fromto="0 0 0 -0.05 0 0" size="0.008"/>
<body name="rod" pos="-0.05 0 0"><joint name="ball" type="ball"/>
<geom type="capsule" fromto="0 0 0 0.005 -0.01 -0.26" size="0.005"/></body></body></body></worldbody>
<equality><connect body1="rod" body2="foot" anchor="0.005 -0.01 -0.26"/></equality></mujoco>"""


def test_a_rod_between_balls_and_a_stiff_spring_as_in_cassie(tmp_path: Path) -> None:
    file = tmp_path / "ankle.xml"
    file.write_text(_ROD)
    words = ["--drive", "motor", "--joint", "pitch", "--foot", "sole"]
    free = run("import", file, *words, "-o", tmp_path / "own.toml")
    assert free.returncode == 2 and "spring can still move" in free.stderr and "--hold" in free.stderr
    done = run("import", file, *words, "--hold", "spring=0", "-o", tmp_path / "own.toml")
    assert done.returncode == 0, done.stderr
    assert "taken as not turning about their own axis: ball" in " ".join(done.stdout.split())
    model = read_model(tmp_path / "own.toml")
    assert model.closed_chain is not None and verify(model, samples=4).passed
    # the motor's way is that of MuJoCo's ball and connect: distance of the rod's ends is the rod's length
    chain = ClosedChain(model.closed_chain)
    for pitch in (-0.3, 0.2):
        motor = chain.drive_position(np.array([pitch]))[0]
        turned = lambda a, p: np.array([p[0] * np.cos(a), p[1], -p[0] * np.sin(a)])  # noqa: E731
        top = np.array([0.0, 0.04, -0.05]) + turned(motor, (-0.05, 0.0))
        heel = np.array([-0.045, 0.03, -0.31]) - [0.0, 0.0, -0.3]
        c, s = np.cos(pitch), np.sin(pitch)
        bottom = np.array([c * heel[0] + s * heel[2], heel[1], -s * heel[0] + c * heel[2] - 0.3])
        length = np.linalg.norm([0.005, -0.01, -0.26])
        assert np.linalg.norm(top - bottom) == pytest.approx(length, abs=1e-9)


def test_a_ball_that_is_no_rod_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "ankle.xml"
    file.write_text(
        _ROD.replace('<equality><connect body1="rod" body2="foot" anchor="0.005 -0.01 -0.26"/>', "<equality>")
    )
    with pytest.raises(InputError, match=r"'ball' is a ball; .*rod"):
        contents_of(file)


def test_what_is_wrong_is_said_of_the_users_file(tmp_path: Path) -> None:
    """A link on its side has two angles that are one; limits that cannot be reached are the file's own."""
    file = tmp_path / "ankle.xml"
    file.write_text(_ROD.replace('<body name="shin">', '<body name="shin" euler="0 1.5707963267948966 0">'))
    words = ["--drive", "motor", "--joint", "pitch", "--hold", "spring=0", "-o", tmp_path / "own.toml"]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        done = run("import", file, *words, "--limits", "pitch=2.9:3.1")
    assert done.returncode == 2 and str(file) in done.stderr and "no posture within" in done.stderr
    rotor = file.read_text().replace('<joint name="pitch"', '<joint name="pitch" armature="0.02"')
    file.write_text(rotor)
    made = run("import", file, *words, "--foot", "sole")
    assert made.returncode == 0 and "armature of joints without a drive: pitch 0.02" in made.stdout
