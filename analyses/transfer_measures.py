"""What a hardware run and simulators' runs of the same command give, as numbers by measure."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from zlib import crc32

import numpy as np
from transfer_filter import with_filtered_velocity
from transfer_runs import Made
from transfer_worlds import Push

from workbench.core import Recording
from workbench.gait import (
    Limbs,
    compare_gaits,
    limbs_of,
    predict_swing,
    with_leg_odometry,
)
from workbench.models import read_model
from workbench.training.machine import LEGS, STEP_S, Machine, make_machine
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
#: Of the mean answer to pushes from the side.
PUSHED = {
    "largest sideward speed": "mm/s",
    "sideward speed, mean answer": "mm/s",
    "sideward shift": "mm",
    "largest roll": "mrad",
}
_SETTLE_S, _PHASES = 1.0, 100
_ACCELEROMETER, _BIAS = 0.3, 0.1  # m/s^2: noise of a row, and a bias that nobody is told


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


def seen_by_filter(made: Made, radius: float) -> Made:
    """A run whose velocity is that of a Kalman filter of legs and accelerometer."""
    log = made.recording
    true = np.diff(log.extra["base_velocity"], axis=0, append=log.extra["base_velocity"][-1:]) / log.period
    # its own for every run: what two runs have alike would be no difference between them
    noise = np.random.default_rng(crc32(log.velocity.tobytes())).standard_normal(true.shape)
    measured = true + _BIAS + _ACCELEROMETER * noise
    limbs = _limbs(Path("leg_s3n_full"))
    return replace(made, recording=with_filtered_velocity(limbs, log, radius, measured, _ACCELEROMETER))


def push_gaps(hardware: Made, other: Made, push: Push) -> dict[str, float]:
    """Gaps of the mean answer to pushes, `PUSHED`; NaN where one of them fell."""
    if hardware.fell_s is not None or other.fell_s is not None:
        return dict.fromkeys(PUSHED, np.nan)
    one, two = (push_answer(x.recording, push) for x in (hardware, other))
    (fast, roll), (faster, rolls) = one, two
    return {
        "largest sideward speed": 1e3 * abs(fast.max() - faster.max()),
        "sideward speed, mean answer": 1e3 * rms(fast - faster),
        "sideward shift": 1e3 * abs(fast.sum() - faster.sum()) * STEP_S,
        "largest roll": 1e3 * abs(np.abs(roll).max() - np.abs(rolls).max()),
    }


def push_answer(recording: Recording, push: Push) -> tuple[np.ndarray, np.ndarray]:
    """What a push to the left changes (T,): sideward speed of the trunk [m/s] and its roll [rad].

    Pushes alternate, and half of the difference between those to the left and those to the right has neither
    the turn of the lap nor the stride in it, as far as pushes come at many phases of it.
    """
    w, x, y, z = recording.extra["base_orientation"].T
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    speed = recording.extra["base_velocity"]
    side = np.cos(yaw) * speed[:, 1] - np.sin(yaw) * speed[:, 0]
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    rows, first = round(push.every_s / STEP_S), round((HOLD_S + push.first_s) / STEP_S)
    count = (len(side) - first) // rows // 2 * 2
    sign = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)[:, None]
    begins = first + np.round(np.arange(count) * push.every_s / STEP_S).astype(int)
    return tuple((sign * x[begins[:, None] + np.arange(rows)]).mean(axis=0) for x in (side, roll))


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


def machine_limbs(machine: Machine) -> Limbs:
    """Return the legs of a quadruped; drives with play start in the middle of it."""
    rotors = machine.rotors
    apart = (rotors.places, rotors.dofs, rotors.follow, rotors.drives) if len(rotors.places) else None
    feet = [f"{leg}_sphere" for leg in LEGS]
    return limbs_of(machine.mujoco, machine.joints, machine.transmission, feet, apart)


@cache
def _limbs(model: Path) -> Limbs:
    return machine_limbs(make_machine("quadruped", read_model(model)))
