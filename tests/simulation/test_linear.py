"""The linearised loop answers a small effect as the simulation does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.simulation.make import LEG_LOOP, having, leg_experiment, simulated
from workbench.core import Controller, EffectKey, Recording
from workbench.effects import compile_plant, effect_named, load_model
from workbench.models import Model, Placement
from workbench.simulation import Disturbance, Track, linearise, motion_of, prepare, propagate

LEG = load_model("leg")
CASCADE = Controller(
    "cascade_pv",
    "actuator",
    kp=(30.0, 30.0),
    kv=(1.4, 1.2),
    gain=(1.1, 1.0),
    limit=(50.0, 50.0),
    period_s=0.002,
)
EXPERIMENTS: dict[str, Recording] = {
    "joint loop": leg_experiment(0.8, amplitude=0.15),
    "actuator loop": leg_experiment(
        0.8, amplitude=0.15, controller=replace(LEG_LOOP, coordinates="actuator")
    ),
    "velocity from the encoder": leg_experiment(0.8, amplitude=0.15, derived=("velocity",)),
    "cascade": leg_experiment(0.8, amplitude=0.15, controller=CASCADE),
    "cascade without a velocity sensor": leg_experiment(
        0.8, amplitude=0.15, controller=CASCADE, derived=("velocity",)
    ),
    "slow log": leg_experiment(1.5, 0.005, amplitude=0.15),
    "joint coordinates": leg_experiment(0.8, amplitude=0.15),
}
MODELS = {"leg": LEG, "late leg": replace(LEG, actuators=replace(LEG.actuators, delay_s=0.0024))}
EFFECTS = [
    (EffectKey("torque_bias", "hip"), {"torque": 0.02}),
    (EffectKey("torque_bias", "knee"), {"torque": 0.02}),
    (EffectKey("reflected_inertia", "hip"), {"inertia": 1e-4}),
    (EffectKey("reflected_inertia", "knee"), {"inertia": 1e-4}),
    (EffectKey("viscous_damping", "hip"), {"damping": 2e-3}),
    (EffectKey("viscous_damping", "knee", "joint"), {"damping": 2e-3}),
    (EffectKey("command_delay", None), {"time": 2e-5}),
]


def in_joint_coordinates(recording: Recording) -> Recording:
    j = LEG.transmission
    back = np.linalg.inv(j).T
    return replace(recording, coordinates="joint").with_signals(
        position=recording.position @ back,
        velocity=recording.velocity @ back,
        torque_feedforward=recording.signals["torque_feedforward"] @ j,
    )


def experiment(name: str) -> Recording:
    asked = EXPERIMENTS[name]
    return in_joint_coordinates(asked) if name == "joint coordinates" else asked


def predicted(model: Model, asked: Recording, run: Recording) -> list[tuple[np.ndarray, np.ndarray]]:
    """Change of position and torque (N, n) by each of `EFFECTS`, by the linearised loop."""
    plant, n = compile_plant(model), model.size
    to_actuator = np.eye(n) if asked.coordinates == "actuator" else model.transmission
    h, q, w = run.period, run.position @ to_actuator.T, run.velocity @ to_actuator.T
    rise = np.diff(w, axis=0, append=2 * w[-1:] - w[-2:-1])
    # what a row's step has on average: the speed at its middle, the acceleration across it
    track = Track(q + h / 2 * w + h / 8 * rise, w + rise / 2, rise / h)
    motion = motion_of(track, asked.with_signals(**run.signals), plant, to_actuator)
    torques, taps = [], {}
    for number, (key, values) in enumerate(EFFECTS):
        effect = effect_named(key.effect)
        coefficients, shape = effect.parameters.to_coefficients(values)
        answer = effect.response(motion, model, Placement.of(model, key), shape)
        torques.append(np.tensordot(coefficients, answer.columns, axes=1))
        if answer.offset is not None:
            torques[-1] = torques[-1] + answer.offset
        if answer.tap is not None:
            taps[number] = answer.tap
    loop = linearise(plant, prepare(asked.with_signals(**run.signals), model), track)
    ((position, torque),) = propagate([loop], [Disturbance(np.stack(torques), taps)])
    return [(position[:, :, k], torque[:, :, k]) for k in range(len(EFFECTS))]


@pytest.mark.parametrize("machine", MODELS)
@pytest.mark.parametrize("name", EXPERIMENTS)
def test_small_effects_act_as_in_the_simulation(name: str, machine: str) -> None:
    model, asked = MODELS[machine], experiment(name)
    base = simulated(model, asked)
    for (key, values), (position, torque) in zip(EFFECTS, predicted(model, asked, base), strict=True):
        run = simulated(having(model, key, **values), asked)
        moved = run.position - base.position
        size = np.sqrt(np.mean(moved**2))
        assert size > 1e-9
        # a command that changes between the rows of a slow log is not known well enough for its delay
        share = 0.08 if name == "slow log" else 0.06
        assert np.sqrt(np.mean((position - moved) ** 2)) < share * size, (key, "position")
        if key.effect != "command_delay":  # its own tap is a row of impulses
            pushed = run.signals["torque_measured"] - base.signals["torque_measured"]
            wrong = np.sqrt(np.mean((torque - pushed) ** 2))
            assert wrong < 0.06 * np.sqrt(np.mean(pushed**2)), (key, "torque")


def test_an_open_loop_is_the_mechanism_alone() -> None:
    asked = leg_experiment(0.8, amplitude=0.1)
    closed = simulated(LEG, asked)
    opened = replace(asked, controller=Controller("none")).with_signals(**closed.signals)
    base = simulated(LEG, opened)
    for (key, values), (position, torque) in zip(EFFECTS[:6], predicted(LEG, opened, base), strict=False):
        moved = simulated(having(LEG, key, **values), opened).position - base.position
        assert np.sqrt(np.mean((position - moved) ** 2)) < 0.05 * np.sqrt(np.mean(moved**2)), key
        np.testing.assert_array_equal(torque, 0.0)


def test_runs_of_any_length_side_by_side() -> None:
    plant = compile_plant(LEG)
    loops, torques = [], []
    for seconds in (0.2, 0.5, 0.3):
        run = leg_experiment(seconds).with_signals(**simulated(LEG, leg_experiment(seconds)).signals)
        track = Track(run.position, run.velocity, np.gradient(run.velocity, run.period, axis=0))
        loops.append(linearise(plant, prepare(run, LEG), track))
        torques.append(Disturbance(np.random.default_rng(len(run)).normal(0, 0.1, (2, len(run), 2))))
    together = propagate(loops, torques)
    for loop, torque, (position, tap) in zip(loops, torques, together, strict=True):
        ((q, u),) = propagate([loop], [torque])
        np.testing.assert_allclose(position, q, atol=1e-14)
        np.testing.assert_allclose(tap, u, atol=1e-12)


def test_a_drive_at_its_limit_passes_nothing_on() -> None:
    weak = replace(LEG, actuators=replace(LEG.actuators, torque_limit=(1e-3, 1e-3)))
    asked = leg_experiment(0.3)
    run = asked.with_signals(**simulated(weak, asked).signals)
    track = Track(run.position, run.velocity, np.gradient(run.velocity, run.period, axis=0))
    loop = linearise(compile_plant(weak), prepare(run, weak), track)
    ((_, torque),) = propagate([loop], [Disturbance(np.full((1, len(run), 2), 0.1))])
    limited = ~loop.open
    assert limited.mean() > 0.9
    np.testing.assert_array_equal(torque[limited], 0.0)
