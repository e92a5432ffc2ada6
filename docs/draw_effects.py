"""Draws the signature of every effect, as a rule the torque that a model without it lacks, on the knee drive.

python docs/draw_effects.py [NAME...]     # into docs/images/effects, a few seconds each

The leg is simulated with the effect, and the nominal model is asked which torque that motion needs. What is
left stands over speed, position and time. What acts between command and torque shows there, and what acts
in sensors, in the loop or behind a spring shows in the motion: then that is drawn. Sizes are chosen to be
seen, not to be typical.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np

from workbench.comparison import replay_of
from workbench.comparison.inverse import torque_pair
from workbench.core import Controller, EffectKey, Estimate, Recording
from workbench.effects import EFFECTS, check_effect, compile_plant, load_model
from workbench.models import AppliedEffect, Model
from workbench.recordings import NoiseLevels
from workbench.report.figures import AFTER, INK
from workbench.rigs import PERFECT, HiddenEffect, Plate, VirtualLeg, plate_experiments
from workbench.simulation import GROUND_TORQUE, Run, simulate

matplotlib.use("agg")
from matplotlib import pyplot

FOLDER = Path(__file__).with_name("images") / "effects"
PERIOD, SECONDS = 0.001, 8.0
#: Parameters to draw an effect with, SI; those that are missing have none.
VALUES: dict[str, dict[str, float]] = {
    "linkage_inertia": {"M11": 0.00967, "M12": 0.002893, "M22": 0.00516},
    "linkage_gravity": {"g1": 0.163091, "g2": 0.132743},
    "viscous_damping": {"damping": 0.15},
    "coulomb_friction": {"torque": 0.3},
    "reflected_inertia": {"inertia": 0.01},
    "payload_mass": {"mass": 0.3},
    "torque_constant_error": {"gain": 0.8},
    "torque_bias": {"torque": -0.4},
    "command_delay": {"time": 0.003},
    "parallel_spring": {"stiffness": 1.5, "rest": 0.3},
    "asymmetric_friction": {
        "damping_positive": 0.1,
        "damping_negative": 0.02,
        "torque_positive": 0.2,
        "torque_negative": 0.4,
    },
    "stribeck_friction": {"coulomb": 0.15, "static": 0.45, "speed": 0.5},
    "load_dependent_friction": {"torque": 0.1, "ratio": 0.15},
    "quadratic_drag": {"drag": 0.03},
    "torque_saturation": {"limit": 0.6},
    "speed_torque_limit": {"stall_torque": 1.2, "no_load_speed": 2.5},
    "cogging": {"torque": 0.2, "order": 24.0, "phase": 0.6},
    "encoder_offset": {"angle": 0.08},
    "encoder_scale": {"scale": 1.06},
    "encoder_eccentricity": {"amplitude": 0.05, "phase": 0.7},
    "sensor_delay": {"time": 0.003},
    "velocity_filter_lag": {"time_constant": 0.008},
    "controller_gain_error": {"kp_scale": 0.7, "kd_scale": 1.3},
    "current_loop_lag": {"time_constant": 0.006},
    "thermal_derating": {"coefficient": 0.6, "time_constant": 1.0},
    "presliding_hysteresis": {"torque": 0.25, "stiffness": 10.0},
    "joint_compliance": {"stiffness": 40.0, "damping": 0.05},
    "backlash": {"gap": 0.03, "stiffness": 200.0},
    "base_compliance": {"stiffness": 4000.0, "damping": 20.0, "mass": 10.0},
    "link_length_error": {"length": 0.03},
    "first_moment_error": {"along": 0.03, "across": 0.0},
    "link_inertia_error": {"inertia": 0.004},
    "contact_compliance": {"stiffness": 3e4, "damping": 100.0},
    "ground_friction": {"coefficient": 0.35},
}
#: Models without what the shipped leg has already.
WITHOUT = {
    "actuator_inertia_coupling": "leg_kin_only",
    "linkage_inertia": "leg_s3n_act",
    "linkage_gravity": "leg_s3n_full",
}


#: Drawn as the motion that differs from the nominal run's.
MOTION = (
    *("encoder_offset", "encoder_scale", "encoder_eccentricity", "sensor_delay", "velocity_filter_lag"),
    *("controller_gain_error", "joint_compliance", "base_compliance"),
)
#: Drawn as the torque that was asked for less the one that came.
DRIVE = ("command_delay", "torque_saturation", "speed_torque_limit", "current_loop_lag")
#: Drawn as the ground's force, less that of the nominal ground from the same states.
ON_A_PLATE = ("contact_compliance", "ground_friction")
#: What a parallelogram has as its linkage: drawn on the leg as a bare tree.
ON_A_TREE = ("first_moment_error", "link_inertia_error")
#: A longer link without a load at its end changes nothing on a fixed base: it is drawn with one, in kg.
LOADED = {"link_length_error": 1.0}


def main() -> None:
    """Draws the effects named, or all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for effect in EFFECTS:
        if not sys.argv[1:] or effect.name in sys.argv[1:]:
            draw(effect.name, effect.axes == "each")


