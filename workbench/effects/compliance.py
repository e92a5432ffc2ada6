"""Springs and gaps: effects that let motors, links or the base move relative to each other."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Sequence
from typing import ClassVar

import numpy as np

from workbench.core import EffectKey
from workbench.models import Model

from .base import Effect, SignalStage
from .flexible import rotor_inertia
from .motion import Motion
from .parameter import Place, Values


class Compliance(Effect):
    """An effect that gives the tree new joints, and therefore is installed first.

    No sensor measures its links. Its initial values come from the residual torque along the measured motion,
    because closed loops are expensive to simulate.

    Attributes:
        spring: whether it is a spring and a damper behind one axis, with `stiffness` and `damping`: several
            of them are fitted to the torque together.
        diverges: whether trajectories diverge for small parameter changes; then a fit of closed-loop runs
            adds nothing to the fit of the torque.
    """

    stage = SignalStage.MECHANISM
    spring: ClassVar[bool] = False
    diverges: ClassVar[bool] = False

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Return whether a rotor can be separated from its link, once, and has its own inertia."""
        if key.axis is None or any(gives_way(e.key.effect) and _same(e.key, key) for e in model.effects):
            return False
        row = model.transmission[model.axes.index(key.axis)]
        alone = np.count_nonzero(row) == 1 or model.has("actuator_inertia_coupling")
        return rotor_inertia(model, model.axes.index(key.axis)) > 0 and (key.location == "joint" or alone)

    @abstractmethod
    def initial_values(
        self, motions: Sequence[Motion], model: Model, place: Place
    ) -> Sequence[tuple[Values, float]]:
        """Return shapes to try, best first, each with the share of the residual torque that it leaves."""

    def free_responses(self, motion: Motion, model: Model, place: Place, shape: Values) -> np.ndarray:
        """Return what unmeasured states add to the response, by their initial values: (N, n, states).

        One column for each state that begins at one; none where the response knows its beginning.
        """
        del model, place, shape
        return np.zeros((*motion.position.shape, 0))

    def foretells(self, motions: Sequence[Motion], model: Model, place: Place, shape: Values) -> bool:
        """Return whether its response is informative without measured torque for its state."""
        del motions, model, place, shape
        return True


def gives_way(effect: str) -> bool:
    """Return whether an effect of this name is a spring or a gap."""
    return any(getattr(kind, "name", "") == effect for kind in _kinds(Compliance))


def _kinds(of: type[Compliance]) -> Iterator[type[Compliance]]:
    for kind in of.__subclasses__():
        yield kind
        yield from _kinds(kind)


def _same(one: EffectKey, other: EffectKey) -> bool:
    return (one.axis, one.location) == (other.axis, other.location)
