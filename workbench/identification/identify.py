"""Step 1 of the workflow (paper, Algorithm 1): actuator and leg from their frequency responses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import InputError, Recording
from workbench.frf import estimate, estimate_postures

from .actuator import fit_actuator
from .leg import fit_leg
from .result import ActuatorIdentification, LegIdentification


def identify_actuator(recordings: Sequence[Recording]) -> ActuatorIdentification:
    """Inertia, damping and delay of a drive from open-loop torque excitation.

    Args:
        recordings: of one axis, periodically excited.

    Raises:
        InputError: more than one axis moves, or the recordings give no response.
    """
    axes = recordings[0].axes
    if len(axes) != 1:
        raise InputError(
            f"{len(axes)} axes where one drive is to be identified", file=recordings[0].source, column="axes",
            remedy="record the actuator alone, or use 'identify leg'",
        )  # fmt: skip
    frf = estimate(recordings)
    fit = fit_actuator(frf)
    inertia, damping, delay = (fit.parameters[k] for k in ("inertia", "damping", "delay"))
    return ActuatorIdentification(inertia, damping, delay, frf, fit)


def identify_leg(
    recordings: Sequence[Recording], transmission: np.ndarray | None = None
) -> LegIdentification:
    """Total inertia of a leg from sum- and difference-mode records about one posture or several.

    Args:
        recordings: two experiments or more at every posture, periodically excited.
        transmission: J of q_p = J q_s (2, 2), for recordings in joint coordinates.

    Raises:
        InputError: not two axes, or the recordings give no response.
    """
    axes = recordings[0].axes
    if len(axes) != 2:
        raise InputError(
            f"{len(axes)} axes where a leg has two", file=recordings[0].source, column="axes",
            remedy="record both drives of the leg",
        )  # fmt: skip
    frfs = estimate_postures(recordings)
    fit = fit_leg(frfs, transmission=transmission)
    p = fit.parameters
    names = list(p)
    index = [names.index(k) for k in ("M11", "M12", "M22")]
    return LegIdentification(
        p["M11"],
        p["M12"],
        p["M22"],
        fit.covariance[np.ix_(index, index)],
        (p["damping_1"], p["damping_2"]),
        p["delay"],
        (p["g1"], p["g2"]),
        tuple(frfs),
        fit,
    )
