"""The problem: a model and its recordings, with everything that the parts of a search derive from them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from workbench.comparison import with_torque_by_law
from workbench.core import Recording, SimulationError
from workbench.models import Model

from .data import Data, gather_along
from .hypothesis import Fit, Hypothesis
from .loss import rescored, test_noise_floor
from .policy import POLICY
from .removed_share import removed_share
from .screening.candidate import Candidate
from .screening.linear_problem import Linear, is_too_large, linear_along, linear_of
from .screening.one_delay import one_delay_may_suffice
from .screening.sensitivity import Linearisation
from .screening.stiction import candidates
from .screening.torque_columns import regression_of
from .screening.torque_regression import Regression

if TYPE_CHECKING:
    from .node import Node

#: Told what is being done.
Progress = Callable[[str], None]

_KEPT_LINEARISATIONS = 4  # cached: a search seldom returns to older ones, and each holds every row


@dataclass(frozen=True)
class Problem:
    """A model and its recordings, and the settings of the search.

    Attributes:
        start: the model as it is.
        data: the recordings with its noise.
        limit: most effects to add one by one.
        seed: of the noise simulations.
        progress: told what is being done.
        linearisations: of the last nodes, newest first.
        visited: what was begun already, so that nothing is searched twice.
        solved: the joint solution, once it was asked for.
        suspect: asked of each better explanation; raises what ends the search.
    """

    start: Fit
    data: Data
    limit: int
    seed: int
    progress: Progress
    linearisations: deque[Linearisation] = field(
        default_factory=lambda: deque(maxlen=_KEPT_LINEARISATIONS), repr=False
    )
    visited: set[tuple[object, ...]] = field(default_factory=set, repr=False)
    solved: list[Node | None] = field(default_factory=list, repr=False)
    suspect: Callable[[Fit, Data], None] = field(default=lambda best, data: None, repr=False)

    def is_new(self, *begun: object) -> bool:
        """Return whether this is the first call with a key; later calls with the same key return False."""
        new = begun not in self.visited
        self.visited.add(begun)
        return new

    @cached_property
    def linearisation(self) -> Linearisation:
        """Return the linearisation of the loops with the unchanged model."""
        model = self.start.hypothesis.model
        return Linearisation.of(model, self.data, self.start.simulated, len(self.data.recordings))

    @cached_property
    def inverse_dynamics(self) -> tuple[Data, Fit, Regression] | None:
        """Return the recordings along their measured motion, the model there, and all effects as one problem.

        None where nothing drives it there: neither a measured torque nor the law of a loop.
        """
        there = self._followed() if self.data.replay.simulates else (self.data, self.start)
        return None if there is None else (*there, regression_of(there[1], there[0]))

    def _followed(self) -> tuple[Data, Fit] | None:
        replay = self.data.replay
        if not (replay.machine_alone and replay.driven):
            return None
        data = self.data
        return along_measured_motion(self.start.hypothesis.model, data.recordings, data.training, self.seed)

    @property
    def has_many_axes(self) -> bool:
        """Return whether there are more axes than a search adds effects, so that screening takes long."""
        return self.start.hypothesis.model.size > POLICY.most_effects

    @property
    def is_expensive(self) -> bool:
        """Return whether screening in the loop is expensive."""
        return self.data.replay.simulates and self.has_many_axes

    @cached_property
    def linear(self) -> Linear | None:
        """Return every effect in every place as one linear problem, round the loops unless these are too
        large.

        None where loops are too large and nothing drives the machine along its measured motion.
        """
        self.progress("finding out which effects these recordings can tell apart")
        if not self.data.replay.simulates or self.is_expensive or is_too_large(self.linearisation):
            return None if self.inverse_dynamics is None else linear_along(self.inverse_dynamics[2])
        return linear_of(self.linearisation)

    @cached_property
    def screened(self) -> tuple[Candidate, ...]:
        """Return every effect in every place, screened as a first effect."""
        self.progress("screening effects")
        known = None if self.linear is None else self.linear.equations
        return candidates(self.linearisation, self.start, self.data, self.seed, known)

    @cached_property
    def one_effect_may_suffice(self) -> bool:
        """Return whether one effect explains the recordings: as screened, or a delay if that is costly."""
        if self.is_expensive:
            along = self.inverse_dynamics
            return along is not None and one_delay_may_suffice(self.start, self.data, along[2].linearisation)
        before = self.start.test_loss
        least = min((c.test_loss for c in self.screened), default=before)
        return removed_share(before, least, test_noise_floor(self.data)) >= POLICY.explained


def along_measured_motion(
    model: Model, recordings: Sequence[Recording], training: int, seed: int
) -> tuple[Data, Fit] | None:
    """Return recordings along their measured motion, and the unchanged model there.

    None where nothing drives it: neither a measured torque nor the law of a loop; or where it cannot run.
    """
    driven = with_torque_by_law(model, recordings)
    if driven is None:
        return None
    try:
        data, runs = gather_along(model, driven, training, seed)
    except SimulationError:
        return None
    return data, starting_fit(model, data, runs.clean)


def starting_fit(model: Model, data: Data, simulated: Sequence[Recording]) -> Fit:
    """Return the fit of the unchanged model, without effects."""
    return evaluated(Hypothesis(model, ()), simulated, data)


def evaluated(hypothesis: Hypothesis, simulated: Sequence[Recording], data: Data) -> Fit:
    """Return a hypothesis with its current values and its runs of all recordings."""
    unscored = Fit(hypothesis, tuple(simulated), data.mean_squares(simulated), 0.0, 0.0, np.zeros(0))
    return rescored(unscored, data)
