"""Errors of a link's own mass: what their columns say is what MuJoCo's inverse dynamics says, on any tree."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from tests.bench_arm import AXES, FAST, NUMBERS, bench_arm, logged
from workbench.comparison import compare, replay_of
from workbench.core import EffectKey, Estimate, Recording
from workbench.effects import Motion, build, compile_plant, effect_named, load_model, places
from workbench.models import AppliedEffect, Model, Placement


def having(model: Model, effect: str, axis: str, **values: float) -> Model:
    parameters = {name: Estimate(value, 0.0, "") for name, value in values.items()}
    return model.with_effect(AppliedEffect(EffectKey(effect, axis), parameters))


@pytest.mark.parametrize(
    ("effect", "axis"),
    [("first_moment_error", a) for a in AXES] + [("link_inertia_error", a) for a in AXES[1:]],
)
def test_columns_are_the_change_of_the_torque_that_is_needed(tmp_path: Path, effect: str, axis: str) -> None:
    file = bench_arm(tmp_path, fore_across=0.03)
    model, log = load_model(file), logged(file, FAST, seconds=3.0)
    replay = replay_of(model, [log])
    motion = replay.motion(compile_plant(model), 0, replay.run([model])[0][0])
    key = EffectKey(effect, axis)
    columns = effect_named(effect).response(motion, model, Placement.of(model, key), {}).columns
    names = [p.name for p in effect_named(effect).parameters if not p.optional]
    for column, name in zip(columns, names, strict=True):
        zeros = dict.fromkeys(names, 0.0)
        more, less = (having(model, effect, axis, **{**zeros, name: h}) for h in (1e-4, -1e-4))
        slope = (motion.required(more) - motion.required(less)) / 2e-4
        size = np.abs(slope).max()
        np.testing.assert_allclose(-column[20:-20], slope[20:-20], atol=2e-3 * size + 1e-9)


def forms(model: Model, effect: str, axis: str) -> tuple[Motion, list[dict[str, float]]]:
    """A motion of the arm, and the causes that a search asks for there."""
    log = logged(model.serial, FAST, seconds=3.0)
    replay = replay_of(model, [log])
    motion = replay.motion(compile_plant(model), 0, replay.run([model])[0][0])
    place = Placement.of(model, EffectKey("", axis))
    return motion, [dict(shape) for shape in effect_named(effect).parameters.shapes([motion], model, place)]


def assert_column_is_the_change(
    motion: Motion, model: Model, effect: str, axis: str, shape: dict[str, float]
) -> None:
    """What a form says that the drives have to do more is what the model with a little of it needs more."""
    kind, place = effect_named(effect), Placement.of(model, EffectKey("", axis))
    (column,) = kind.response(motion, model, place, shape).columns
    values = [kind.parameters.to_values(np.array([h]), shape) for h in (1e-4, -1e-4)]
    more, less = (motion.required(having(model, effect, axis, **v)) for v in values)
    slope = (more - less) / 2e-4
    np.testing.assert_allclose(-column[20:-20], slope[20:-20], atol=2e-3 * np.abs(slope).max() + 1e-9)


@pytest.mark.parametrize("axis", AXES[1:])
@pytest.mark.parametrize("off", [0.0, 0.05])
@pytest.mark.parametrize("form", [1, 2])
def test_the_column_of_a_mass_is_the_change_of_the_torque(
    tmp_path: Path, axis: str, off: float, form: int
) -> None:
    """With the link's inertia as it was, and with the inertia in proportion."""
    model = load_model(bench_arm(tmp_path, fore_across=0.03))
    motion, shapes = forms(model, "first_moment_error", axis)
    shape = shapes[form]
    shape["lever"] += off
    assert_column_is_the_change(motion, model, "first_moment_error", axis, shape)


def test_all_inertia_of_a_link_in_proportion(tmp_path: Path) -> None:
    """The bend turns about one axis, the yaw turns it about another."""
    model = load_model(bench_arm(tmp_path))
    motion, shapes = forms(model, "link_inertia_error", "bend")
    assert shapes == [{}, {"proportion": 1.0}]
    assert_column_is_the_change(motion, model, "link_inertia_error", "bend", shapes[1])
    wider = having(model, "link_inertia_error", "bend", inertia=0.016, proportion=1.0)
    before, after = (compile_plant(m).mujoco.body("fore").inertia for m in (model, wider))
    np.testing.assert_allclose(np.sort(after), 1.5 * np.sort(before))


