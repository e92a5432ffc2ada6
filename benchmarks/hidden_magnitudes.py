"""Finds the smallest magnitude of each hidden effect that doubles the nominal model's error over its noise.

    python benchmarks/hidden_magnitudes.py            # prints the table of workbench/rigs/magnitudes.py

The error is the comparison's: over the demo's experiments, root mean square over axes and over position and
torque of RMSE divided by the signal's standard deviation, both pooled over all recordings. Noise makes `n`,
the effect alone `e`; a magnitude is smallest where sqrt(n^2 + e^2) = 2 n. Effects that the demo cannot show
are measured over the demo's experiments and one more.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from exam.experiments import NEEDS, experiments_for
from joblib import Parallel, delayed

from workbench.core import Recording, SimulationError
from workbench.rigs import PERFECT, Experiment, HiddenEffect, VirtualLeg, hidden_effect
from workbench.rigs.machine import AXES
from workbench.rigs.magnitudes import Seat

RATIO = 2.0  # error over noise at the smallest magnitude
SIGNALS = ("position", "torque_measured")
#: A row taken just after an edge misses the edge however small a further delay is, so that the measured
#: torque jumps at once; what is late before the torque sensor counts by the motion that it makes.
LATE = ("command_delay", "current_loop_lag")
SIGNALS_OF_LATE = ("position",)
#: A gap counts beside the compliance of its flanks, which shows with no gap at all.
BESIDE = ("backlash",)
FIRST_GUESS = {
    "viscous_damping": 0.03,
    "coulomb_friction": 0.1,
    "stribeck_friction": 0.1,
    "asymmetric_friction": 0.1,
    "torque_bias": 0.1,
    "torque_constant_error": 0.05,
    "command_delay": 3e-4,
    "reflected_inertia": 1e-3,
    "payload_mass": 0.03,
    "parallel_spring": 0.3,
    "linkage_inertia": 0.2,
    "linkage_gravity": 0.5,
    "load_dependent_friction": 0.1,
    "presliding_hysteresis": 0.1,
    "quadratic_drag": 0.03,
    "torque_saturation": 0.1,
    "speed_torque_limit": 0.05,
    "thermal_derating": 0.003,
    "cogging": 0.2,
    "current_loop_lag": 5e-4,
    "sensor_delay": 3e-4,
    "velocity_filter_lag": 1e-3,
    "controller_gain_error": 0.05,
    "backlash": 0.005,
    "joint_compliance": 0.002,
    "encoder_offset": 0.005,
    "encoder_scale": 0.01,
    "encoder_eccentricity": 0.005,
    "link_length_error": 0.005,
    "base_compliance": 2e-5,
}
AT_JOINT = (
    "viscous_damping",
    "coulomb_friction",
    "stribeck_friction",
    "asymmetric_friction",
    "parallel_spring",
    "load_dependent_friction",
    "presliding_hysteresis",
    "quadratic_drag",
    "backlash",
    "joint_compliance",
)
WHOLE_LEG = (
    "command_delay",
    "payload_mass",
    "linkage_inertia",
    "linkage_gravity",
    "sensor_delay",
    "base_compliance",
)
HIP_ONLY = ("link_length_error",)  # of a longer shank a fixed base feels nothing


def main() -> None:
    """Prints the table, one line a place."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("effects", nargs="*", help="default: all")
    parser.add_argument("--seed", type=int, default=0, help="of the noise and the validation motion")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    search = delayed(smallest)
    chosen = [seat for seat in seats() if seat[0] in (arguments.effects or FIRST_GUESS)]
    work = Parallel(arguments.jobs, return_as="generator")
    found: Any = work(search(seat, arguments.seed) for seat in chosen)
    for seat, (value, noise) in zip(chosen, found, strict=True):
        print(f"        {seat!r}: {value:.2g},  # noise alone {noise:.4f}", flush=True)


def seats() -> list[Seat]:
    """Every effect at every place where it is hidden; the hip joint is the hip drive's own axis."""
    found: list[Seat] = []
    for effect in FIRST_GUESS:
        axes = (None,) if effect in WHOLE_LEG else AXES[:1] if effect in HIP_ONLY else AXES
        found += [(effect, axis, "actuator") for axis in axes]
        found += [(effect, "knee", "joint")] if effect in AT_JOINT else []
    return found


def smallest(seat: Seat, seed: int) -> tuple[float, float]:
    """Magnitude at which the effect alone is sqrt(RATIO^2 - 1) times the noise, and the noise's error.

    Secant in log-log; a leg that runs away counts as far too much.
    """
    experiments, signals = experiments_for((seat[0],), seed), SIGNALS_OF_LATE if seat[0] in LATE else SIGNALS
    truth, noise = _without_effect(tuple({seat[0]} & {*NEEDS}), tuple(signals), seed)
    if seat[0] in BESIDE:
        truth = run((hidden_effect(seat, 0.0),), seed, experiments)
    goal = noise * np.sqrt(RATIO**2 - 1)
    magnitude, power, last = FIRST_GUESS[seat[0]], 1.0, None
    for _ in range(12):
        try:
            hidden = run((hidden_effect(seat, magnitude),), seed, experiments)
        except SimulationError:
            magnitude *= 0.5
            continue
        error = max(normalised_error(hidden, truth, signals), 1e-9)
        if abs(error / goal - 1) < 0.02:
            break
        if last is not None:
            power = np.clip(np.log(error / last[1]) / np.log(magnitude / last[0]), 0.3, 8.0)
        last = (magnitude, error)
        magnitude *= float(np.clip((goal / error) ** (1 / power), 0.1, 10.0))
    return magnitude, noise


@lru_cache(maxsize=4)
def _without_effect(
    effects: tuple[str, ...], signals: tuple[str, ...], seed: int
) -> tuple[list[Recording], float]:
    """The nominal leg without noise in the experiments of `effects`, and the error that noise makes."""
    experiments = experiments_for(effects, seed)
    truth, noisy = run((), seed, experiments), VirtualLeg(seed=seed).run(experiments)
    return truth, normalised_error(noisy, truth, signals)


def run(hidden: Sequence[HiddenEffect], seed: int, experiments: Sequence[Experiment]) -> list[Recording]:
    """Experiments without sensor noise."""
    return VirtualLeg(hidden, seed, PERFECT).run(experiments)


def normalised_error(
    measured: Sequence[Recording], simulated: Sequence[Recording], signals: Sequence[str]
) -> float:
    """RMS over axes and `signals` of pooled RMSE over pooled standard deviation."""
    parts = []
    for signal in signals:
        ours = np.concatenate([recording.signals[signal] for recording in measured])
        theirs = np.concatenate([recording.signals[signal] for recording in simulated])
        parts.append(np.mean((ours - theirs) ** 2, axis=0) / np.var(ours, axis=0))
    return float(np.sqrt(np.mean(parts)))


if __name__ == "__main__":
    main()
