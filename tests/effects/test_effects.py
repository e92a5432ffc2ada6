"""Every effect of the catalogue, in every place: equation, MuJoCo model and file say the same."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from tests.effects.cases import CASES, MODELS, Case, equation, reference, runs, with_effect
from tests.simulation.make import having, slide_experiment
from workbench.core import EffectKey, Estimate, InputError, Recording, SimulationError
from workbench.effects import (
    EFFECTS,
    Compliance,
    Motion,
    OnGround,
    SignalStage,
    compile_plant,
    effect_named,
    held,
    kinds,
    load_model,
    places,
)
from workbench.models import AppliedEffect, Placement, write_model
from workbench.simulation import Run, Track, motion_of, required_torque, simulate

every_case = pytest.mark.parametrize("case", CASES, ids=str)
every_place = pytest.mark.parametrize("case", [c for c in CASES if c.whole], ids=str)
#: Effects whose torque depends on the motion of the drives alone, and linearly on their coefficients.
#: Inertia goes with the square of a length: their columns are slopes (test_link_length, test_links).
BY_THE_SQUARE = ("link_length_error", "first_moment_error")
TORQUES = [
    c
    for c in CASES
    if c.effect.stage < SignalStage.SENSOR
    and not (isinstance(c.effect, Compliance | OnGround) or c.key.effect in BY_THE_SQUARE)
]
every_torque = pytest.mark.parametrize("case", TORQUES, ids=str)
#: Without a payload nothing in the motion tells where the foot is.
UNSEEN = ("link_length_error@knee",)


def midway(case: Case, run: Recording) -> tuple[Track, Motion]:
    """A run's motion at the middle of its rows' steps, by differences, in the base model's eyes."""
    h, base = run.period, compile_plant(load_model(case.model))
    q, w = run.position, run.velocity
    track = Track(
        (q[1:] + q[:-1]) / 2 - h / 8 * np.diff(w, axis=0), (w[1:] + w[:-1]) / 2, np.diff(w, axis=0) / h
    )
    signals = {name: values[:-1] for name, values in run.signals.items()}
    rows = replace(run, time=run.time[:-1], signals=signals, valid=None)
    return track, motion_of(track, rows, base, np.eye(base.model.size))


def along(case: Case, motion: Motion) -> np.ndarray:
    """Speed (N,) at the effect's place; infinite for effects on all axes."""
    place = Placement.of(load_model(case.model), case.key)
    return np.full(len(motion.position), np.inf) if place is None else motion.along(place)[1]


def test_every_effect_is_tested_somewhere() -> None:
    unreachable = {"linkage_coriolis"}  # only for a variant that no shipped model has
    assert {c.key.effect for c in CASES} | unreachable == {e.name for e in EFFECTS}


@every_case
def test_coefficients_and_parameters_are_inverse(case: Case) -> None:
    coefficients, shape = case.effect.parameters.to_coefficients(dict(case.values))
    assert case.effect.parameters.to_values(coefficients, shape) == pytest.approx(dict(case.values))
    again, same = case.effect.parameters.to_coefficients(
        case.effect.parameters.to_values(coefficients, shape)
    )
    np.testing.assert_allclose(again, coefficients)
    assert same == shape
    low, high = case.effect.parameters.bounds(
        load_model(case.model), Placement.of(load_model(case.model), case.key)
    )
    assert (low <= coefficients).all() and (coefficients <= high).all()


@every_torque
def test_the_simulation_obeys_the_equation(case: Case) -> None:
    """What the model without the effect lacks along the motion with it is the effect's torque."""
    base = load_model(case.model)
    track, motion = midway(case, with_effect(case))
    drive = held(motion.command, motion.step, base.actuators.delay_s)[1]
    drive = np.clip(drive, -np.array(base.actuators.torque_limit), base.actuators.torque_limit)
    lacking = required_torque(compile_plant(base), track) - drive
    expected = equation(case, replace(motion, torque=drive))
    size = np.sqrt(np.mean(expected**2, axis=0)).max()
    assert size > 0.02 * np.sqrt(np.mean(drive**2))
    speed = along(case, motion)
    slides = np.abs(speed) > (0.05 * np.abs(speed).max() if kinds.is_dry(case.effect) else -1.0)
    assert slides.mean() > 0.6
    rows = slides & (np.arange(len(slides)) > 20)
    wrong = np.abs(lacking - expected)[rows] > 0.02 * size + 0.01 * np.abs(expected)[rows]
    assert wrong.mean() < 0.005  # the speed that friction goes by is extrapolated over each step's torque


