"""References with the opposite sign of their positions, found without knowing the loop."""

from __future__ import annotations

import numpy as np

from workbench.core import Recording

from .result import Remark

_ALIKE = 0.1  # of the reference's size, by which a position may miss its mirror image
_NO_MATTER = 0.3  # of it, by which it has to miss the reference itself


def remark_on_references(recording: Recording) -> list[Remark]:
    """Return a problem for each axis whose position follows its reference with the opposite sign.

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
    return remarks
