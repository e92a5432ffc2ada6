"""A run is what the recording's machine would have done, whatever runs beside it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import workbench.simulation.steps as settings_of_steps
from tests.bench_arm import bench_arm, logged
from tests.data_helpers import LEG as EXAMPLES
from tests.models.make import machine_file
from tests.simulation.make import LEG_LOOP, having, leg_experiment, simulated, slide_experiment
from workbench.comparison import NoiseModel
from workbench.core import Controller, EffectKey, InputError, Recording, SimulationError
from workbench.effects import load_model
from workbench.models import Model
from workbench.recordings import load_recordings
from workbench.rigs import PERFECT, Experiment, VirtualLeg
from workbench.simulation import Run, SensorNoise, prepare, simulate

LEG, TREE, EMPS = load_model("leg"), load_model("leg_kin_only"), load_model("emps")
STICKY = having(LEG, EffectKey("coulomb_friction", "knee"), torque=0.2)
CURVED = having(LEG, EffectKey("stribeck_friction", "hip"), coulomb=0.1, static=0.2, speed=0.3)
LATE = having(LEG, EffectKey("command_delay", None), time=0.0017)
ENCODER = 2 * np.pi / 2**14


def test_the_shipped_leg_is_the_measured_one_up_to_noise() -> None:
    files = sorted((EXAMPLES / "clean").glob("*.toml"))
    recordings = load_recordings(files)
    for measured, run in zip(recordings, simulate([Run(LEG, r) for r in recordings]), strict=True):
        for signal, noise in (("position", 1.8e-4), ("velocity", 0.019), ("torque_measured", 0.075)):
            rms = np.sqrt(np.mean((measured.signals[signal] - run.signals[signal]) ** 2, axis=0))
            assert (rms < noise).all(), (measured.name, signal, rms)


def test_the_virtual_leg_without_noise_is_the_model() -> None:
    """An independent integrator of the same leg, sampled loop and delay: they agree to rounding."""
    asked = leg_experiment(1.0)
    experiment = Experiment.replay(asked)
    (measured,) = VirtualLeg(sensors=PERFECT).run([experiment])
    run = simulated(LEG, measured)
    np.testing.assert_allclose(run.position, measured.position, atol=1e-6)
    np.testing.assert_allclose(run.velocity, measured.velocity, atol=1e-4)
    for signal in ("torque_command", "torque_measured"):
        np.testing.assert_allclose(run.signals[signal], measured.signals[signal], atol=2e-4)


@pytest.mark.parametrize(("model", "tolerance"), [(LEG, 1e-8), (LATE, 1e-5), (STICKY, 0.25 * ENCODER)])
def test_the_step_is_fine_enough(model: Model, tolerance: float, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = leg_experiment(0.6)
    coarse = simulated(model, asked)
    monkeypatch.setattr(settings_of_steps, "LONGEST_STEP", 0.0001)
    assert prepare(asked, model).stride == 10
    fine = simulated(model, asked)
    difference = coarse.position - fine.position
    assert np.sqrt(np.mean(difference**2)) < tolerance
    assert np.abs(difference).max() < 6 * tolerance


def test_a_delay_of_any_fraction_shifts_the_torque() -> None:
    """Open loop: the impulse that reached the mechanism is the command's, late by exactly the delay."""
    model = load_model("emps")
    pulse = np.zeros((400, 1))
    pulse[50:150] = 40.0
    base = slide_experiment(model, 0.399)
    open_loop = replace(base, controller=Controller("none"))
    speeds = {}
    for delay in (0.0, 0.0004, 0.001, 0.0137):
        late = having(model, EffectKey("command_delay", None), time=delay)
        run = simulated(late, open_loop.with_signals(torque_command=pulse))
        speeds[delay] = run.velocity[:, 0]
        at = np.flatnonzero(run.signals["torque_measured"][:, 0])
        assert at[0] == 50 + int(np.ceil(delay / 0.001 - 1e-9))
        np.testing.assert_array_equal(run.signals["torque_command"], pulse)
    t = base.time
    for delay, speed in speeds.items():
        ramp = 40.0 / 95.1 * np.clip(t - 0.05 - delay, 0, 0.1)
        np.testing.assert_allclose(speed, ramp, atol=1e-9)


