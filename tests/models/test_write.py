"""A model that is written reads back equal, with whatever effects and values."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.models.make import machine_file
from workbench.core import Controller, EffectKey, Estimate, InputError
from workbench.effects import check_effect, effect_named, load_model, places
from workbench.models import AppliedEffect, Model, Placement, write_model

FINITE = st.floats(-1e3, 1e3, allow_nan=False)
ANY_FOLDER = settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def assert_equal(a: Model, b: Model) -> None:
    np.testing.assert_array_equal(a.transmission, b.transmission)
    same = {"transmission": np.eye(0), "source": None}
    assert vars(replace(a, **same)).keys() == vars(replace(b, **same)).keys()
    for key, value in vars(a).items():
        if key not in same:
            assert value == getattr(b, key), key


@st.composite
def applied(draw: st.DrawFn, model: Model) -> AppliedEffect:
    """An effect that this model can have, with values that a body can have."""
    key = draw(st.sampled_from(places(model)))
    effect = effect_named(key.effect)
    low, high = effect.parameters.bounds(model, Placement.of(model, key))
    spans = zip(np.maximum(low, -1e3), np.minimum(high, 1e3), strict=True)
    coefficients = np.array([draw(st.floats(float(a), float(b))) for a, b in spans])
    lowest = {
        name: low
        for name, (low, _) in effect.parameters.shape_bounds(model, Placement.of(model, key)).items()
    }
    shape = {name: draw(st.floats(max(lowest[name], 1e-6), 0.2)) for name in effect.parameters.nonlinear}
    std = draw(st.floats(0, 1))
    # unknowns that fits move need not be the parameters, which have bounds of their own
    values = effect.parameters.to_values(coefficients, shape)
    below = {"damping", "inertia"}  # increments, which may be negative
    values = {
        p.name: values[p.name] if p.name in below else max(values[p.name], p.lower)
        for p in effect.parameters
        if p.name in values
    }
    return check_effect(model, AppliedEffect(key, {k: Estimate(v, std, "") for k, v in values.items()}))


def written(model: Model, folder: Path) -> Model:
    path = folder / "written.toml"
    write_model(model, path, force=True)
    return load_model(path)


@ANY_FOLDER
@given(data=st.data())
def test_effects_with_any_values(data: st.DataObject, tmp_path: Path) -> None:
    model = load_model(data.draw(st.sampled_from(["leg", "leg_kin_only", "leg_s3n_full", "emps"])))
    for _ in range(data.draw(st.integers(0, 4))):
        model = model.with_effect(data.draw(applied(model)))
    assert_equal(written(model, tmp_path), model)


@ANY_FOLDER
@given(
    kp=st.lists(st.floats(0.0, 1e6), min_size=2, max_size=2).map(tuple),
    coordinates=st.sampled_from(["joint", "actuator"]),
    limit=st.lists(st.floats(0.1, 1e6) | st.just(float("inf")), min_size=2, max_size=2).map(tuple),
    delay=st.floats(0, 1),
    name=st.text(min_size=1, max_size=20),
)
def test_numbers_and_names(kp, coordinates, limit, delay, name, tmp_path: Path) -> None:
    model = load_model("leg")
    model = replace(
        model,
        name=name,
        actuators=replace(model.actuators, torque_limit=limit, delay_s=delay),
        controller=Controller("pd", coordinates, kp=kp, kd=kp, period_s=0.001),
        sliding_speed=0.002,
        friction_as_in_mjcf=True,
        flank_retardation_s=delay,
    )
    if name.isprintable():
        assert_equal(written(model, tmp_path), model)


def test_a_users_mjcf(tmp_path: Path) -> None:
    model = load_model(machine_file(tmp_path))
    assert_equal(written(model, tmp_path), model)
    (tmp_path / "elsewhere").mkdir()
    assert_equal(written(model, tmp_path / "elsewhere"), model)


def test_the_shipped_tree_is_found_beside_another_of_its_name(tmp_path: Path) -> None:
    (tmp_path / "serial").mkdir()
    machine_file(tmp_path / "serial").rename(tmp_path / "serial" / "leg.xml")
    assert_equal(written(load_model("leg"), tmp_path), load_model("leg"))


def without(model: Model, effect: str) -> Model:
    return replace(model, effects=tuple(e for e in model.effects if e.key.effect != effect))


def test_a_variant_without_one_of_its_effects_stays_without(tmp_path: Path) -> None:
    less = without(load_model("leg"), "actuator_inertia_coupling")
    assert written(less, tmp_path).effects == less.effects
    values = {"g1": Estimate(1.0, 0, "N*m"), "g2": Estimate(0.0, 0, "N*m")}
    other = AppliedEffect(EffectKey("linkage_gravity", None), values)
    changed = without(load_model("leg"), "linkage_gravity").with_effect(other)
    assert written(changed, tmp_path).effects == changed.effects


def test_a_file_is_not_overwritten_unasked(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("mine")
    with pytest.raises(InputError, match=r"mine.toml.*--force"):
        write_model(load_model("leg"), tmp_path / "mine.toml")
    assert (tmp_path / "mine.toml").read_text() == "mine"
