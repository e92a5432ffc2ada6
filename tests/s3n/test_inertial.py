from __future__ import annotations

import numpy as np
import pytest

from workbench.s3n.inertial import Inertial


@pytest.mark.parametrize(
    ("mass", "moments", "possible"),
    [
        (1.0, (1.0, 1.0, 1.0), True),
        (1.0, (1.0, 1.0, 2.5), False),  # no body is that flat
        (0.0, (1.0, 1.0, 1.0), False),
        (1.0, (1.0, 1.0, np.inf), False),
        (1e300, (1e300, 1e300, np.nan), False),
    ],
)
def test_what_a_body_can_have(mass: float, moments: tuple[float, ...], possible: bool) -> None:
    body = Inertial(mass, np.zeros(3), np.diag(moments), mass, np.zeros(3))
    assert body.is_body is possible