@every_place
def test_every_parameter_matters_and_what_is_written_is_alike(case: Case, tmp_path: Path) -> None:
    write_model(case.added, tmp_path / "written.toml")
    models = [load_model(tmp_path / "written.toml")]
    # without gravity, and with the same inertia everywhere, nothing tells where a sensor's zero is
    no_zero = case.effect.stage is SignalStage.SENSOR and case.model == "emps"
    seen = [p.name for p in case.effect.parameters if not (no_zero and p.unit == "rad")]
    for name, value in [pair for pair in case.values if pair[0] in seen and pair[1]]:
        changed = tuple({**dict(case.values), name: 1.1 * value}.items())
        models.append(replace(case, values=changed).added)
    again, *changes = runs(case.model, models)
    np.testing.assert_array_equal(again.position, with_effect(case).position)
    if str(case.key) in UNSEEN or (case.values and not seen):
        return
    moved = [np.abs(run.position - again.position).max() for run in (reference(case.model), *changes)]
    assert min(moved) > 1e-5 * np.ptp(again.position, axis=0).max()


@pytest.mark.parametrize("case", [c for c in CASES if c.effect.stage == SignalStage.FRICTION], ids=str)
def test_friction_takes_energy(case: Case) -> None:
    _, motion = midway(case, reference(case.model))
    power = np.sum(equation(case, motion) * motion.velocity, axis=1)
    if case.key.effect != "presliding_hysteresis":  # a spring gives some back, in the end it takes
        assert (power <= 1e-12).all()
    assert power.mean() < 0


@pytest.mark.parametrize("name", MODELS)
def test_places_are_where_effects_apply(name: str) -> None:
    model = load_model(name)
    keys = places(model)
    assert len(set(keys)) == len(keys)
    for key in keys:
        effect = effect_named(key.effect)
        assert effect.applies(model, key)
        assert (key.axis is None) == (not effect.locations)
        assert key.location in (effect.locations or ("actuator",))
    structural = {"actuator_inertia_coupling", "linkage_inertia", "linkage_gravity"}
    found = {key.effect for key in keys} & structural
    pins = {key.axis for key in keys if key.location == "joint"}
    if name == "emps":
        assert not found
        assert not pins
    else:
        assert found == structural - ({"actuator_inertia_coupling"} if name == "leg" else set())
        assert pins == {"knee"}  # the hip's pin moves as its drive does


def test_no_payload_without_a_site() -> None:
    keys = places(replace(load_model("leg"), payload_site=None))
    assert "payload_mass" not in {key.effect for key in keys}


def test_coriolis_is_the_velocity_part_of_the_linkage_inertia() -> None:
    model = load_model("leg_kin_only")
    inertia = next(c for c in CASES if c.key.effect == "linkage_inertia" and dict(c.values)["M12"] > 0)
    _, motion = midway(inertia, reference("leg_kin_only"))
    moving = equation(inertia, motion)
    still = equation(inertia, replace(motion, velocity=np.zeros_like(motion.velocity)))
    coriolis = effect_named("linkage_coriolis").response(motion, model, None, {}).offset
    assert coriolis is not None
    assert np.abs(coriolis).max() > 1e-3
    np.testing.assert_allclose(coriolis, moving - still, atol=1e-12)
    paper = replace(model, variant="s3n_full_paper")
    assert effect_named("linkage_coriolis").applies(paper, EffectKey("linkage_coriolis", None))


def test_dry_friction_sticks() -> None:
    """Half the breakaway torque leaves an axis all but at rest; without friction it would have run away."""
    model = load_model("emps")
    still = replace(slide_experiment(model, 1.0), controller=replace(model.controller, kind="none"))
    pushed = still.with_signals(torque_command=np.full((len(still), 1), 10.0))
    sticky = having(model, EffectKey("coulomb_friction", "slide"), torque=20.0)
    free, stuck = simulate([Run(model, pushed), Run(sticky, pushed)])
    assert free.position[-1, 0] > 0.04
    assert np.abs(stuck.velocity).max() < model.sliding_speed * 0.1


def test_units_follow_the_axis() -> None:
    leg = having(load_model("leg"), EffectKey("coulomb_friction", "knee"), torque=0.1)
    slide = having(load_model("emps"), EffectKey("coulomb_friction", "slide"), torque=0.1)
    assert leg.effects[-1].parameters["torque"].unit == "N*m"
    assert slide.effects[-1].parameters["torque"].unit == "N"


@every_place
def test_at_any_corner_of_its_bounds_it_builds_or_says_why_not(case: Case) -> None:
    base, place = load_model(case.model), Placement.of(load_model(case.model), case.key)
    values, shape = case.effect.parameters.to_coefficients(dict(case.values))
    lower, upper = case.effect.parameters.bounds(base, place, shape)
    limits = case.effect.parameters.shape_bounds(base, place)
    for number in product((0, 1, 2), repeat=len(values)):
        corner = [np.clip((0.0, a, b)[k], -1e3, 1e3) for k, a, b in zip(number, lower, upper, strict=True)]
        corner = np.clip(corner, lower, upper)
        for side in (None, 0, 1):
            ends = {} if side is None else {n: float(np.clip(x[side], -1e3, 1e3)) for n, x in limits.items()}
            at = {**shape, **ends}
            try:
                parameters = case.effect.parameters.to_values(corner, at)
                applied = AppliedEffect(case.key, {n: Estimate(v, 0.0, "") for n, v in parameters.items()})
                compile_plant(base.with_effect(applied), grounded=True)
            except (SimulationError, InputError) as error:
                assert str(error)
