"""What everybody who steers a robot shares."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

#: A velocity (3,) within what may be asked for.
Clip = Callable[[np.ndarray], np.ndarray]
