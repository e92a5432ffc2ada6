"""Small environments and runs for the tests."""

from functools import cache
from pathlib import Path

import numpy as np

from workbench.effects import load_model
from workbench.training.environment import Environment
from workbench.training.learn import learn
from workbench.training.machine import Machine, make_machine
from workbench.training.randomisation import world_fields
from workbench.training.settings import Learning, Settings
from workbench.training.tasks import TASKS
from workbench.training.worlds import BatchWorlds


@cache
def machine(kind: str, variant: str = "s3n_full") -> Machine:
    return make_machine(kind, load_model("leg"), variant)


def environment(task: str, worlds: int = 4, seed: int = 0, noise: bool = True) -> Environment:
    wanted = TASKS[task]
    made, settings = machine(wanted.machine), wanted.differences()
    engine = BatchWorlds(made, worlds, world_fields(made, settings, worlds, seed), threads=1)
    return Environment(wanted, made, engine, worlds, settings, seed, noise)


def run(folder: Path, iterations: int, seed: int = 0, **others) -> None:
    """A small run of `reach` with a checkpoint every other iteration."""
    wanted, learning = TASKS["reach"], Learning(rollout=8)
    settings = Settings(
        worlds=16, iterations=iterations, seed=seed, threads=1, save_every=2, learning=learning
    )
    learn(wanted, machine(wanted.machine), settings, folder, extra={"record": None}, **others)


def actions(task: str, worlds: int, steps: int, seed: int = 3) -> np.ndarray:
    """(steps, W, n)."""
    n = machine(TASKS[task].machine).size
    return 0.3 * np.random.default_rng(seed).standard_normal((steps, worlds, n))