def draw(name: str, on_axis: bool) -> None:
    """One effect's picture."""
    nominal = load_model(WITHOUT.get(name, "leg"))
    if name in ON_A_TREE:
        nominal = replace(load_model("leg_kin_only"), linkage=None)
    if name in LOADED:
        nominal = with_effect(nominal, "payload_mass", None, {"mass": LOADED[name]})
    if name in ON_A_PLATE:
        run, lacking = on_a_plate(name)
        rows = np.flatnonzero(run.valid)
        lacking = lacking[rows, 1]
    elif name == "linkage_coriolis":
        run = simulate([Run(nominal, experiment(nominal))])[0]
        rows, lacking = np.arange(len(run)), velocity_torque(nominal, run)
    else:
        machine = with_effect(nominal, name, "knee" if on_axis else None, VALUES.get(name, {}))
        run = simulate([Run(machine, experiment(nominal))])[0]
        rows, lacking = np.arange(300, len(run)), np.zeros(0)
        if name in MOTION:
            plain = simulate([Run(nominal, experiment(nominal))])[0]
            lacking = 1e3 * (run.position - plain.position)[rows, 1]
        elif name in DRIVE:
            lacking = (run.signals["torque_command"] - run.signals["torque_measured"])[rows, 1]
        else:
            rows, lacking = missing_torque(nominal, run)
    t, q, v = run.time[rows], run.position[rows, 1], run.velocity[rows, 1]
    figure, axes = pyplot.subplots(1, 3, figsize=(6.4, 1.55), sharey=True, constrained_layout=True)
    window = (t > 0.5) & (t < 1.5) if name in ON_A_PLATE else (t > 2.4) & (t < 3.4)
    for ax, x, y, label in zip(
        axes,
        (v, q, t[window]),
        (lacking, lacking, lacking[window]),
        ("speed [rad/s]", "position [rad]", "time [s]"),
        strict=True,
    ):
        ax.plot(x, y, color=AFTER, lw=0.5 if len(x) > 2000 else 1.1)
        ax.axhline(0.0, color=INK, lw=0.5)
        ax.set_xlabel(label, fontsize=8)
        ax.tick_params(labelsize=7)
        for side in ("top", "right"):
            ax.spines[side].set_visible(False)
    top = max(1e-4, 1.1 * float(np.quantile(np.abs(lacking), 0.999)))
    axes[0].set_ylim(-top, top)
    label = "position [mrad]" if name in MOTION else "torque lost [N m]" if name in DRIVE else "torque [N m]"
    axes[0].set_ylabel(label, fontsize=8)
    figure.savefig(FOLDER / f"{name}.png", dpi=110, metadata={"Software": None})
    pyplot.close(figure)


def with_effect(model: Model, name: str, axis: str | None, values: Mapping[str, float]) -> Model:
    """The model with an effect of the given size."""
    estimates = {key: Estimate(value, 0.0, "") for key, value in values.items()}
    return model.with_effect(check_effect(model, AppliedEffect(EffectKey(name, axis), estimates)))


def on_a_plate(name: str) -> tuple[Recording, np.ndarray]:
    """The leg that slides on its plate, and what the ground's force has more there by the model (N, n)."""
    applied = HiddenEffect(name, parameters=VALUES[name])
    slide = next(e for e in plate_experiments() if e.name == "slide")
    recording = VirtualLeg([applied], sensors=PERFECT, plate=Plate(noise=0.0)).run([slide])[0]
    nominal = load_model("leg_on_plate")
    replay = replay_of(nominal, [recording])
    (run,) = replay.run([nominal])[0]
    measured = replay.recordings[0]
    return measured, measured.signals[GROUND_TORQUE] - run.signals[GROUND_TORQUE]


def velocity_torque(model: Model, run: Recording) -> np.ndarray:
    """The linkage's velocity term on the knee's drive, (N,), which a bare equation lacks."""
    assert model.linkage is not None
    q, v = run.position, run.velocity
    return -model.linkage.M12 * np.sin(q[:, 1] - q[:, 0]) * v[:, 0] ** 2


def missing_torque(nominal: Model, run: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Rows that count (K,), and the knee's recorded torque there less what the nominal model needs (K,)."""
    quiet = np.full(nominal.size, 1e-6)
    levels = NoiseLevels(quiet, quiet, quiet, quiet)
    measured, needed, valid = torque_pair(compile_plant(nominal), run, None, levels)
    rows = np.flatnonzero(valid)
    return rows, (measured - needed)[rows, 1]


def experiment(model: Model) -> Recording:
    """Both joints on the move, slowly and fast, under the leg's usual loop."""
    t = np.arange(round(SECONDS / PERIOD) + 1) * PERIOD
    ease = np.clip(t / 1.0, 0, 1) ** 3
    hip = -0.55 + ease * (0.3 * np.sin(1.3 * t) + 0.05 * np.sin(13.0 * t))
    knee = 1.05 + ease * (0.45 * np.sin(1.9 * t + 0.4) + 0.08 * np.sin(11.0 * t))
    joints = np.column_stack([hip, knee])
    start = np.broadcast_to(joints[0] @ model.transmission.T, joints.shape)
    return Recording(
        name="signature",
        axes=model.axes,
        coordinates="actuator",
        time=t,
        signals={"position": start, "velocity": np.zeros_like(start), "position_reference": joints},
        units=("rad", "rad"),
        controller=Controller("pd", "joint", kp=(50.0, 50.0), kd=(1.5, 1.5), period_s=0.003),
    )


if __name__ == "__main__":
    main()