@pytest.mark.parametrize("tap", ["torque_command", "torque_measured", "loop"])
def test_an_open_loop_replays_the_torque_with_its_delay(tap: str) -> None:
    slow_drive = replace(EMPS, actuators=replace(EMPS.actuators, delay_s=0.007))
    late = having(slow_drive, EffectKey("command_delay", None), time=0.004)
    pulse = np.zeros((400, 1))
    pulse[50:150] = 40.0
    asked = replace(slide_experiment(EMPS, 0.399), controller=Controller("none"))
    truth = simulated(late, asked.with_signals(torque_command=pulse))
    if tap == "loop":  # the command as it left the drive's own delay behind
        seen = np.roll(pulse, 7, axis=0)
        given = replace(asked, timing=replace(asked.timing, delay="loop")).with_signals(torque_command=seen)
    else:
        given = asked.with_signals(**{tap: truth.signals[tap]})
    run = simulated(late, given)
    np.testing.assert_allclose(run.position, truth.position, atol=1e-9)
    np.testing.assert_array_equal(run.signals["torque_measured"], truth.signals["torque_measured"])


def test_joint_coordinates_are_the_same_experiment() -> None:
    asked = leg_experiment(0.5)
    j = LEG.transmission
    back = np.linalg.inv(j)
    names = {"position": back, "velocity": back, "torque_feedforward": j.T}
    joint = replace(asked, coordinates="joint").with_signals(
        **{name: asked.signals[name] @ matrix.T for name, matrix in names.items()}
    )
    first, second = simulate([Run(LEG, asked), Run(LEG, joint)])
    np.testing.assert_allclose(second.position, first.position @ back.T, atol=1e-12)
    np.testing.assert_allclose(second.velocity, first.velocity @ back.T, atol=1e-11)
    np.testing.assert_allclose(
        second.signals["torque_measured"], first.signals["torque_measured"] @ j, atol=1e-10
    )


def test_a_joint_loop_is_an_actuator_loop_with_coupled_gains() -> None:
    """tau_p = J^-T tau_s: with equal gains at the joints the command follows by hand at the first tick."""
    asked = leg_experiment(0.4)
    run, reference, k = simulated(LEG, asked), asked.signals["position_reference"], 120
    error = reference[k] - np.linalg.solve(LEG.transmission, run.position[k])
    rate = np.linalg.solve(LEG.transmission, run.velocity[k])
    by_hand = np.linalg.solve(LEG.transmission.T, 50 * error - 1.5 * rate)
    by_hand += asked.signals["torque_feedforward"][k]
    np.testing.assert_allclose(run.signals["torque_command"][k], by_hand, atol=1e-10)
    np.testing.assert_array_equal(
        run.signals["torque_command"][k : k + 3], run.signals["torque_command"][[k] * 3]
    )


