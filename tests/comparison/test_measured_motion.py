"""A model along the measured motion: what changes it a little is what its linearisation says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.planar_leg import moved, without, write_leg
from tests.simulation.make import having
from workbench.comparison import replay_of
from workbench.core import Controller, EffectKey, Recording
from workbench.effects import compile_plant, effect_named, load_model
from workbench.models import Placement
from workbench.rigs import VirtualLeg, chirp, multisine
from workbench.simulation import Disturbance

BLIND = replace(load_model("leg"), controller=Controller())
EFFECTS = [
    (EffectKey("torque_bias", "knee"), {"torque": 0.1}),
    (EffectKey("viscous_damping", "knee", "joint"), {"damping": 0.003}),
    (EffectKey("parallel_spring", "hip"), {"stiffness": 0.4, "rest": 0.0}),
    (EffectKey("encoder_offset", "hip"), {"angle": 0.01}),
    (EffectKey("encoder_scale", "knee"), {"scale": 1.01}),
]


@pytest.fixture(scope="module")
def log() -> Recording:
    (made,) = VirtualLeg(seed=3).run([chirp("knee", duration=3.0, f_max=8.0)])
    return replace(made, controller=Controller())


@pytest.mark.parametrize(("key", "values"), EFFECTS, ids=lambda x: str(x) if isinstance(x, EffectKey) else "")
def test_a_small_effect_changes_what_its_columns_say(key: EffectKey, values: dict, log: Recording) -> None:
    replay = replay_of(BLIND, [log])
    (plain,), (more,) = replay.run([BLIND, having(BLIND, key, **values)])
    change = more.signals["torque_measured"] - plain.signals["torque_measured"]
    motion = replay.motion(compile_plant(BLIND), 0, plain)
    loop = replay.loop(compile_plant(BLIND), 0, motion)
    effect = effect_named(key.effect)
    coefficients, shape = effect.parameters.to_coefficients(values)
    made = effect.response(motion, BLIND, Placement.of(BLIND, key), shape)
    readings = {} if made.readings is None else dict(enumerate(made.readings))
    ((position, torque),) = replay.propagate([loop], [Disturbance(made.columns, readings=readings)])
    assert not position.any()
    told = torque @ coefficients
    size = np.sqrt(np.mean(change**2))
    assert size > 3e-4
    assert np.sqrt(np.mean((told - change) ** 2)) < 0.05 * size


def test_an_axis_that_stands_still_does_not_count() -> None:
    (made,) = VirtualLeg(seed=3).run([chirp("knee", duration=2.0, f_max=8.0)])
    rows = np.array(made.position)
    held = made.signals["torque_measured"] + 5.0
    rows[:, 0], rate = rows[0, 0], np.array(made.velocity)
    rate[:, 0] = 0.0
    still = replace(
        made.with_signals(position=rows, velocity=rate, torque_measured=held), controller=Controller()
    )
    (run,) = replay_of(BLIND, [still]).run([BLIND])[0]
    np.testing.assert_array_equal(run.signals["torque_measured"][:, 0], held[:, 0])


def test_half_a_row_of_timing_is_no_error(log: Recording) -> None:
    # the torque that stands until the next row, and the one that acts at the row's time on the mean
    torque = log.signals["torque_measured"]
    middle = 0.5 * (torque + np.vstack([torque[:1], torque[:-1]]))
    errors = []
    for shown in (torque, middle, np.vstack([torque[:1]] * 5 + [torque[:-5]])):
        again = log.with_signals(torque_measured=shown)
        (run,) = replay_of(BLIND, [again]).run([BLIND])[0]
        errors.append(np.sqrt(np.mean((run.signals["torque_measured"] - shown) ** 2)))
    assert errors[1] < 1.2 * errors[0] and errors[2] > 5.0 * errors[0]


def test_recordings_of_one_call_are_replayed_alike(log: Recording) -> None:
    (known,) = VirtualLeg(seed=4).run([multisine("sum", period=1.0, duration=2.0)])
    strange = replace(log, signals={k: v for k, v in log.signals.items() if k != "position_reference"})
    kinds = [r.controller.kind for r in replay_of(load_model("leg"), [known, strange]).recordings]
    assert kinds == ["unknown", "unknown"]
    kinds = [r.controller.kind for r in replay_of(load_model("leg"), [known, log]).recordings]
    assert kinds == ["pd", "pd"]


def test_a_torque_that_is_nil_is_not_held_against_the_model(tmp_path: Path) -> None:
    """A joint without a drive is logged with no effort and no noise: nothing is its floor."""
    leg = load_model(str(write_leg(tmp_path)))
    log = without(moved(), "torque_command", "position_reference")
    torque = log.signals["torque_measured"] * [1.0, 0.0]
    ((run,),) = replay_of(leg, [log.with_signals(torque_measured=torque)]).run([leg])
    rest = torque - run.signals["torque_measured"]
    assert rest[:, 0].any() and not rest[:, 1].any()
