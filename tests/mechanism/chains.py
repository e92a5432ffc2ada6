"""The shipped mechanisms, built once."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from workbench.core import Mechanism
from workbench.core.paths import closed_chain_file
from workbench.mechanism import ClosedChain, DiscreteChain, Motion
from workbench.mechanism.tree import Tree
from workbench.models import read_model

NAMES = ("leg", "four_bar", "five_bar", "ankle")
LEGS = ("fl", "fr", "rl", "rr")


def mechanism(name: str) -> Mechanism:
    """As the model file of that name describes it."""
    found = read_model(name).closed_chain
    assert found is not None
    return found


@lru_cache
def chain(name: str) -> ClosedChain:
    return ClosedChain(mechanism(name))


def open_loop(chain: ClosedChain, drives: np.ndarray) -> float:
    """Largest gap [m] of a loop where the chain says that its links are."""
    tree = Tree(chain.mechanism)
    tree.move(chain.tree_position(drives))
    return float(tree.open_loops().max())


def joints_at(name: str, parts: tuple[float, float]) -> np.ndarray:
    """Serial positions (2,) at parts 0..1 of the way between the limits."""
    low, high = np.transpose(mechanism(name).limits)
    return low + np.array(parts) * (high - low)


def quadruped() -> Mechanism:
    return Mechanism(
        closed_chain_file("quadruped"),
        drives=tuple(f"{leg}_{joint}" for leg in LEGS for joint in ("hip", "crank_pin")),
        joints=tuple(f"{leg}_{joint}" for leg in LEGS for joint in ("hip", "knee")),
        loops=tuple((f"{leg}_coupler_end", f"{leg}_rear_arm_end") for leg in LEGS),
        foot="fl_foot",
    )


def central(function, at: np.ndarray, way: np.ndarray, step: float = 1e-5):
    """Central difference of a function of positions along `way`."""
    return (function(at + step * way) - function(at - step * way)) / (2 * step)


def simulate_discrete(
    mechanism: Mechanism,
    inertia: Sequence[float],
    damping: Sequence[float],
    torque: np.ndarray,
    step: float,
    q0: np.ndarray,
    substeps: int = 1,
) -> Motion:
    """The motion that `simulate` gives, from Drake's discrete simulation; arguments as there."""
    chain = DiscreteChain(mechanism, inertia, damping, step / substeps)
    chain.reset(q0)
    positions, velocities = [chain.position], [chain.velocity]
    for held in torque:
        for _ in range(substeps):
            chain.advance(np.asarray(held, float))
        positions.append(chain.position)
        velocities.append(chain.velocity)
    return Motion(step * np.arange(len(positions)), np.array(positions), np.array(velocities))
