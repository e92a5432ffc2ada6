"""All checks of recordings that need no model."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from workbench.core import Recording
from workbench.recordings import Source, load_recordings
from workbench.recordings.noise import noise_levels

from .control import remark_on_control
from .excitation import excited_axes, remark_on_excitation
from .inertia import remark_on_inertia
from .motion import remark_on_motion
from .opposed import remark_on_references
from .result import Inspection, RecordingInspection, Remark
from .torque import driven, remark_on_command_limits, remark_on_torque
from .work import remark_on_work

FEW = 200  # rows below which nothing is compared


def inspect(recordings: Source | Iterable[Source], *, transmission: np.ndarray | None = None) -> Inspection:
    """Return what recordings say about themselves: swaps, signs, units, gains, clocks, limits, noise.

    Args:
        recordings: what was measured, one or several, or their files.
        transmission: J in q_p = J q_s (actuator from joint coordinates), shape (n, n), for recordings
            and controllers that use different coordinates. None: the identity, or where the logged
            control law says otherwise, a belt-driven second joint in each leg.

    Returns:
        For each recording the remarks, the noise of each sensor, and what each axis did.

    Raises:
        InputError: a file that cannot be read, or no recording.
    """
    given = load_recordings(recordings, some=True)
    return Inspection(tuple(_inspect_one(recording, transmission) for recording in given))


def _inspect_one(recording: Recording, transmission: np.ndarray | None) -> RecordingInspection:
    noise = noise_levels(recording)
    excited = excited_axes(recording, noise)
    held = np.array([e.held for e in excited])
    remarks = [Remark("note", "reader", None, note) for note in recording.notes]
    if len(recording) >= FEW:
        remarks += remark_on_motion(recording, held)
        remarks += remark_on_control(recording, transmission)
        told = {r.axis for r in remarks if r.topic == "sign"}
        remarks += [r for r in remark_on_references(recording) if r.axis not in told]
        rows = driven(recording)
        if len(rows) >= FEW:
            remarks += remark_on_torque(rows, noise)
            backward = remark_on_inertia(rows, held)
            remarks += backward or remark_on_work(rows, held)
            remarks += remark_on_command_limits(rows)
    else:
        text = f"Only {len(recording)} rows: too few to check signals against each other."
        remarks.append(Remark("note", "reader", None, text))
    remarks += remark_on_excitation(recording, excited)
    return RecordingInspection(
        recording=recording.name,
        rows=len(recording),
        period_s=recording.period,
        remarks=tuple(remarks),
        noise=noise,
        excited=excited,
    )
