"""The virtual leg against an independent simulator of the same leg: they differ by sensor noise only."""

import json

import numpy as np
import pytest

from tests.data_helpers import LEG
from workbench.recordings import load_recordings
from workbench.rigs import Experiment, HiddenEffect, VirtualLeg

#: What the sensors' noise alone makes through the loop: position [rad], torque [N m].
NOISE = {"position": (1.6e-4, 1.6e-4), "velocity": (0.016, 0.017), "torque_measured": (0.064, 0.044)}


@pytest.mark.parametrize("case", ["clean", "friction"])
def test_an_independent_simulator_differs_by_noise_only(case: str) -> None:
    hidden = []
    if case == "friction":
        truth = json.loads((LEG / "friction.truth.json").read_text())
        hidden = [HiddenEffect(truth["effect"], truth["axis"], truth["location"], truth["parameters"])]
    begun = slice(0, 5000 if case == "clean" else None)  # sticks take all the rows
    theirs = [r.rows(begun) for r in load_recordings(sorted((LEG / case).glob("*.toml")))]
    ours = VirtualLeg(hidden, seed=11).run([Experiment.replay(recording) for recording in theirs])
    for measured, simulated in zip(theirs, ours, strict=True):
        sticks = case == "friction" and measured.name == "slow"  # where each stick ends hangs on the noise
        for signal, noise in NOISE.items():
            rms = np.sqrt(np.mean((measured.signals[signal] - simulated.signals[signal]) ** 2, axis=0))
            np.testing.assert_array_less(rms, (1.6 if sticks else 1.15) * np.sqrt(2) * np.array(noise))
