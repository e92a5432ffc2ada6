"""What is checked: one model in every engine, and the states at which they are compared."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from workbench.core import InputError, SimulationError
from workbench.effects import Plant, compile_plant
from workbench.effects.structure import is_parallelogram
from workbench.mechanism import ClosedChain, Reduced
from workbench.models import VARIANTS, Model, load_mjcf
from workbench.s3n import reach, with_variant
from workbench.serial_tree import SerialTree

from .states import States, random_states

STRUCTURAL = frozenset(name for names in VARIANTS.values() for name in names)


@dataclass(frozen=True)
class Subject:
    """A model on the bench.

    Attributes:
        model: with its structural effects only; friction and the like are not what is checked.
        states: K states in serial coordinates.
        chain: the closed chain in Drake, where the model names one.
        left_out: effects that were taken out.
        tolerance: largest relative difference between what identification gave and the closed chain.
        unreached: number of states that were drawn too, and that the closed chain cannot be in.
        beyond: parts of the limits that are not checked, and why; none of the states is there.
    """

    model: Model
    states: States
    chain: ClosedChain | None
    left_out: tuple[str, ...]
    tolerance: float
    unreached: int = 0
    beyond: tuple[str, ...] = ()

    @staticmethod
    def of(model: Model, samples: int, seed: int, tolerance: float) -> Subject:
        """Prepare a model.

        Raises:
            InputError: its closed chain cannot be read.
        """
        inside = tuple(e for e in model.effects if e.key.effect in STRUCTURAL)
        out = tuple(str(e.key) for e in model.effects if e.key.effect not in STRUCTURAL)
        chain = None if model.closed_chain is None else ClosedChain(model.closed_chain)
        if chain is not None and chain.size != model.size:
            raise InputError(
                f"the closed chain has {chain.size} drives and the model {model.size} axes",
                file=model.source, column="closed_chain.drives", remedy="name one drive per axis",
            )  # fmt: skip
        model, beyond = _within_reach(model)
        middle = np.zeros(model.size) if chain is None else chain.start[1]
        drawn = random_states(model, samples, seed, middle)
        states = _reachable(chain, drawn)
        unreached = len(drawn) - len(states)
        return Subject(replace(model, effects=inside), states, chain, out, tolerance, unreached, beyond)

    @cached_property
    def tree(self) -> SerialTree:
        """Return the serial tree in Pinocchio, its drives the Kin-Only way."""
        return SerialTree(self.model)

    @cached_property
    def plants(self) -> dict[str, Plant]:
        """Return the plain variants that this model has what it takes for, compiled for MuJoCo."""
        names = VARIANTS if is_parallelogram(self.model) else ("kin_only", "s3n_act")
        return {name: compile_plant(with_variant(self.model, name)) for name in names}

    @cached_property
    def real(self) -> list[Reduced]:
        """Return the closed chain's dynamics at every state, links only, serial coordinates."""
        assert self.chain is not None
        pairs = zip(self.states.position, self.states.velocity, strict=True)
        return [self.chain.serial_dynamics(q, v) for q, v in pairs]

    @property
    def foot(self) -> str | None:
        """Return the MJCF site at the foot, if there is one."""
        names = {site.name for site in load_mjcf(self.model.serial).sites}
        wanted = (self.model.payload_site, self.model.closed_chain.foot if self.model.closed_chain else None)
        return next((name for name in wanted if name in names), None)


def _within_reach(model: Model) -> tuple[Model, tuple[str, ...]]:
    """The model with limits that its closed chain can be used in, and what of its own is left out."""
    if model.closed_chain is None or not model.closed_chain.limits or not model.posture_dependent:
        return model, ()
    try:
        found = reach(model)
    except InputError:
        return model, ()  # said where the terms are compared
    return found.of(model), found.left_out


def _reachable(chain: ClosedChain | None, states: States) -> States:
    """Those states that the closed chain can be in.

    Raises:
        InputError: it can be in none of them.
    """
    if chain is None:
        return states
    good = []
    for k, (q, v) in enumerate(zip(states.position, states.velocity, strict=True)):
        try:
            chain.serial_dynamics(q, v)
            chain.jacobian(q)
            good.append(k)
        except SimulationError:
            continue
    if not good:
        raise InputError(
            "no posture within the limits closes the loops", file=chain.mechanism.file,
            column="closed_chain.limits", remedy="correct the limits, the loops or the start posture",
        )  # fmt: skip
    return States(states.position[good], states.velocity[good])
