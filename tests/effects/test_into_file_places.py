"""Which number of a file an effect goes into: ratios, coupled drives, included files, and what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.bench_arm import bench_arm
from tests.effects.test_into_file import corrections, with_effects
from workbench.core import InputError
from workbench.effects import into_file


def test_a_drive_with_a_ratio_gives_its_joint_the_square(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    ratio = -3.0
    table = tmp_path / "geared.toml"
    table.write_text(
        'format = 1\nname = "geared"\nserial = "arm.xml"\naxes = ["yaw", "lift", "bend"]\n[transmission]\n'
        f'joints = ["yaw", "lift", "bend"]\nmatrix = [[1.0, 0, 0], [0, {ratio}, 0], [0, 1.0, 1.0]]\n'
    )
    table.write_text(table.read_text().replace("[0, 1.0, 1.0]", "[0, 0, 1.0]"))
    model = with_effects(
        table,
        ("viscous_damping@lift", {"damping": 0.02}),
        ("coulomb_friction@lift", {"torque": 0.1}),
        ("reflected_inertia@lift", {"inertia": 0.001}),
        ("parallel_spring@lift", {"stiffness": 0.5, "rest": 0.6}),
        ("coulomb_friction@lift(joint)", {"torque": 0.4}),
    )
    made = into_file(model, file)
    now = {c.number: c.after for c in made.changes}
    assert now == pytest.approx(
        {"damping": 0.98, "frictionloss": 0.7, "armature": 0.0958, "stiffness": 4.5, "springref": -0.2}
    )


def test_a_motor_of_two_joints_has_no_number_in_the_file(tmp_path: Path) -> None:
    bench_arm(tmp_path)
    table = tmp_path / "belt.toml"
    table.write_text(
        'format = 1\nname = "belt"\nserial = "arm.xml"\naxes = ["yaw", "lift", "bend"]\n[transmission]\n'
        'joints = ["yaw", "lift", "bend"]\nmatrix = [[1.0, 0, 0], [0, 1.0, 0], [0, 1.0, 1.0]]\n'
    )
    model = with_effects(
        table,
        ("viscous_damping@bend", {"damping": 0.02}),
        ("viscous_damping@bend(joint)", {"damping": 0.03}),
        ("cogging@yaw", {"torque": 0.1, "order": 7.0, "phase": 0.0}),
    )
    made = into_file(model, tmp_path / "arm.xml")
    assert [(e.key.effect, e.key.location) for e in made.left] == [
        ("viscous_damping", "actuator"),
        ("cogging", "actuator"),
    ]
    assert [(c.joint, c.after) for c in made.changes] == [("bend", pytest.approx(0.43))]


def test_a_joint_of_an_included_file_is_looked_for_there(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    text = file.read_text()
    inner = text[text.index('<body name="turret"') : text.rindex("</worldbody>")]
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/tree.xml").write_text(f"<mujocoinclude>{inner}</mujocoinclude>")
    file.write_text(text.replace(inner, '<include file="parts/tree.xml"/>'))
    model = with_effects(file, *corrections()[:3])
    with pytest.raises(InputError, match=r"joint 'lift' is not in it; it is in .*parts/tree.xml"):
        into_file(model, file)
    made = into_file(model, tmp_path / "parts/tree.xml")
    assert len(made.changes) == 3 and made.content.startswith(b"<mujocoinclude>")
    with pytest.raises(InputError, match="is not based on this file"):
        into_file(model, bench_arm(tmp_path, "other"))


@pytest.mark.filterwarnings("ignore:compiler attribute")
@pytest.mark.parametrize(
    ("was", "is_now", "effect"),
    [
        ("<compiler ", '<compiler settotalmass="7" ', corrections()[2]),
        ("<compiler ", '<compiler inertiafromgeom="true" ', corrections()[2]),
        ("<option ", '<option><flag frictionloss="disable"/></option><option ', corrections()[4]),
    ],
)
def test_a_file_that_overrules_its_own_numbers_is_refused(
    was: str, is_now: str, effect: tuple[str, dict[str, float]], tmp_path: Path
) -> None:
    file = bench_arm(tmp_path)
    ball = '<geom type="sphere" size="0.05" pos="0.1 0 0"/><site'
    file.write_text(file.read_text().replace(was, is_now).replace("<site", ball).replace(
        '<joint name="lift"', '<geom type="sphere" size="0.06" pos="0.1 0 0"/><joint name="lift"').replace(
        '<joint name="yaw"', '<geom type="sphere" size="0.06" pos="0.1 0 0"/><joint name="yaw"'))  # fmt: skip
    model = with_effects(file, effect)
    with pytest.raises(InputError, match="with these numbers it is not the model"):
        into_file(model, file)


def test_no_number_falls_below_zero(tmp_path: Path) -> None:
    file = bench_arm(tmp_path)
    none = into_file(with_effects(file, ("viscous_damping@lift", {"damping": -0.8})), file)
    assert b'<joint name="lift" axis="0 1 0" damping="0" ' in none.content
    table = tmp_path / "more.toml"
    table.write_text(
        'format = 1\nname = "more"\nserial = "arm.xml"\n[actuators]\ndamping = 1.0\ninertia = 0.1\n'
    )
    model = with_effects(table, ("viscous_damping@lift", {"damping": -1.2}))
    with pytest.raises(InputError, match=r"joint 'lift' would have damping -0.4; .* comes from .*more.toml"):
        into_file(model, file)
