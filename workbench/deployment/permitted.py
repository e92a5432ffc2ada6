"""What a run may do before the first torque: approval, limits of the training, tested watchdogs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.bundle import PolicyBundle, objections
from workbench.can import CanConfig
from workbench.core import InputError

from .limits import Limits, limits_of
from .trained import trained_of, wider

UNTESTED = 0.1  # of a torque limit, where nobody has seen the drive stop by itself


def untested(config: CanConfig) -> list[str]:
    """Return axes whose drive cannot report its watchdog and that nobody has seen stop by itself."""
    return [
        motor.axis for motor in config.motor if not motor.tells_watchdog and motor.watchdog_tested is None
    ]


def permitted(
    config: CanConfig, bundle: PolicyBundle | None, *, dry: bool, unapproved: bool, tested: bool
) -> tuple[Limits, list[str]]:
    """Return the limits of a run, and lines that explain them.

    Args:
        config: the robot.
        bundle: its policy; None for a tracker.
        dry: no hardware moves.
        unapproved: a person takes it upon themselves that the policy was not approved.
        tested: a person has seen every drive stop by itself.

    Raises:
        InputError: a policy that is not approved, for hardware.
    """
    limits, lines = limits_of(config), list[str]()
    if bundle is not None:
        limits = trained_of(bundle).limits(limits)
        lines += [line] if (line := wider(bundle, config)) else []
        if against := objections(bundle):
            if not (dry or unapproved):
                raise InputError(
                    f"the policy is not approved: {against[0]}", file=bundle.source,
                    remedy="run `workbench approve` on its model and train again, or deploy it --unapproved",
                )  # fmt: skip
            how = "hardware needs --unapproved" if dry else "it runs at your own risk"
            lines.append(f"not approved, {how}: {'; '.join(against)}")
    doubtful = [] if tested else untested(config)
    if doubtful:
        part = np.array([UNTESTED if axis in doubtful else 1.0 for axis in config.axes])
        limits = replace(limits, torque=part * limits.torque)
        lines.append(
            f"a tenth of the torque for {', '.join(doubtful)}: no watchdog can be read from these. "
            "Watch each drive stop when its host is silent, and "
            "write watchdog_tested = DATE, or give --watchdogs-tested"
        )
    return limits, lines


def refuse_untested(config: CanConfig) -> None:
    """Refuse an experiment on drives that may not stop by themselves: a tenth of the torque is too little.

    Raises:
        InputError: a drive whose watchdog nobody can read and nobody has tested.
    """
    for axis in untested(config):
        raise InputError(
            "its watchdog cannot be read, and nobody has tested it", file=config.source,
            column=f"motor '{axis}'.watchdog_tested",
            remedy="watch the drive stop when its host is silent, then write watchdog_tested = DATE",
        )  # fmt: skip
