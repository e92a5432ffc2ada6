"""What responses and residuals say of a hidden effect, in numbers that are the truth; of nothing, nothing."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.bench_arm import bench_arm, logged
from tests.data_helpers import two_mass
from workbench.comparison import NoiseModel, followed, replay_of
from workbench.core import EffectKey
from workbench.diagnosis.evidence.frequency_response import (
    Responses,
    delay_line,
    distortion_lines,
    gain_line,
    resonance_lines,
    response_lines,
    responses,
)
from workbench.diagnosis.evidence.missing_torque import Missing, missing_torque
from workbench.diagnosis.evidence.relations import relation_lines, relations
from workbench.diagnosis.evidence.residual_evidence import finding_lines
from workbench.effects import load_model
from workbench.frf import multisine as design_multisine
from workbench.models import AppliedEffect, Model
from workbench.recordings import load_recording, noise_levels
from workbench.rigs import Experiment, HiddenEffect, VirtualLeg, chirp, multisine, slow_sweep
from workbench.rigs.experiments import HOLD

DELAY = HiddenEffect("command_delay", parameters={"time": 0.0007})
GAIN = HiddenEffect("torque_constant_error", "knee", parameters={"gain": 0.85})
FRICTION = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.25})
COMPLIANCE = HiddenEffect("joint_compliance", "knee", "joint", {"stiffness": 60.0, "damping": 0.09})


_KEPT: dict[str, Any] = {}


def kept(make: Callable[..., Any]) -> Callable[..., Any]:
    """Remember by what is hidden, which cannot be hashed."""

    def remembered(*words: object) -> Any:
        key = f"{make.__name__}{words}"
        if key not in _KEPT:
            _KEPT[key] = make(*words)
        return _KEPT[key]

    return remembered


def run(hidden: HiddenEffect | None, experiments: Sequence[Experiment], seed: int = 3):
    """Recordings and the model's runs of them, with the sensors' levels."""
    made = VirtualLeg([hidden] if hidden else [], seed=seed).run(list(experiments))
    simulated = replay_of(load_model("leg"), made).with_noise(load_model("leg"), 0)
    return made, simulated.clean, simulated.noise.levels


@kept
def periodic(hidden: HiddenEffect | None, seed: int = 3) -> Responses:
    experiments = [multisine(m, period=2.5, duration=7.5) for m in ("sum", "difference")]
    measured, modelled, _ = run(hidden, experiments, seed)
    found = responses(measured, modelled)
    assert found is not None
    return found


@kept
def torque(hidden: HiddenEffect | None, seed: int = 3) -> Missing:
    experiments = [multisine("sum", duration=6.0), chirp("knee", duration=5.0), slow_sweep(duration=8.0)]
    measured, modelled, levels = run(hidden, experiments, seed)
    missing = missing_torque(load_model("leg"), measured, modelled, levels)
    assert missing is not None
    return missing


def odd(hidden: HiddenEffect | None) -> Responses:
    """A set that leaves lines silent; the friction of the virtual leg then shows at them."""
    design = design_multisine(
        ("hip", "knee"), f_min_hz=0.5, f_max_hz=40.0, period_s=2.001, rate_hz=1000.0, rms=(0.9, 0.54),
        grid="odd_random", periods=3, hold=tuple(HOLD), seed=1,
    )  # fmt: skip
    experiments = []
    for k, trial in enumerate(design.trials):
        _, signals = design.play(k)
        push, reference = signals["torque_feedforward"], signals["position_reference"]
        experiments.append(Experiment(trial.name, reference, push, design.excitation(k)))
    measured, modelled, _ = run(hidden, experiments)
    found = responses(measured, modelled)
    assert found is not None
    return found


def number(text: str, before: str = r"") -> tuple[float, float]:
    """The first "value ± half" behind some words."""
    match = re.search(before + r".*?([\d.]+) ± ([\d.]+)", text)
    assert match, text
    return float(match[1]), float(match[2])


def test_a_delay_is_a_phase_in_proportion_to_frequency() -> None:
    (line,) = delay_line(periodic(DELAY), None, "input")
    late, half = number(line, "delay of")
    assert abs(late - 0.7) < 2 * half < 0.05 and gain_line(periodic(DELAY), "knee", "input") == []


def test_a_gain_alone_is_flat() -> None:
    (line,) = gain_line(periodic(GAIN), "knee", "input")
    gain, half = number(line)
    assert gain == pytest.approx(0.85, abs=0.005) and half < 0.01
    assert delay_line(periodic(GAIN), "knee", "input") == gain_line(periodic(GAIN), "hip", "input") == []


def test_lines_above_half_the_rate_of_a_loop_say_nothing() -> None:
    found = periodic(DELAY)
    assert found.real.frequency.max() > 20.0
    slow = [replace(r, controller=replace(r.controller, period_s=1 / 40)) for r in found.measured]
    cut = responses(slow, found.modelled)
    assert cut is not None
    assert cut.real.frequency.max() < 20.0
    np.testing.assert_allclose(cut.real.frequency, cut.model.frequency)


def test_a_soft_joint_is_a_pair_that_the_model_has_not() -> None:
    (line,) = resonance_lines(periodic(COMPLIANCE), None)
    assert line.startswith("knee has")
    low, high = number(line, "anti-resonance")[0], number(line, "a resonance")[0]
    # seen from its drive, the links on their spring: M22 of the links is 0.00748 kg m^2
    assert low == pytest.approx(np.sqrt(60.0 / 0.00748) / (2 * np.pi), rel=0.1)
    assert high == pytest.approx(low * np.sqrt(1 + 0.00748 / 0.0162), rel=0.1)
    assert delay_line(periodic(COMPLIANCE), None, "input") == []


def test_a_measured_coupling_is_a_pair_no_rigid_model_has(tmp_path: Path) -> None:
    model, recording = two_mass(tmp_path)
    measured = load_recording(recording)
    run_of_it = replay_of(load_model(model), (measured,)).with_noise(load_model(model), 0, 2).clean
    found = responses([measured], run_of_it)
    assert found is not None
    (line,) = resonance_lines(found, "motor")
    assert number(line, "anti-resonance")[0] == pytest.approx(53.0, abs=1.5)
    assert number(line, "a resonance")[0] == pytest.approx(77.0, abs=1.5)


def test_friction_is_odd_distortion_and_an_even_effect_is_not() -> None:
    lines = distortion_lines(odd(FRICTION), None)
    assert lines and lines[0].startswith("odd distortion")
    assert "motion of knee" in lines[0] and "dry friction or backlash" in lines[0]
    assert float(re.findall(r"([\d.]+) %", lines[0])[0]) > 3 * float(re.findall(r"([\d.]+) %", lines[0])[1])
    assert distortion_lines(odd(None), None) == []


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_right_model_brings_no_line(seed: int) -> None:
    found = periodic(None, seed)
    for axis in (None, "hip", "knee"):
        for side in ("input", "output"):
            assert delay_line(found, axis, side) == gain_line(found, axis, side) == []
    assert resonance_lines(found, None) == []
    assert relations(torque(None, seed), "hip") == relations(torque(None, seed), "knee") == ()


def test_friction_and_stiffness_pass_for_no_delay_or_gain() -> None:
    found = periodic(FRICTION)
    assert delay_line(found, "knee", "input") == gain_line(found, "knee", "input") == []


def test_only_what_concerns_an_effect_is_said_of_it() -> None:
    found = periodic(DELAY)
    assert response_lines(found, EffectKey("command_delay", None))
    assert response_lines(found, EffectKey("viscous_damping", "knee")) == []


def test_long_chirps_do_as_well() -> None:
    measured, modelled, _ = run(DELAY, [chirp("hip", duration=24.0), chirp("knee", duration=24.0)])
    found = responses(measured, modelled)
    assert found is not None
    late, half = number(delay_line(found, None, "input")[0], "delay of")
    assert abs(late - 0.7) < 2.5 * half < 0.2


def test_recordings_without_a_response_say_nothing() -> None:
    measured, modelled, _ = run(DELAY, [multisine("sum", period=2.5, duration=5.0), slow_sweep(duration=3.0)])
    assert responses(measured, modelled) is None  # one experiment for two drives


@pytest.mark.parametrize(
    ("hidden", "quantity", "size"),
    [
        (FRICTION, "the sign of speed", 0.25),
        (GAIN, "the load", 1 / 0.85 - 1),
        (HiddenEffect("viscous_damping", "knee", parameters={"damping": 0.15}), "speed", 0.15),
        (HiddenEffect("reflected_inertia", "knee", parameters={"inertia": 0.008}), "acceleration", 0.008),
        (
            HiddenEffect("parallel_spring", "knee", parameters={"stiffness": 2.0, "rest": 0.2}),
            "position",
            2.0,
        ),
        (
            HiddenEffect("cogging", "knee", parameters={"torque": 0.3, "order": 12.0, "phase": 0.4}),
            "a sine of position, 12 periods per revolution",
            0.3,
        ),
    ],
    ids=lambda x: getattr(x, "effect", ""),
)
def test_the_missing_torque_goes_with_its_cause(hidden: HiddenEffect, quantity: str, size: float) -> None:
    first = relations(torque(hidden), "knee")[0]
    assert (first.quantity, first.p <= 0.01, first.share > 0.8) == (quantity, True, True)
    assert first.size == pytest.approx(size, rel=0.12)
    assert relations(torque(hidden), "hip") == ()
    assert f"proportional to {quantity}" in relation_lines("knee", [first])[0]


def test_a_torque_at_the_joint_is_seen_in_joint_coordinates() -> None:
    hidden = HiddenEffect("viscous_damping", "knee", "joint", {"damping": 0.15})
    first = relations(torque(hidden).in_joints(load_model("leg").transmission), "knee")[0]
    assert first.quantity == "speed" and first.size == pytest.approx(0.15, rel=0.1)


def test_noise_goes_with_nothing_more_often_than_it_says() -> None:
    """Slow noise, as a loop leaves it: of thirty residuals at most a few show something."""
    like, hits = torque(None), 0
    n = len(like.torque)
    for seed in range(30):
        drift = np.cumsum(np.random.default_rng(seed).normal(size=(n, 2)), axis=0)
        slow = drift - np.stack([np.convolve(c, np.ones(40) / 40, "same") for c in drift.T], axis=1)
        noise = Missing(**{**vars(like), "torque": slow - slow.mean(axis=0)})
        hits += bool(relations(noise, "knee"))
    assert hits <= 3


def test_it_costs_little() -> None:
    """Five recordings of 10 s at 1 kHz in less than half a second of one core."""
    experiments = [multisine(m, duration=10.0) for m in ("sum", "difference")]
    made = VirtualLeg([FRICTION], seed=3).run(experiments)
    measured = [*made, *(replace(r, name=f"{r.name}_again") for r in made), replace(made[0], name="more")]
    levels = NoiseModel.of(measured).levels

    def cost() -> float:
        start = time.process_time()
        found = responses(measured, measured)
        missing = missing_torque(load_model("leg"), measured, measured, levels)
        assert found is not None and missing is not None
        response_lines(found, EffectKey("coulomb_friction", "knee"))
        relations(missing, "knee")
        return time.process_time() - start

    assert min(cost() for _ in range(3)) < 0.5


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.50, "the next best, asymmetric friction on the knee drive, removes 50.0 %"), (0.66, "simpler than ")],
)
def test_a_richer_explanation_that_removes_more_is_no_next_best(share: float, said: str) -> None:
    key, other = EffectKey("coulomb_friction", "knee"), EffectKey("asymmetric_friction", "knee")
    ranking = ((other, share), (key, 0.632))
    lines = finding_lines(stage_of(ranking, load_model("leg")), AppliedEffect(key, {}))
    assert any(line.startswith(said) for line in lines)


def test_what_was_settled_with_a_finding_is_said_beside_it() -> None:
    key = EffectKey("backlash", "knee")
    damped = replace(load_model("leg"), flank_retardation_s=1.9e-3)
    for model, said in ((damped, True), (load_model("leg"), False)):
        lines = finding_lines(stage_of(((key, 0.9),), model), AppliedEffect(key, {}))
        assert any("flanks are damped by 1.9 ms" in line for line in lines) is said


def stage_of(ranking: tuple[tuple[EffectKey, float], ...], model: Model) -> Any:
    """As much of a stage as lines are made of."""
    fit = SimpleNamespace(hypothesis=SimpleNamespace(model=model))
    return SimpleNamespace(
        by_holdout=True, folds=(1, 1), removed_share=0.632, ranking=ranking, indistinguishable=(), fit=fit
    )


def test_what_nothing_drives_lacks_no_torque_by_its_load(tmp_path: Path) -> None:
    """All that is lacking where no torque is measured is what the model needs there."""
    model, log = load_model(bench_arm(tmp_path)), logged(bench_arm(tmp_path), seconds=3.0)
    undriven = log.with_signals(
        **{name: log.signals[name] * [1.0, 1.0, 0.0] for name in ("torque_command", "torque_measured")}
    )
    replay = replay_of(model, followed([undriven]))
    missing = missing_torque(model, [undriven], replay.run([model])[0], noise_levels(undriven))
    assert missing is not None and np.ptp(missing.load[:, :2], axis=0).min() > 0.1
    assert not missing.load[:, 2].any() and np.ptp(missing.torque[:, 2]) > 1.0
