"""Short experiments on the virtual leg, enough to tell effects apart."""

from __future__ import annotations

from workbench.core import Recording
from workbench.rigs import HiddenEffect, VirtualLeg, chirp, multisine, slow_sweep, validation


def recordings(*hidden: HiddenEffect, seed: int = 5) -> tuple[list[Recording], list[Recording]]:
    """Training and held-out recordings of a leg with something hidden in it, 17 s in all."""
    experiments = [
        multisine("sum", period=2.0, duration=4.0),
        chirp("knee", duration=4.0),
        slow_sweep(duration=6.0),
        validation(seed, duration=3.0),
    ]
    made = VirtualLeg(hidden, seed=seed).run(experiments)
    return made[:-1], made[-1:]
