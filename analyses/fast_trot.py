"""A fast trot: the circular task at up to 2 m/s straight ahead; the test is 1.8 m/s.

    workbench train analyses/fast_trot.py --variant s3n_full --unverified -o runs/trot

Legs swing faster than on the circle of 0.8 m/s, so that their inertia counts for more. Policies carry the
text of this file: whoever changes it trains them again.
"""

from dataclasses import replace

import numpy as np

from workbench.training.judging import circular_scores
from workbench.training.tasks import CIRCULAR

FAST = 1.8, 0.0, 0.0
LOW, HIGH = (0.0, -0.2, -0.5), (2.0, 0.2, 0.5)


def command(draws, worlds, machine):
    """Forward and sideward speed [m/s] and yaw rate [rad/s]; three worlds in ten run the test."""
    drawn = draws.uniform(LOW, HIGH, (worlds, 3))
    kind = draws.uniform((0.0,), (1.0,), (worlds, 1))
    return draws.xp.where(kind < 0.3, draws.constant(FAST, (worlds, 3)), drawn)


TASK = replace(
    CIRCULAR,
    name="trot",
    about="The robot trots straight ahead at up to 2 m/s; the test is 1.8 m/s.",
    command=command,
    trial=lambda machine: np.array([FAST]),
    scores=lambda log: circular_scores(log, FAST),
    iterations=800,
    commands=tuple(zip(LOW, HIGH, strict=True)),
)
