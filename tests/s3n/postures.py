"""Mechanisms whose transmission depends on the posture, built once for all tests."""

from functools import lru_cache

import numpy as np
from posture_schedule import Schedule

from workbench.mechanism import ClosedChain
from workbench.models import Model, read_model
from workbench.s3n.posture import PostureDependent
from workbench.s3n.posture_chain import PostureChain

NAMES = ("four_bar", "five_bar", "ankle")


@lru_cache
def model(name: str) -> Model:
    return read_model(name)


@lru_cache
def drake(name: str) -> ClosedChain:
    chain = model(name).closed_chain
    assert chain is not None
    return ClosedChain(chain)


@lru_cache
def exact(name: str) -> PostureChain:
    return PostureChain(model(name))


@lru_cache
def series(name: str) -> PostureDependent:
    return PostureDependent(model(name))


@lru_cache
def schedule(name: str) -> Schedule:
    return Schedule(model(name))


def states(name: str, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Postures and rates (count, n) within the limits."""
    generator = np.random.default_rng(seed)
    limits = np.array(model(name).closed_chain.limits)  # pyright: ignore[reportOptionalMemberAccess]
    q = generator.uniform(limits[:, 0], limits[:, 1], (count, len(limits)))
    return q, generator.uniform(-8.0, 8.0, q.shape)
