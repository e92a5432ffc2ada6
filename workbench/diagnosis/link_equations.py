"""Normal equations of all numbers of all links, beside what every drive has, along the measured motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey, Recording
from workbench.models import Model

from .adequacy.laws import is_of_drives
from .adequacy.link_errors import columns_of_links
from .fitting.normal_equations import Normal
from .problem import along_measured_motion
from .screening.needed_torque import needing
from .screening.torque_columns import regression_of, torque_rows

_BESIDE = ("torque_bias", "parallel_spring")  # what axes may have, besides inertia, damping and dry friction


@dataclass(frozen=True)
class LinkEquations:
    """The residual torque of a model, linear in what drives have and in ten numbers of each axis' link.

    Attributes:
        drives: the effect of a drive that each of the first unknowns belongs to; those of the links
            (`effects.link_regressor`) follow in the order of the axes.
        blocks: equations of each block of the recordings that are fitted, and of each axis.
        judging: of each axis, in each recording that is held out.
        unit: torque [N m or N] of one unit of the residual, per axis (n,).
        noise: torque that noise leaves, per axis (n,) [N m or N].
    """

    drives: tuple[EffectKey, ...]
    blocks: tuple[tuple[Normal, ...], ...]
    judging: tuple[tuple[Normal, ...], ...]
    unit: np.ndarray
    noise: np.ndarray


def link_equations(
    model: Model, training: Sequence[Recording], held_out: Sequence[Recording], seed: int
) -> LinkEquations | None:
    """Return the equations of all links, and of rotor, damping, dry friction, bias and spring of all drives.

    None where nothing drives the motion: neither a measured torque nor the law of a loop.
    """
    along = along_measured_motion(model, [*training, *held_out], len(training), seed)
    if along is None:
        return None
    data, start = along
    regression = regression_of(start, data, lambda key: is_of_drives(key) or key.effect in _BESIDE)
    linearisation, motions = regression.linearisation, needing(regression.linearisation)
    entries = [e for e in regression.entries if not e.shape]
    drives = [c for e in entries for c in linearisation.columns(e.key, e.shape, motions)[0]]
    rows = torque_rows(linearisation, [*drives, *columns_of_links(linearisation)], data)
    unit = 1.0 / data.weight[1]
    return LinkEquations(
        tuple(e.key for e in entries for _ in e.linear),
        rows.folds(data),
        tuple(rows.normals(range(len(training), len(data.recordings)))),
        unit,
        np.sqrt(regression.floor) * unit,
    )
