"""Effects against an independent simulator: the same motion without noise, the same parameters with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from tests.simulation.make import having, leg_experiment, simulated
from workbench.comparison import replay_of, scored_signals
from workbench.core import EffectKey, Estimate, Recording
from workbench.diagnosis.data import gather
from workbench.diagnosis.fitting.fit import fit
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.effects import effect_named, load_model
from workbench.models import AppliedEffect, Model
from workbench.rigs import PERFECT, Experiment, HiddenEffect, Plate, VirtualLeg, plate_experiments

LEG, ON_PLATE = load_model("leg"), load_model("leg_on_plate")


@dataclass(frozen=True)
class Hidden:
    """An effect in the virtual leg.

    `alike`: error of the model's motion over what the effect changes. `near`: error of each parameter
    over its value that is accepted, beside four deviations. `start`: where a fit starts, over the truth.
    `rig`: what the virtual leg has beside, which the model states as its own property.
    """

    effect: str
    axis: str | None
    values: Mapping[str, float]
    location: str = "actuator"
    alike: float = 1e-3
    near: float = 0.03
    start: Mapping[str, float] = field(default_factory=dict)
    model: Model = LEG
    rig: Mapping[str, float] = field(default_factory=dict)

    @property
    def key(self) -> EffectKey:
        return EffectKey(self.effect, self.axis, "joint" if self.location == "joint" else "actuator")

    def recorded(self, asked: list[Recording], *, noisy: bool, hidden: bool = True) -> list[Recording]:
        there = (
            (HiddenEffect(self.effect, self.axis, self.key.location, {**self.values, **self.rig}),)
            if hidden
            else ()
        )
        plate = (Plate() if noisy else Plate(noise=0.0)) if self.model is ON_PLATE else None
        leg = VirtualLeg(there, seed=3, sensors=None if noisy else PERFECT, plate=plate)
        if plate:
            return leg.run(plate_experiments(duration=1.0)[-2:][: len(asked)])
        return leg.run([Experiment.replay(r) for r in asked])

    def run(self, model: Model, measured: Recording) -> tuple[Recording, Recording]:
        """What was measured and what a model makes of it, with the signals that are scored."""
        if self.model is ON_PLATE:
            replay = replay_of(model, [measured])
            return replay.recordings[0], replay.run([model])[0][0]
        return measured, simulated(model, measured)

    def __str__(self) -> str:
        return str(self.key)


HIDDEN = [
    Hidden("torque_saturation", "knee", {"limit": 1.5}),
    Hidden(
        "speed_torque_limit",
        "hip",
        {"stall_torque": 5.0, "no_load_speed": 8.0},
        start={"stall_torque": 1.03, "no_load_speed": 1.05},
        model=replace(LEG, actuators=replace(LEG.actuators, full_braking=True)),
    ),
    Hidden("quadratic_drag", "knee", {"drag": 0.03}, "joint"),
    Hidden("load_dependent_friction", "hip", {"torque": 0.1, "ratio": 0.08}, alike=0.03, near=0.05),
    Hidden("cogging", "knee", {"torque": 0.15, "order": 6.0, "phase": 0.4}, start={"order": 1.01}),
    Hidden("encoder_offset", "knee", {"angle": 0.05}),
    Hidden("encoder_scale", "hip", {"scale": 1.05}, near=0.01),
    Hidden("encoder_eccentricity", "knee", {"amplitude": 0.03, "phase": 0.7}),
    Hidden("sensor_delay", None, {"time": 0.0017}),
    Hidden("velocity_filter_lag", "knee", {"time_constant": 0.004}),
    Hidden("current_loop_lag", "hip", {"time_constant": 0.003}, alike=2e-3),
    Hidden("thermal_derating", "hip", {"coefficient": 0.02, "time_constant": 1.0}, near=0.05),
    Hidden("presliding_hysteresis", "knee", {"torque": 0.2, "stiffness": 40.0}, alike=5e-3),
    Hidden("joint_compliance", "knee", {"stiffness": 60.0, "damping": 0.02}, alike=1e-4),
    Hidden("joint_compliance", "hip", {"stiffness": 150.0, "damping": 0.05}, alike=1e-4),
    Hidden("joint_compliance", "knee", {"stiffness": 60.0, "damping": 0.02}, "joint", alike=1e-4),
    Hidden("backlash", "knee", {"gap": 0.01, "stiffness": 200.0}, alike=5e-3, near=0.05),
    Hidden("backlash", "knee", {"gap": 0.01, "stiffness": 200.0}, "joint", alike=5e-3, near=0.05),
    Hidden(
        "backlash",
        "hip",
        {"gap": 0.01, "stiffness": 2000.0},
        alike=0.01,
        near=0.05,
        model=replace(LEG, flank_retardation_s=1e-3),
        rig={"damping": 2.0},
    ),
    # what the linkage's bodies weigh sideways is not what crank and coupler do
    Hidden("base_compliance", None, {"stiffness": 2e4, "damping": 40.0, "mass": 10.0}, alike=0.15, near=0.15),
    # what hangs at the thigh's end a tree with a linkage does not know to the gram
    Hidden("link_length_error", "hip", {"length": 0.03}, alike=0.1, near=0.15),
    Hidden("controller_gain_error", "knee", {"kp_scale": 0.8, "kd_scale": 1.2}),
    # states from a few rows about each start are not quite those of a motion that bends
    Hidden("contact_compliance", None, {"stiffness": 2e4, "damping": 100.0}, alike=0.02, model=ON_PLATE),
    Hidden("ground_friction", None, {"coefficient": 0.35}, alike=0.05, model=ON_PLATE),
]
each = pytest.mark.parametrize("hidden", HIDDEN, ids=str)


@each
def test_the_model_moves_as_the_virtual_leg(hidden: Hidden) -> None:
    (measured,) = hidden.recorded([leg_experiment(1.2)], noisy=False)
    (nominal,) = hidden.recorded([leg_experiment(1.2)], noisy=False, hidden=False)
    measured, run = hidden.run(having(hidden.model, hidden.key, **hidden.values), measured)
    nominal, _ = hidden.run(hidden.model, nominal)
    for signal in scored_signals(measured):
        wrong = (run.signals[signal] - measured.signals[signal])[measured.valid]
        moved = (nominal.signals[signal] - measured.signals[signal])[measured.valid]
        assert np.sqrt(np.mean(wrong**2)) < hidden.alike * np.sqrt(np.mean(moved**2)), signal


@each
def test_parameters_are_recovered_from_noisy_recordings(hidden: Hidden) -> None:
    asked = [leg_experiment(2.0, seed=7), leg_experiment(2.0, seed=8, amplitude=0.4)]
    recordings = hidden.recorded(asked, noisy=True)
    effect = effect_named(hidden.effect)
    start = {
        name: value * hidden.start.get(name, 1.1 if name in effect.parameters.nonlinear else 1.3)
        for name, value in hidden.values.items()
    }
    estimates = {name: Estimate(value, 0.0, "") for name, value in start.items()}
    guess = Hypothesis(hidden.model, (AppliedEffect(hidden.key, estimates),))
    data, _ = gather(guess.model, recordings, (), seed=0)
    found = fit([guess], data, iterations=10, enough=1e-5)[0]
    assert found is not None
    (applied,) = found.hypothesis.free
    for name, value in hidden.values.items():
        estimate = applied.parameters[name]
        assert abs(estimate.value - value) < 4 * estimate.std + hidden.near * abs(value), (name, estimate)
        assert 0 < estimate.std < 0.3 * abs(value), (name, estimate)
