"""References with another sign or unit than their positions, found without knowing the loop."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording

from .factors import name_factors
from .result import Remark

_ALIKE = 0.1  # of the reference's size, by which a position may miss its mirror image
_NO_MATTER = 0.3  # of it, by which it has to miss the reference itself
_LOOSELY = 0.2  # logarithm of the factor: a loop follows its reference so well, and units are farther apart
_NO_LOOP = 20.0  # times the reference, or a share of it: no loop that works moves so much or so little


def remark_on_references(recording: Recording) -> list[Remark]:
    """Return a problem for each axis whose position follows its reference with another sign or unit.

    A loop that is driven too fast answers late, up to half a period, but with a smaller motion then.
    """
    reference = recording.get("position_reference")
    if reference is None:
        return []
    valid = recording.valid
    remarks = []
    for axis, q, asked in zip(recording.axes, recording.position[valid].T, reference[valid].T, strict=True):
        size = float(np.sqrt(np.mean(asked**2)))
        if size == 0.0 or np.ptp(asked) == 0.0:
            continue
        mirror, plain = (float(np.sqrt(np.mean((q + side * asked) ** 2))) for side in (1.0, -1.0))
        if mirror < _ALIKE * size and plain > _NO_MATTER * size:
            text = f"Position of '{axis}' is minus its reference: one of them has the wrong sign."
            value = {"signal": "position_reference", "mirror": mirror / size, "plain": plain / size}
            remarks.append(Remark("problem", "sign", axis, text, value))
        moved, wanted = q - q.mean(), asked - asked.mean()  # weight may hold an axis off its reference
        share = float(moved @ wanted / (wanted @ wanted))
        meaning = next(iter(name_factors(share, tolerance=_LOOSELY)), None)
        known = meaning and np.std(moved - share * wanted) < _NO_MATTER * np.std(moved)
        if known and not 1.0 / _NO_LOOP < abs(share) < _NO_LOOP:
            about = f"about {1.0 / abs(share):.3g} times its position"
            text = f"Reference of '{axis}' is {about}: a mix-up of {meaning}."
            value = {"signal": "position_reference", "factor": 1.0 / share, "meaning": meaning}
            remarks.append(Remark("problem", "unit", axis, text, value))
    return remarks
