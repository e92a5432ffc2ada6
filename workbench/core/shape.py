"""A smooth function that the residual follows: a description, not a cause."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Shape:
    """A smooth function, or a tone, that the residual torque of one axis follows.

    Attributes:
        axis: whose torque.
        quantities: what it is a function of, one or two, in words.
        units: of these.
        torque_unit: N m or N.
        share: of the torque's power that it removes on blocks that it was not fitted to.
        grid: (G,) values of the first quantity.
        torque: (G,) the function there; of two quantities, where the second is at its median.
        std: (G,) its standard deviation.
        seen: (G,) the function and the mean of what it leaves around each value; NaN where nothing was
            recorded.
        frequency: of a tone [Hz], else None.
    """

    axis: str
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    torque_unit: str
    share: float
    grid: np.ndarray
    torque: np.ndarray
    std: np.ndarray
    seen: np.ndarray
    frequency: float | None = None

    @property
    def name(self) -> str:
        """Return what it is, in words."""
        if self.frequency is not None:
            return f"a tone of {self.frequency:.3g} Hz"
        return f"a smooth function of {' and '.join(self.quantities)}"
