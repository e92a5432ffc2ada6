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
from workbench.effects import (
    EFFECTS,
    Effect,
    FrfSignature,
    OfBody,
    OnGround,
    SignalStage,
    check_effect,
    compile_plant,
    kinds,
    load_model,
)
from workbench.effects.linkage_coriolis import LinkageCoriolis
from workbench.models import AppliedEffect, Model
from workbench.recordings import NoiseLevels
from workbench.report.style import AFTER, INK
from workbench.rigs import PERFECT, HiddenEffect, Plate, VirtualLeg, plate_experiments
from workbench.simulation import GROUND_TORQUE, Run, simulate

matplotlib.use("agg")
from matplotlib import pyplot

FOLDER = Path(__file__).with_name("images") / "effects"
PERIOD, SECONDS = 0.001, 8.0
#: The shipped leg, and what it was made from: models without what it has already.
LEGS = ("leg", "leg_s3n_full", "leg_s3n_act", "leg_kin_only")
#: A longer link without a load at its end changes nothing on a fixed base: it is drawn with one.
LOAD = {"mass": 1.0}


def main() -> None:
    """Draws the effects named, or all."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    for effect in EFFECTS:
        if not sys.argv[1:] or effect.name in sys.argv[1:]:
            draw(effect)


def nominal_of(effect: Effect) -> Model:
    """A model without the effect, to which it matters."""
    if isinstance(effect.corrects, OfBody):  # a parallelogram has these as its linkage
        return replace(load_model("leg_kin_only"), linkage=None)
    nominal = next(model for model in map(load_model, LEGS) if not model.has(effect.name))
    return (
        with_effect(nominal, "payload_mass", None, LOAD) if kinds.changes_foot_position(effect) else nominal
    )


def draw(effect: Effect) -> None:
    """One effect's picture."""
    nominal, on_a_plate = nominal_of(effect), isinstance(effect, OnGround)
    in_motion = effect.stage > SignalStage.MECHANISM or effect.search.frf_signature is FrfSignature.RESONANCE
    in_drive = effect.stage is SignalStage.COMMAND
    if on_a_plate:
        run, lacking = ground_force(effect)
        rows = np.flatnonzero(run.valid)
        lacking = lacking[rows, 1]
    elif isinstance(effect, LinkageCoriolis):
        run = simulate([Run(nominal, experiment(nominal))])[0]
        rows, lacking = np.arange(len(run)), velocity_torque(nominal, run)
    else:
        axis = "knee" if effect.locations else None
        machine = with_effect(nominal, effect.name, axis, effect.parameters.examples)
        run = simulate([Run(machine, experiment(nominal))])[0]
        rows, lacking = np.arange(300, len(run)), np.zeros(0)
        if in_motion:
            plain = simulate([Run(nominal, experiment(nominal))])[0]
            lacking = 1e3 * (run.position - plain.position)[rows, 1]
        elif in_drive:
            lacking = (run.signals["torque_command"] - run.signals["torque_measured"])[rows, 1]
        else:
            rows, lacking = missing_torque(nominal, run)
    t, q, v = run.time[rows], run.position[rows, 1], run.velocity[rows, 1]
    figure, axes = pyplot.subplots(1, 3, figsize=(6.4, 1.55), sharey=True, constrained_layout=True)
    window = (t > 0.5) & (t < 1.5) if on_a_plate else (t > 2.4) & (t < 3.4)
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
    label = "position [mrad]" if in_motion else "torque lost [N m]" if in_drive else "torque [N m]"
    axes[0].set_ylabel(label, fontsize=8)
    figure.savefig(FOLDER / f"{effect.name}.png", dpi=110, metadata={"Software": None})
    pyplot.close(figure)


def with_effect(model: Model, name: str, axis: str | None, values: Mapping[str, float]) -> Model:
    """The model with an effect of the given size."""
    estimates = {key: Estimate(value, 0.0, "") for key, value in values.items()}
    return model.with_effect(check_effect(model, AppliedEffect(EffectKey(name, axis), estimates)))


def ground_force(effect: Effect) -> tuple[Recording, np.ndarray]:
    """The leg that slides on its plate, and what the ground's force has more there by the model (N, n)."""
    applied = HiddenEffect(effect.name, parameters=effect.parameters.examples)
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
