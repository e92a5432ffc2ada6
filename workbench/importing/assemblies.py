"""Which of the ways to put a mechanism together a model is of: loops close in more than one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from workbench.core import Mechanism, SimulationError
from workbench.mechanism import ClosedChain


@dataclass(frozen=True)
class Assemblies:
    """Ways to close the loops at one posture of the serial joints.

    Attributes:
        joints: serial joint -> its position there [rad or m].
        own: drive -> its position there in this model.
        others: the same in each of the other ways.
    """

    joints: Mapping[str, float]
    own: Mapping[str, float]
    others: tuple[Mapping[str, float], ...]

    def __str__(self) -> str:
        """What a user should know, and how another way is chosen; empty where there is no other."""
        if not self.others:
            return ""
        there = _said(self.joints)
        ways = " or ".join(_said(_differs(self.own, other)) for other in self.others)
        other = {**self.joints, **_differs(self.own, self.others[0])}
        chosen = " ".join(f"--start {name}={value:.3g}" for name, value in other.items())
        own = _said({name: self.own[name] for name in _differs(self.own, self.others[0])})
        return (
            f"The loops close in {1 + len(self.others)} ways. At {there}, this model has {own}; the "
            f"alternative is {ways}; to choose it: {chosen}"
        )


def assemblies(mechanism: Mechanism) -> Assemblies:
    """Return the ways in which a mechanism's loops close amid its limits, or at its start without them.

    Raises:
        InputError: as `ClosedChain`.
    """
    chain = ClosedChain(mechanism)
    at = np.array(mechanism.limits).mean(axis=1) if mechanism.limits else chain.start[1]
    try:
        found = chain.assemblies(at)
    except SimulationError:
        at = chain.start[1]
        found = chain.assemblies(at)
    own, *others = (dict(zip(mechanism.drives, map(float, q), strict=True)) for q in found)
    return Assemblies(dict(zip(mechanism.joints, map(float, at), strict=True)), own, tuple(others))


def _differs(own: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    return {name: value for name, value in other.items() if abs(value - own[name]) > 1e-6}


def _said(positions: Mapping[str, float]) -> str:
    return ", ".join(f"{name} = {value:.3g}" for name, value in positions.items())
