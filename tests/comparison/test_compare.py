"""A comparison knows the noise: a right model is consistent, a wrong one is not, and it says where."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.data_helpers import LEG as EXAMPLES
from tests.simulation.make import having, leg_experiment
from workbench.comparison import Simulated, compare, evaluate, replay_of
from workbench.core import Controller, EffectKey, InputError, Recording
from workbench.effects import load_model
from workbench.recordings import load_recordings
from workbench.rigs import Experiment, VirtualLeg

from .make import measured

LEG = load_model("leg")
UNKNOWN = replace(LEG, controller=Controller())


@cache
def logs() -> tuple[Recording, ...]:
    return tuple(measured(LEG, leg_experiment(1.5), range(20)))


def test_a_perfect_model_is_consistent_whatever_the_noise() -> None:
    results = [compare(LEG, [log], seed=k) for k, log in enumerate(logs())]
    assert all(r.consistent for r in results)
    assert all(r.where == () for r in results)
    ratios = [r.error / r.noise_error for r in results]
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.03)


def test_the_virtual_leg_is_consistent_with_the_shipped_model() -> None:
    experiments = [Experiment.replay(leg_experiment(2.0, seed=seed)) for seed in (1, 2)]
    for seed in range(3):
        assert compare(LEG, VirtualLeg(seed=seed).run(experiments)).consistent


def test_the_measured_leg_is_consistent_with_the_shipped_model() -> None:
    recordings = load_recordings(sorted((EXAMPLES / "clean").glob("*.toml")))
    result = compare(LEG, recordings)
    assert result.consistent
    assert result.error == pytest.approx(result.noise_error, rel=0.05)


WRONG = {
    "friction": (EffectKey("coulomb_friction", "knee"), {"torque": 0.1}),
    "damping": (EffectKey("viscous_damping", "hip"), {"damping": 0.05}),
    "inertia": (EffectKey("reflected_inertia", "knee"), {"inertia": 0.002}),
    "payload": (EffectKey("payload_mass", None), {"mass": 0.02}),
    "gain": (EffectKey("torque_constant_error", "hip"), {"gain": 0.95}),
    "bias": (EffectKey("torque_bias", "knee"), {"torque": 0.1}),
    "delay": (EffectKey("command_delay", None), {"time": 0.001}),
    "spring": (EffectKey("parallel_spring", "knee"), {"stiffness": 0.3, "rest": 0.0}),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_model_is_not_consistent(name: str) -> None:
    key, values = WRONG[name]
    (log,) = measured(having(LEG, key, **values), leg_experiment(1.5), range(1))
    result = compare(LEG, [log])
    assert result.error > 1.5 * result.noise_error
    assert not result.consistent
    assert result.where
    for quantity in ("speed", "position", "time", "frequency"):
        assert sum(s.share for s in result.where if s.quantity == quantity) <= 1.0 + 1e-9
    if key.axis is not None:
        largest = max((s for s in result.where if s.signal == "position"), key=lambda s: s.share)
        assert largest.axis == key.axis or key.axis == "hip"  # a push at the hip moves both


def test_where_names_the_axis_that_rubs() -> None:
    for axis in ("hip", "knee"):
        sticky = having(LEG, EffectKey("coulomb_friction", axis), torque=0.3)
        (log,) = measured(sticky, leg_experiment(2.0), range(1))
        assert compare(LEG, [log]).where[0].axis == axis


def test_where_names_the_band_of_a_tone() -> None:
    asked = leg_experiment(3.0)
    tone = 0.4 * np.sin(2 * np.pi * 20.0 * asked.time)
    pushed = asked.signals["torque_feedforward"] + np.stack([np.zeros_like(tone), tone], axis=1)
    (log,) = measured(LEG, asked.with_signals(torque_feedforward=pushed), range(1))
    hidden = log.with_signals(torque_feedforward=asked.signals["torque_feedforward"])
    shares = [s for s in compare(LEG, [hidden]).where if s.quantity == "frequency"]
    assert shares[0].axis == "knee"
    assert shares[0].unit == "Hz"
    assert shares[0].range[0] < 20.0 < shares[0].range[1]


def test_where_names_the_time_of_a_disturbance() -> None:
    asked = leg_experiment(2.0)
    pushed = asked.signals["torque_feedforward"].copy()
    pushed[1000:1200, 0] += 1.0
    (log,) = measured(LEG, asked.with_signals(torque_feedforward=pushed), range(1))
    hidden = log.with_signals(torque_feedforward=asked.signals["torque_feedforward"])
    first = next(s for s in compare(LEG, [hidden]).where if s.quantity == "time")
    assert first.axis == "hip"
    assert first.range[0] < 1.25
    assert first.range[1] > 1.0


def halves(recording: Recording) -> list[Recording]:
    middle = len(recording) // 3
    return [
        replace(
            recording,
            time=recording.time[part] - recording.time[part][0],
            signals={k: v[part] for k, v in recording.signals.items()},
            valid=None,
        )
        for part in (slice(0, middle), slice(middle, None))
    ]


def test_the_error_does_not_depend_on_order_or_cuts() -> None:
    wrong = having(LEG, EffectKey("viscous_damping", "hip"), damping=0.05)
    recordings = [measured(wrong, leg_experiment(s, seed=k), range(1))[0] for k, s in enumerate((0.6, 1.0))]
    whole = replay_of(LEG, recordings).with_noise(LEG, 0)
    result = evaluate(LEG, whole)

    def pieces(runs: tuple[Recording, ...]) -> tuple[Recording, ...]:
        return tuple(piece for run in runs[::-1] for piece in halves(run))

    cut = Simulated(
        pieces(whole.recordings), pieces(whole.clean), tuple(pieces(d) for d in whole.noisy), whole.noise
    )
    again = evaluate(LEG, cut)
    assert again.error == pytest.approx(result.error, rel=1e-12)
    assert again.noise_error == pytest.approx(result.noise_error, rel=1e-12)
    assert again.consistent == result.consistent


def test_masked_rows_do_not_count() -> None:
    log = logs()[0]
    valid = np.ones(len(log), bool)
    valid[400:500] = False
    spoilt = np.array(log.position)
    spoilt[400:500] += 0.5
    result = compare(LEG, [replace(log.with_signals(position=spoilt), valid=valid)])
    assert result.consistent
    assert not compare(LEG, [log.with_signals(position=spoilt)]).consistent


def test_a_signal_that_never_moves_is_left_out() -> None:
    log = logs()[0]
    frozen = np.array(log.position)
    frozen[:, 1] = frozen[0, 1]
    result = compare(LEG, [log.with_signals(position=frozen)])
    entry = result.recordings[0]
    deviation = np.array([log.position[:, 0].std(), *log.signals["torque_measured"].std(axis=0)])
    errors = np.array([entry.position_rmse[0], *entry.torque_rmse])
    assert result.error == pytest.approx(np.sqrt(np.mean((errors / deviation) ** 2)))
    assert result.inverse_dynamics is not None
    assert np.isfinite(result.inverse_dynamics.relative_error)


def without(recording: Recording, *names: str) -> Recording:
    return replace(recording, signals={k: v for k, v in recording.signals.items() if k not in names})


def test_without_torque_the_position_is_compared() -> None:
    bare = without(logs()[0], "torque_measured", "torque_command")
    result = compare(LEG, [bare])
    assert result.consistent
    assert np.isnan(result.recordings[0].torque_rmse).all()
    assert result.inverse_dynamics is None
    assert any("no torque" in note for note in result.notes)


def test_without_a_torque_sensor_the_command_is_compared() -> None:
    result = compare(LEG, [without(logs()[0], "torque_measured")])
    assert result.consistent
    assert result.noise_error == pytest.approx(result.error, rel=0.1)
    assert any("command is compared" in note for note in result.notes)
    late = having(LEG, EffectKey("torque_constant_error", "knee"), gain=0.9)
    assert not compare(late, [without(logs()[0], "torque_measured")]).consistent


def test_recordings_with_and_without_torque_are_pooled_apart() -> None:
    mixed = [logs()[0], *(without(log, "torque_measured", "torque_command") for log in logs()[1:4])]
    result = compare(LEG, mixed)
    assert result.consistent
    assert result.noise_error == pytest.approx(compare(LEG, list(logs()[:4])).noise_error, rel=0.05)


def with_unknown_loop(recording: Recording) -> Recording:
    return replace(recording, controller=Controller())


def test_an_unknown_loop_is_compared_by_inverse_dynamics() -> None:
    recordings = [with_unknown_loop(log) for log in logs()[:3]]
    result = compare(UNKNOWN, recordings)
    assert result.consistent
    assert result.error < 0.03
    assert np.isnan(result.recordings[0].position_rmse).all()  # it says nothing of the model
    assert result.inverse_dynamics is not None
    assert result.inverse_dynamics.relative_error < 0.03
    heavy = having(UNKNOWN, EffectKey("reflected_inertia", "knee"), inertia=0.003)
    wrong = compare(heavy, recordings)
    assert not wrong.consistent
    assert wrong.recordings[0].torque_rmse[1] > 3 * wrong.recordings[0].torque_noise[1]
    assert wrong.where[0].axis == "knee"


def test_inverse_dynamics_in_joints_is_the_same_comparison() -> None:
    log, j = logs()[0], LEG.transmission
    back = np.linalg.inv(j).T
    joint = replace(log, coordinates="joint").with_signals(
        position=log.position @ back,
        velocity=log.velocity @ back,
        torque_measured=log.signals["torque_measured"] @ j,
        torque_command=log.signals["torque_command"] @ j,
    )
    first, second = compare(UNKNOWN, [with_unknown_loop(log)]), compare(UNKNOWN, [with_unknown_loop(joint)])
    assert first.inverse_dynamics is not None
    assert second.inverse_dynamics is not None
    assert second.inverse_dynamics.relative_error == pytest.approx(
        first.inverse_dynamics.relative_error, rel=0.5
    )
    assert second.consistent
    residual = first.recordings[0].residual("torque_measured") @ j
    np.testing.assert_allclose(second.recordings[0].residual("torque_measured"), residual, atol=0.15)


def test_a_loop_that_the_recording_does_not_state_is_the_models() -> None:
    result = compare(LEG, [with_unknown_loop(logs()[0])])
    assert result.consistent
    assert result.recordings[0].position_rmse.min() > 0


def test_what_cannot_be_compared_is_refused() -> None:
    log = logs()[0]
    with pytest.raises(InputError, match="no recordings"):
        compare(LEG, [])
    with pytest.raises(InputError, match=r"'ankle'.*hip, knee"):
        compare(LEG, [replace(log, axes=("hip", "ankle"))])
    with pytest.raises(InputError, match=r"'knee' of model 'leg' turns.*a length.*\"rad\""):
        compare(LEG, [replace(log, units=("rad", "m"))])
    one = {name: values[:, :1] for name, values in log.signals.items()}
    with pytest.raises(InputError, match=r"'slide' of model 'emps' moves along a line.*an angle.*\"mm\""):
        compare(load_model("emps"), [replace(log, axes=("slide",), units=("rad",), signals=one)])
    bare = without(with_unknown_loop(log), "torque_measured", "torque_command")
    with pytest.raises(InputError, match="neither the loop nor a torque"):
        compare(UNKNOWN, [bare])


def test_a_handful_of_rows_is_refused() -> None:
    log = logs()[0]
    for rows in (2, 5, 29):
        few = replace(
            log,
            time=log.time[:rows],
            valid=log.valid[:rows],
            signals={name: values[:rows] for name, values in log.signals.items()},
        )
        with pytest.raises(InputError, match=f"{rows} rows are too few"):
            compare(LEG, [few])