def test_feedforward_is_held_between_ticks_or_acts_by_row() -> None:
    asked = leg_experiment(0.4)
    per_row = replace(asked, timing=replace(asked.timing, feedforward_held=False))
    held, free = (simulated(LEG, r).signals["torque_command"] for r in (asked, per_row))
    ramp = asked.signals["torque_feedforward"]
    np.testing.assert_allclose(np.diff(held[120:123], axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.diff(free[120:123], axis=0), np.diff(ramp[120:123], axis=0), atol=1e-12)


def test_a_log_behind_the_delay_shows_the_late_command() -> None:
    asked = leg_experiment(0.4)
    late = replace(asked, timing=replace(asked.timing, delay="loop"))
    first, second = simulate([Run(LEG, asked), Run(LEG, late)])
    np.testing.assert_array_equal(first.position, second.position)
    np.testing.assert_array_equal(second.signals["torque_command"][3:], first.signals["torque_command"][:-3])


def test_the_drive_clips_what_it_cannot_give() -> None:
    weak = replace(LEG, actuators=replace(LEG.actuators, torque_limit=(2.0, 1.5)))
    run = simulated(weak, leg_experiment(0.6))
    command, torque = run.signals["torque_command"], run.signals["torque_measured"]
    assert (np.abs(command).max(axis=0) > [2.5, 2.0]).all()
    np.testing.assert_allclose(torque[3:], np.clip(command[:-3], [-2.0, -1.5], [2.0, 1.5]), atol=1e-12)
    free = simulated(LEG, leg_experiment(0.6))
    assert np.abs(free.position - run.position).max() > 0.01


def test_masked_rows_are_simulated_like_any_others() -> None:
    asked = leg_experiment(0.3)
    valid = np.ones(len(asked), bool)
    valid[100:150] = False
    first, second = simulate([Run(LEG, asked), Run(LEG, replace(asked, valid=valid))])
    np.testing.assert_array_equal(first.position, second.position)
    np.testing.assert_array_equal(second.valid, valid)


def test_a_run_starts_where_the_log_starts() -> None:
    asked = leg_experiment(0.5)
    moving = simulated(LEG, asked)
    cut = replace(
        asked,
        time=asked.time[:200],
        signals={k: v[200:400] for k, v in {**asked.signals, **moving.signals}.items()},
        timing=replace(asked.timing, initial_at_rest=False),
        valid=None,
    )
    run = simulated(LEG, cut)
    assert np.abs(moving.velocity[200]).max() > 0.3
    np.testing.assert_allclose(run.velocity[0], moving.velocity[200], atol=0.05)
    np.testing.assert_allclose(run.position[0], moving.position[200], atol=1e-3)


UNLIMITED = replace(LEG, actuators=replace(LEG.actuators, torque_limit=(np.inf, np.inf)))


def test_an_unstable_loop_is_named() -> None:
    wild = leg_experiment(3.0, controller=replace(LEG_LOOP, kp=(5e4, 5e4), kd=(400.0, 400.0)), name="wild")
    with pytest.raises(SimulationError, match=r"'leg'.*unstable.*'wild'.* s; check") as caught:
        simulate([Run(LEG, leg_experiment(0.1)), Run(UNLIMITED, wild)])
    assert "\n" not in str(caught.value)
    good, bad = simulate([Run(LEG, leg_experiment(0.1)), Run(UNLIMITED, wild)], strict=False)
    assert np.isfinite(good.position).all()
    assert np.isnan(bad.position[-1]).all()


def test_what_cannot_be_run_is_refused() -> None:
    asked = leg_experiment(0.1)
    with pytest.raises(InputError, match=r"'ankle'.*hip, knee"):
        simulated(LEG, replace(asked, axes=("hip", "ankle")))
    with pytest.raises(InputError, match="in this order"):
        simulated(LEG, replace(asked, axes=("knee", "hip")))
    bare = replace(asked, signals={"position": asked.position})
    with pytest.raises(InputError, match="position_reference"):
        simulated(LEG, bare)
    with pytest.raises(InputError, match="torque_command"):
        simulated(LEG, replace(bare, controller=Controller("none")))


NOISE = SensorNoise(np.full(2, ENCODER), np.zeros(2), np.full(2, 0.01), np.full(2, 0.02), seed=3)
SOLO = [
    Run(LEG, leg_experiment(0.30, seed=1)),
    Run(LEG, leg_experiment(0.12, seed=2), NOISE),
    Run(STICKY, leg_experiment(0.21, seed=3)),
    Run(CURVED, leg_experiment(0.17, seed=4), NOISE),
    Run(LATE, leg_experiment(0.3, period=0.005, seed=5)),
    Run(LEG, leg_experiment(0.2, period=0.004, seed=6, controller=replace(LEG_LOOP, period_s=0.002))),
    Run(EMPS, slide_experiment(EMPS, 0.2)),
    Run(
        load_model("leg_kin_only"), leg_experiment(0.1, controller=replace(LEG_LOOP, coordinates="actuator"))
    ),
    Run(UNLIMITED, replace(leg_experiment(0.15), derived=("velocity",))),
]
ALONE: dict[int, Recording] = {}


@settings(max_examples=12, deadline=None)
@given(st.lists(st.integers(0, len(SOLO) - 1), min_size=2, max_size=6))
def test_runs_side_by_side_are_the_runs_one_by_one(chosen: list[int]) -> None:
    together = simulate([SOLO[i] for i in chosen])
    for i, run in zip(chosen, together, strict=True):
        alone = ALONE.setdefault(i, simulate([SOLO[i]])[0])
        for name, values in run.signals.items():
            # an edge inside a step is accounted for where the controllers of all runs next meet
            np.testing.assert_allclose(values, alone.signals[name], atol=1e-6)


def test_machines_of_any_kind_run_side_by_side(tmp_path: Path) -> None:
    """Two trees of three joints that differ in nothing but numbers, and the leg."""
    first = load_model(machine_file(tmp_path))
    text = first.serial.read_text().replace("0 0 -9.81", "0 0 -1.62").replace('mass="0.6"', 'mass="0.9"')
    (tmp_path / "moon.xml").write_text(text)
    second = load_model(tmp_path / "moon.xml")
    t = np.arange(201) * 0.001
    push = np.stack([5 * np.sin(20 * t), np.cos(15 * t), np.sin(9 * t)], axis=1)
    base = Recording(
        name="push", axes=first.axes, coordinates="actuator", time=t, units=("m", "rad", "m"),
        signals={"position": np.zeros((201, 3)), "torque_command": push}, controller=Controller("none"),
    )  # fmt: skip
    runs = [Run(first, base), Run(LEG, leg_experiment(0.1)), Run(second, base)]
    for run, together in zip(runs, simulate(runs), strict=True):
        np.testing.assert_array_equal(together.position, simulate([run])[0].position)
    earth, _, moon = simulate(runs)
    assert np.abs(earth.position - moon.position).max() > 1e-3


def test_sensor_noise_goes_round_the_loop() -> None:
    asked = leg_experiment(0.5)
    clean, noisy, again = simulate([Run(LEG, asked), Run(LEG, asked, NOISE), Run(LEG, asked, NOISE)])
    np.testing.assert_array_equal(noisy.position, again.position)
    np.testing.assert_allclose(noisy.position / ENCODER, np.round(noisy.position / ENCODER), atol=1e-6)
    j = np.linalg.inv(LEG.transmission)
    k = 300
    change = {name: noisy.signals[name][k] - clean.signals[name][k] for name in noisy.signals}
    by_hand = -j.T @ (1.5 * j @ change["velocity"] + 50 * j @ change["position"])
    np.testing.assert_allclose(change["torque_command"], by_hand, atol=1e-9)
    assert NoiseModel.of([noisy]).levels.position_resolution == pytest.approx(ENCODER)


def test_what_cannot_be_compiled_is_raised_or_left_out() -> None:
    play, log = having(LEG, EffectKey("backlash", "knee"), gap=0.01, stiffness=300.0), leg_experiment(0.1)
    *others, loose = play.effects
    inside_out = {**loose.parameters, "gap": replace(loose.parameters["gap"], value=-0.01)}
    broken = replace(play, effects=(*others, replace(loose, parameters=inside_out)))
    with pytest.raises(SimulationError, match="cannot be compiled"):
        simulate([Run(LEG, log), Run(broken, log)])
    made, lost = simulate([Run(LEG, log), Run(broken, log)], strict=False)
    assert np.isfinite(made.position).all() and np.isnan(lost.signals["torque_measured"]).all()


@pytest.mark.parametrize(
    ("name", "axis", "values"),
    [("command_delay", None, {"time": 0.005}), ("current_loop_lag", "lift", {"time_constant": 0.004})],
)
def test_a_loop_that_ran_before_the_first_row_holds_the_machine(
    tmp_path: Path, name: str, axis: str | None, values: dict[str, float]
) -> None:
    """What was measured in the first row was commanded before it; with drives that were off it falls."""
    model = having(load_model(bench_arm(tmp_path)), EffectKey(name, axis), **values)
    asked = logged(bench_arm(tmp_path), ([], [], []), seconds=4.0)
    rest = simulated(model, asked)
    still = {signal: np.tile(rest.signals[signal][-1], (len(asked), 1)) for signal in rest.signals}
    still["position"] = still["position"] + np.random.default_rng(0).normal(0.0, 1e-8, (len(asked), 3))
    held = asked.with_signals(**still, position_reference=np.zeros((len(asked), 3)))
    off = held.with_signals(torque_measured=np.zeros((len(asked), 3)))
    moved = [np.abs(simulated(model, r).position - held.position).max() for r in (held, off)]
    assert moved[0] < 1e-6 and moved[1] > 1e-4