def test_inertia_in_proportion_is_not_asked_without_a_rotor(tmp_path: Path) -> None:
    """Several rotors that are missing do nearly the same, and a file without any lacks them."""
    model = load_model(bench_arm(tmp_path, bend_armature=0.0))
    assert forms(model, "link_inertia_error", "bend")[1] == [{}]


def test_one_axis_alone_turns_a_link_where_all_are_parallel(tmp_path: Path) -> None:
    model = load_model(bench_arm(tmp_path, yaw_z=0.0, yaw_y=1.0))
    assert forms(model, "link_inertia_error", "bend")[1] == [{}]


def test_the_first_link_may_be_heavier_where_its_weight_shows(tmp_path: Path) -> None:
    """About an upright axis it does what a rotor does; about a level one its weight tells it apart."""
    upright = load_model(bench_arm(tmp_path))
    assert forms(upright, "first_moment_error", AXES[0])[1] == [{}]
    level = load_model(bench_arm(tmp_path, "level", yaw_x=1.0, yaw_z=0.0))
    centre, heavier, larger = forms(level, "first_moment_error", AXES[0])[1]
    assert centre == {} and heavier == {"lever": 0.05, "aside": 0.0}
    assert larger == pytest.approx({**heavier, "gyration": 0.01 / 3.0})
    assert forms(upright, "first_moment_error", "bend")[1][1] == pytest.approx({"lever": 0.14, "aside": 0.0})


def test_a_denser_link_is_the_file_with_it(tmp_path: Path) -> None:
    model = load_model(bench_arm(tmp_path))
    denser = having(
        model, "first_moment_error", "bend", along=0.65 * 0.14, across=0, mass=0.65, inertia=0.016
    )
    other = load_model(bench_arm(tmp_path, "other", fore_mass=1.95, fore_inertia=0.048, fore_roll=0.021))
    one, two = (compile_plant(m).mujoco.body("fore") for m in (denser, other))
    assert one.mass == pytest.approx(two.mass)
    np.testing.assert_allclose(one.ipos, two.ipos, atol=1e-12)
    np.testing.assert_allclose(np.sort(one.inertia), np.sort(two.inertia))


def test_a_heavier_link_is_the_file_with_it(tmp_path: Path) -> None:
    """Half as much again: the centre stays, and the inertia about it."""
    model = load_model(bench_arm(tmp_path))
    heavier = having(model, "first_moment_error", "bend", along=0.65 * 0.14, across=0.0, mass=0.65)
    before, after = (compile_plant(m).mujoco.body("fore") for m in (model, heavier))
    assert after.mass == pytest.approx(1.5 * before.mass)
    np.testing.assert_allclose(after.ipos, before.ipos, atol=1e-12)
    np.testing.assert_allclose(after.inertia, before.inertia)
    # one more of it, of which nothing is said but that the centre moves
    again = having(heavier, "first_moment_error", "bend", along=0.0195, across=0.0)
    assert compile_plant(again).mujoco.body("fore").ipos[0] == pytest.approx(0.14 + 0.0195 / 1.95)


def test_a_shifted_centre_is_the_file_with_it(tmp_path: Path) -> None:
    """Both write the same body: 1.3 kg with its centre 0.0695 m nearer and 0.02 m lower."""
    model = load_model(bench_arm(tmp_path))
    shifted = having(model, "first_moment_error", "bend", along=1.3 * (0.0705 - 0.14), across=1.3 * 0.02)
    other = load_model(bench_arm(tmp_path, "other", fore_centre=0.0705, fore_across=-0.02))
    one, two = (compile_plant(m).mujoco for m in (shifted, other))
    np.testing.assert_allclose(one.body_ipos, two.body_ipos, atol=1e-12)
    np.testing.assert_allclose(one.body_mass, two.body_mass)
    again = having(shifted, "first_moment_error", "bend", along=0.01, across=0.0)
    assert compile_plant(again).mujoco.body("fore").ipos[0] == pytest.approx(0.0705 + 0.01 / 1.3)


