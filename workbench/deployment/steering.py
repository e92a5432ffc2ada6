"""Common parts of all inputs that steer a robot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

#: A velocity (3,) within what may be asked for.
Clip = Callable[[np.ndarray], np.ndarray]
