"""Finds the smallest magnitude of each hidden effect that doubles the nominal model's error over its noise.

    python benchmarks/hidden_magnitudes.py            # prints the table of workbench/rigs/draw.py

The error is the comparison's: over the demo's experiments, root mean square over axes and over position and
torque of RMSE divided by the signal's standard deviation, both pooled over all recordings. Noise makes `n`,
the effect alone `e`; a magnitude is smallest where sqrt(n^2 + e^2) = 2 n.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np
from joblib import Parallel, delayed

from workbench.core import Recording
from workbench.rigs import PERFECT, HiddenEffect, VirtualLeg
from workbench.rigs.draw import Place, hidden_effect
from workbench.rigs.machine import AXES

RATIO = 2.0  # error over noise at the smallest magnitude
SIGNALS = ("position", "torque_measured")
#: A row taken just after an edge misses the edge however small a further delay is, so that the measured
#: torque jumps at once; a delay counts by the motion that it makes.
SIGNALS_OF_DELAY = ("position",)
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
}
AT_JOINT = (
    "viscous_damping",
    "coulomb_friction",
    "stribeck_friction",
    "asymmetric_friction",
    "parallel_spring",
)
WHOLE_LEG = ("command_delay", "payload_mass", "linkage_inertia", "linkage_gravity")


def main() -> None:
    """Prints the table, one line a place."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("effects", nargs="*", help="default: all")
    parser.add_argument("--seed", type=int, default=0, help="of the noise and the validation motion")
    parser.add_argument("--jobs", type=int, default=2)
    arguments = parser.parse_args()
    truth = run((), arguments.seed)
    noisy = VirtualLeg(seed=arguments.seed).run()
    print(f"# normalised error of noise alone: {normalised_error(noisy, truth, SIGNALS):.4f}")
    search = delayed(smallest)
    chosen = [place for place in places() if place[0] in (arguments.effects or FIRST_GUESS)]
    found = Parallel(arguments.jobs)(search(place, noisy, truth, arguments.seed) for place in chosen)
    for place, value in zip(chosen, found, strict=True):
        print(f"        {place!r}: {value:.2g},", flush=True)


def places() -> list[Place]:
    """Every effect at every place where the demo hides it; the hip joint is the hip drive's own axis."""
    found: list[Place] = []
    for effect in FIRST_GUESS:
        axes = (None,) if effect in WHOLE_LEG else AXES
        found += [(effect, axis, "actuator") for axis in axes]
        found += [(effect, "knee", "joint")] if effect in AT_JOINT else []
    return found


def smallest(place: Place, noisy: Sequence[Recording], truth: Sequence[Recording], seed: int) -> float:
    """Secant in log-log on the magnitude, at which the effect alone is sqrt(RATIO^2 - 1) times the noise."""
    signals = SIGNALS_OF_DELAY if place[0] == "command_delay" else SIGNALS
    goal = normalised_error(noisy, truth, signals) * np.sqrt(RATIO**2 - 1)
    magnitude, power, last = FIRST_GUESS[place[0]], 1.0, None
    for _ in range(6):
        error = normalised_error(run((hidden_effect(place, magnitude),), seed), truth, signals)
        if abs(error / goal - 1) < 0.02:
            break
        if last is not None:
            power = np.clip(np.log(error / last[1]) / np.log(magnitude / last[0]), 0.3, 3.0)
        last = (magnitude, error)
        magnitude *= float(np.clip((goal / error) ** (1 / power), 0.1, 10.0))
    return magnitude


def run(hidden: Sequence[HiddenEffect], seed: int) -> list[Recording]:
    """The demo without sensor noise."""
    return VirtualLeg(hidden, seed, PERFECT).run()


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