@pytest.mark.parametrize("more", [0.05, -0.03])
def test_inertia_stays_one_that_a_body_can_have(tmp_path: Path, more: float) -> None:
    model = having(load_model(bench_arm(tmp_path)), "link_inertia_error", "bend", inertia=more)
    m = compile_plant(model).mujoco
    body = m.body("fore")
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, body.iquat)
    tensor = rotation.reshape(3, 3) @ np.diag(body.inertia) @ rotation.reshape(3, 3).T
    assert tensor[1, 1] == pytest.approx(NUMBERS["fore_inertia"] + more)
    assert 2 * body.inertia.max() <= body.inertia.sum() + 1e-12


def test_a_parallelogram_has_neither() -> None:
    names = {"first_moment_error", "link_inertia_error"}
    assert not names & {key.effect for key in places(load_model("leg"))}


_GANTRY = """<mujoco model="gantry">
<option gravity="0 0 {pull}"/>
<worldbody><body name="bridge"><joint name="x" type="slide" axis="1 0 0" armature="6"/>
  <inertial pos="0 0.3 0" mass="14" diaginertia="0.9 0.1 0.9"/>
  <body name="turret"><joint name="turn" axis="0 0 1" armature="0.5"/>
    <inertial pos="0 0 0" mass="3" diaginertia="0.1 0.1 0.1"/>
    <body name="carriage" pos="0.1 0 0"><joint name="{name}" type="slide" axis="{axis}" armature="3"/>
      <inertial pos="0.2 0 0.05" mass="9" diaginertia="0.05 0.05 0.05"/>
    </body></body></body></worldbody></mujoco>"""


def gantry(folder: Path, axis: str = "1 0 0", pull: float = -9.81) -> Model:
    """A carriage that slides on a turret on a bridge that slides."""
    (file := folder / "gantry.xml").write_text(_GANTRY.format(name="out", axis=axis, pull=pull))
    return load_model(file)


def test_of_what_slides_the_mass_is_asked_for_alone(tmp_path: Path) -> None:
    model = gantry(tmp_path)
    effect, place = effect_named("first_moment_error"), Placement.of(model, EffectKey("", "out"))
    (shape,) = effect.parameters.shapes([], model, place)
    assert "lever" in shape
    on = [
        (key.effect, key.axis) for key in places(model) if key.effect.endswith(("moment_error", "tia_error"))
    ]
    # what slides turns with its turret
    assert sorted(on) == [
        *(("first_moment_error", axis) for axis in ("out", "turn", "x")),
        ("link_inertia_error", "turn"),
    ]


def test_a_slide_that_is_lifted_has_a_mass_of_its_own(tmp_path: Path) -> None:
    text = _GANTRY.format(name="out", axis="1 0 0", pull=-9.81).replace('axis="1 0 0"', 'axis="0 0 1"', 1)
    (file := tmp_path / "lift.xml").write_text(text)
    assert EffectKey("first_moment_error", "x") in places(load_model(file))


def test_the_column_of_a_sliding_mass_is_the_torque_s_change(tmp_path: Path) -> None:
    model = gantry(tmp_path, axis="0.6 0 0.8")
    time = np.arange(0.0, 2.0, 0.002)
    position = np.stack([0.1 * np.sin(k * time + k) for k in (3.0, 5.0, 4.0)], axis=1)
    signals = {"position": position, "torque_measured": 10.0 * position}
    log = Recording("log", model.axes, "joint", time, signals, ("m", "rad", "m"))
    motion = replay_of(model, [log]).motion(compile_plant(model), 0, log)
    effect, place = effect_named("first_moment_error"), Placement.of(model, EffectKey("", "out"))
    (shape,) = effect.parameters.shapes([motion], model, place)
    (column,) = effect.response(motion, model, place, shape).columns
    values = [effect.parameters.to_values(np.array([h]), shape) for h in (1e-3, -1e-3)]
    more, less = (motion.required(having(model, effect.name, "out", **v)) for v in values)
    slope = (more - less) / 2e-3
    np.testing.assert_allclose(-column[20:-20], slope[20:-20], atol=2e-3 * np.abs(slope).max())
    assert np.abs(slope).max(axis=0).min() > 0.1  # all three drives feel it


def test_the_wrong_centre_explains_the_log(tmp_path: Path) -> None:
    log = logged(bench_arm(tmp_path, fore_centre=0.11), FAST, seconds=4.0)
    model = load_model(bench_arm(tmp_path, "model"))
    assert not compare(model, [log]).consistent
    right = having(model, "first_moment_error", "bend", along=1.3 * (0.11 - 0.14), across=0.0)
    assert compare(right, [log]).consistent
    assert build(right).inertials.keys() == {"fore"}
