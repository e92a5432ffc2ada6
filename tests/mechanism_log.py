"""Logs of a mechanism whose transmission changes, by the closed chain's own equation."""

from __future__ import annotations

from workbench import frf
from workbench.core import Recording
from workbench.models import Model
from workbench.simulation import PosturePlant, SensorNoise, as_recording, held_posture, run_posture


def multisines(
    model: Model, period_s: float, f_min_hz: float, rate_hz: float, noise: SensorNoise | None = None
) -> Recording:
    """One period of multisines up to 10 Hz on all drives, which hold the posture of zero; with `noise`."""
    design = frf.multisine(
        model.axes, name="m", period_s=period_s, rms=1.0, f_min_hz=f_min_hz, f_max_hz=10.0, rate_hz=rate_hz,
        hold=held_posture(model, {}), mixing="orthogonal", periods=1, transient_periods=0, realisations=1,
        phases="schroeder", driven="torque_feedforward", seed=1,
    )  # fmt: skip
    return run_posture(PosturePlant(model), as_recording(model, design, 0), [noise])[0]
