"""What a hardware run and simulators' runs of the same command give, as numbers by measure."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from transfer_runs import Made

from workbench.core import Recording
from workbench.gait import Limbs, compare_gaits, predict_swing, with_leg_odometry
from workbench.models import read_model
from workbench.training.legs import machine_limbs
from workbench.training.machine import STEP_S, make_machine
from workbench.training.rollout import HOLD_S
from workbench.training.tasks import PITCH_HZ

#: Measure -> unit, of a robot that goes somewhere.
GAIT = {
    "E_phi": "%",
    "E_phi, bias": "%",
    "E_phi, below 1 Hz": "%",
    "E_phi, ripple": "%",
    "E_RMSE": "%",
    "stride frequency": "%",
    "duty factor": "",
    "joint angles over the stride": "mrad",
    "torque over the stride": "N m",
    "foot force over the stride": "N",
}
SWING = {"swing leg's hip": "%", "swing leg's knee": "%"}
PITCH = {
    "pitch rate, mean cycle": "% of range",
    "force on a foot, RMSE": "N",
    "joint angles over the stride": "mrad",
    "torque over the stride": "N m",
    "foot force over the stride": "N",
}
_SETTLE_S, _PHASES = 1.0, 100


def gait_gaps(hardware: Made, other: Made, command: tuple[float, float]) -> dict[str, float]:
    """Sizes of the gaps, `GAIT`, from the command's onset on; NaN where one of them fell."""
    if hardware.fell_s is not None or other.fell_s is not None:
        return dict.fromkeys(GAIT, np.nan)
    made = compare_gaits(hardware.recording, other.recording, command=command, start_s=HOLD_S)
    values = {m.name: abs(m.gap.value) for m in made.measures}
    return {name: values.get(name, np.nan) for name in GAIT}


def swing_misses(hardware: Made, model: Path) -> dict[str, float]:
    """How far a model's prediction of the swing leg misses on the hardware's own run, `SWING` [%]."""
    made = predict_swing(_limbs(model), hardware.recording, round(_SETTLE_S / STEP_S))
    if made is None:
        return dict.fromkeys(SWING, np.nan)
    return {
        f"swing leg's {label}": 100.0 * e.value for label, e in made.error.items() if label != "abduction"
    }


def seen_by_legs(made: Made, radius: float) -> Made:
    """A run whose velocity is that of leg odometry with feet of this radius [m]."""
    log = made.recording
    return replace(made, recording=with_leg_odometry(_limbs(Path("leg_s3n_full")), log, radius))


def pitch_gaps(hardware: Made, other: Made) -> dict[str, float]:
    """Gaps of pitch in place, `PITCH`: the paper's two, and those over the cycle."""
    if hardware.fell_s is not None or other.fell_s is not None:
        return dict.fromkeys(PITCH, np.nan)
    one, two = (_settled(x.recording) for x in (hardware, other))
    rates = [pitch_cycle(x) for x in (one, two)]
    force = [np.linalg.norm(x.extra["ground_force"][:, 9:12], axis=1) for x in (one, two)]
    made = compare_gaits(one, two)
    values = {m.name: m.gap.value for m in made.measures}
    values["pitch rate, mean cycle"] = 100.0 * rms(rates[1] - rates[0]) / float(np.ptp(rates[0]))
    values["force on a foot, RMSE"] = rms(force[1] - force[0])
    return {name: values.get(name, np.nan) for name in PITCH}


def pitch_cycle(recording: Recording) -> np.ndarray:
    """Mean pitch rate over the command's phase (100,) [rad/s]."""
    rate = recording.extra["base_angular_velocity"][:, 1]
    cycles = int(len(rate) * STEP_S * PITCH_HZ)
    phase = np.arange(cycles)[:, None] + np.arange(_PHASES) / _PHASES
    return np.interp(phase / PITCH_HZ, STEP_S * np.arange(len(rate)), rate).mean(axis=0)


def rms(x: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(x))))


def _settled(recording: Recording) -> Recording:
    """Without the hold and the first second, which is whole cycles of the command."""
    return recording.rows(slice(round((HOLD_S + _SETTLE_S) / STEP_S), None))


@cache
def _limbs(model: Path) -> Limbs:
    return machine_limbs(make_machine("quadruped", read_model(model)))
