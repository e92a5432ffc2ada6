"""Every effect of the catalogue, in every place of three shipped models, with parameters to test it by."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from tests.bench_arm import bench_arm
from tests.simulation.make import arm_experiment, having, leg_experiment, slide_experiment
from workbench.comparison import Replay, replay_of
from workbench.core import EffectKey, Recording
from workbench.effects import EFFECTS, Effect, Motion, OnGround, effect_named, load_model, places
from workbench.models import Model, Placement
from workbench.rigs import PERFECT, Plate, VirtualLeg, plate_experiments
from workbench.simulation import Run, simulate

#: One set of parameters an effect, for a rotary axis: those it is drawn with, or others.
VALUES: dict[str, dict[str, float]] = {
    **{effect.name: effect.parameters.examples for effect in EFFECTS},
    "viscous_damping": {"damping": 0.1},
    "payload_mass": {"mass": 0.2},
    "torque_constant_error": {"gain": 0.85},
    "command_delay": {"time": 0.0023},
    "stribeck_friction": {"coulomb": 0.15, "static": 0.4, "speed": 0.5},
    "load_dependent_friction": {"torque": 0.1, "ratio": 0.1},
    "quadratic_drag": {"drag": 0.02},
    "torque_saturation": {"limit": 2.0},
    "speed_torque_limit": {"stall_torque": 4.0, "no_load_speed": 4.0},
    "cogging": {"torque": 0.2, "order": 7.0, "phase": 0.6},
    "encoder_offset": {"angle": 0.05},
    "encoder_scale": {"scale": 1.04},
    "encoder_eccentricity": {"amplitude": 0.03, "phase": 0.7},
    "sensor_delay": {"time": 0.0017},
    "velocity_filter_lag": {"time_constant": 0.004},
    "controller_gain_error": {"kp_scale": 0.9, "kd_scale": 1.1},
    "current_loop_lag": {"time_constant": 0.004},
    "thermal_derating": {"coefficient": 0.01, "time_constant": 0.5},
    "presliding_hysteresis": {"torque": 0.2, "stiffness": 20.0},
    "joint_compliance": {"stiffness": 60.0, "damping": 0.05},
    "backlash": {"gap": 0.02, "stiffness": 200.0},
    "base_compliance": {"stiffness": 20000.0, "damping": 40.0, "mass": 10.0},
    "link_length_error": {"length": 0.02},
    "first_moment_error": {"along": 0.08, "across": -0.05},
    "link_inertia_error": {"inertia": 0.012},
    "contact_compliance": {"stiffness": 2e4, "damping": 100.0},
}
#: How much larger numbers of a slide of 95 kg are: 60 N for 1 N m, and 0.04 m for 1 rad.
SLIDE = {
    "N*m": 60.0,
    "N*m*s/rad": 60.0 / 0.04,
    "N*m*s^2/rad^2": 60.0 / 0.04**2,
    "N*m/rad": 60.0 / 0.04,
    "rad": 0.04,
    "rad/s": 0.04,
    "kg*m^2": 60.0 / 0.04,
    "1/(N*m)^2": 60.0**-2,
    "1/rev": 1.0 / 0.04,
}


def on_the_slide(effect: Effect) -> dict[str, float]:
    units = {p.name: p.unit for p in effect.parameters}
    return {name: value * SLIDE.get(units[name], 1.0) for name, value in VALUES[effect.name].items()}


#: The same for that slide.
ON_THE_SLIDE = {
    **{effect.name: on_the_slide(effect) for effect in EFFECTS},
    "viscous_damping": {"damping": 200.0},
    "coulomb_friction": {"torque": 20.0},
    "reflected_inertia": {"inertia": 9.0},
    "payload_mass": {"mass": 10.0},
    "torque_bias": {"torque": 15.0},
    "parallel_spring": {"stiffness": 3000.0, "rest": 0.01},
    "asymmetric_friction": {
        "damping_positive": 100.0,
        "damping_negative": 200.0,
        "torque_positive": 15.0,
        "torque_negative": 25.0,
    },
    "stribeck_friction": {"coulomb": 15.0, "static": 40.0, "speed": 0.03},
    "load_dependent_friction": {"torque": 8.0, "ratio": 0.1},
    "quadratic_drag": {"drag": 2000.0},
    "torque_saturation": {"limit": 30.0},
    "speed_torque_limit": {"stall_torque": 60.0, "no_load_speed": 0.05},
    "cogging": {"torque": 15.0, "order": 800.0, "phase": 0.6},
    "encoder_offset": {"angle": 0.002},
    "thermal_derating": {"coefficient": 5e-5, "time_constant": 0.5},
    "presliding_hysteresis": {"torque": 15.0, "stiffness": 3e4},
    "base_compliance": {"stiffness": 1e6, "damping": 2000.0, "mass": 50.0},
    "first_moment_error": {"along": 0.0, "across": 0.0, "mass": 9.0},  # where its centre is shows nowhere
}
#: Where a law has nothing but one of its parts.
PARTS = {
    "asymmetric_friction": (
        {"damping_positive": 0.0, "damping_negative": 0.0, "torque_positive": 0.3, "torque_negative": 0.0},
        {"damping_positive": 0.2, "damping_negative": 0.1, "torque_positive": 0.0, "torque_negative": 0.0},
    ),
    "stribeck_friction": ({"coulomb": 0.0, "static": 0.4, "speed": 1.0},),
    "linkage_inertia": ({"M11": 0.01, "M12": 0.0, "M22": 0.0}, {"M11": 0.02, "M12": -0.003, "M22": 0.002}),
    "linkage_gravity": ({"g1": -0.3, "g2": 0.2},),
    "torque_constant_error": ({"gain": 1.3},),
}
MODELS = ("leg_kin_only", "leg", "emps")
#: For contacts alone; all else is as on the leg without a plate.
ON_A_PLATE = "leg_on_plate"
#: For links alone, which a parallelogram has as its linkage.
_FOLDER = TemporaryDirectory()
ON_AN_ARM = str(bench_arm(Path(_FOLDER.name)))


@dataclass(frozen=True)
class Case:
    """An effect in one place of one shipped model."""

    model: str
    key: EffectKey
    values: tuple[tuple[str, float], ...]

    @property
    def whole(self) -> bool:
        """Whether it has all parts of its law."""
        values = ON_THE_SLIDE if self.model == "emps" else VALUES
        return dict(self.values) == values[self.key.effect]

    @property
    def effect(self) -> Effect:
        return effect_named(self.key.effect)

    @property
    def added(self) -> Model:
        return having(load_model(self.model), self.key, **dict(self.values))

    def __str__(self) -> str:
        part = ",".join(f"{k}={v:g}" for k, v in self.values)
        return f"{Path(self.model).stem}+{self.key}[{part}]"


def cases() -> list[Case]:
    out = []
    for name in MODELS:
        for key in places(load_model(name)):
            values = ON_THE_SLIDE if name == "emps" else VALUES
            # what identification gave the Kin-Only leg is not free
            fixed = name == "emps" or (name == "leg_kin_only" and key.effect.startswith("linkage"))
            parts = () if fixed else PARTS.get(key.effect, ())
            for given in (values[key.effect], *parts):
                out.append(Case(name, key, tuple(given.items())))
    contacts = [
        key for key in places(load_model(ON_A_PLATE)) if isinstance(effect_named(key.effect), OnGround)
    ]
    arm = [EffectKey(name, "bend") for name in ("first_moment_error", "link_inertia_error")]
    out += [Case(ON_AN_ARM, key, tuple(VALUES[key.effect].items())) for key in arm]
    return [*out, *(Case(ON_A_PLATE, key, tuple(VALUES[key.effect].items())) for key in contacts)]


CASES = cases()


@cache
def experiment(name: str) -> Recording:
    if name == ON_A_PLATE:
        slide = next(e for e in plate_experiments(duration=0.8) if e.name == "slide")
        return VirtualLeg(plate=Plate(noise=0.0), sensors=PERFECT).run([slide])[0]
    model = load_model(name)
    if name == ON_AN_ARM:
        return arm_experiment(model, 0.9)
    return slide_experiment(model, 0.9) if name == "emps" else leg_experiment(0.9)


@cache
def _replay(name: str) -> Replay:
    return replay_of(load_model(name), [experiment(name)])


def runs(name: str, models: list[Model]) -> list[Recording]:
    """Models in the experiment of the shipped one: in its loop, or in windows on its ground."""
    if name == ON_A_PLATE:
        return [own[0] for own in _replay(name).run(models)]
    return simulate([Run(model, experiment(name)) for model in models])


@cache
def reference(name: str) -> Recording:
    return runs(name, [load_model(name)])[0]


@cache
def with_effect(case: Case) -> Recording:
    return runs(case.model, [case.added])[0]


def equation(case: Case, motion: Motion) -> np.ndarray:
    """The effect's torque (N, n) by its equation, with the parameters of the case."""
    effect, model = case.effect, load_model(case.model)
    coefficients, shape = effect.parameters.to_coefficients(dict(case.values))
    answer = effect.response(motion, model, Placement.of(model, case.key), shape)
    torque = np.zeros_like(motion.position) if answer.offset is None else answer.offset
    if len(answer.columns):
        torque = torque + np.tensordot(coefficients, answer.columns, axes=1)
    return torque
