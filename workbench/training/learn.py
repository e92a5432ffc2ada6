"""The learning loop: collect, update, write; it can be stopped and continued without a difference."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from tensordict import TensorDict

from workbench.core import SimulationError

from .checkpoint import load, save
from .curve import Curve, Tally
from .environment import Environment
from .folder import CHECKPOINT, open_folder
from .injected import with_torques
from .loggers import LOGGERS, make_logger
from .machine import Machine
from .ppo import Side, make_ppo
from .randomisation import world_fields
from .settings import Settings, resolved
from .situation import POLICY_S
from .task import Task
from .worlds import BatchWorlds, Worlds

_JUDGED, _SHORTEST = 5, 4.0  # iterations; policy steps of an episode that no policy can do anything about


@dataclass(frozen=True)
class Progress:
    """Progress after one iteration.

    Attributes:
        iteration, iterations: done, and in all.
        reward: mean reward per second over the iteration.
        episode_reward: mean over episodes that ended in it, or the last that did.
        episode_s: their mean length [s].
        steps_per_s: policy steps of all worlds per second.
        left_s: time left [s].
    """

    iteration: int
    iterations: int
    reward: float
    episode_reward: float
    episode_s: float
    steps_per_s: float
    left_s: float


def make_worlds(machine: Machine, settings: Settings, seed: int) -> Worlds:
    """Return the worlds for a device: MuJoCo's batch on the CPU, MuJoCo Warp on a GPU."""
    fields = world_fields(machine, settings.randomisation, settings.worlds, seed)
    if settings.device.startswith("cuda"):
        from .warp_worlds import WarpWorlds

        worlds: Worlds = WarpWorlds(machine, settings.worlds, fields, settings.device)
    else:
        worlds = BatchWorlds(machine, settings.worlds, fields, settings.threads)
    return with_torques(worlds, machine)


def learn(
    task: Task,
    machine: Machine,
    settings: Settings,
    folder: Path,
    *,
    extra: Mapping[str, Any] | None = None,
    resume: bool = False,
    force: bool = False,
    logger: str = LOGGERS[0],
    tell: Callable[[Progress], None] = lambda progress: None,
) -> torch.nn.Module | None:
    """Train a policy, or continue a run.

    The folder gets the resolved configuration, the machine's MJCF, a learning curve (CSV, and what the logger
    writes) and a checkpoint that is replaced every `save_every` iterations.

    Args:
        task: what to learn.
        machine: with what.
        settings: how; a resumed run has to be given those it began with, but for `iterations`.
        folder: of the run.
        extra: further entries of the configuration.
        resume: whether to go on from the folder's checkpoint; on the CPU this gives the result of a run that
            was never stopped.
        force: whether to begin anew where the folder holds a run.
        logger: shows the curve while it is learned, one of `LOGGERS`.
        tell: is told after every iteration.

    Returns:
        The policy (rsl_rl's actor), in evaluation mode; None in all processes but the first.

    Raises:
        InputError: the folder holds a run already (neither resumed nor forced), or another one (resumed).
        SimulationError: observations or rewards stopped being numbers.
    """
    torch.set_num_threads(1)  # more of them wait for each other where cores are busy
    rank, ranks = int(os.environ.get("RANK", 0)), int(os.environ.get("WORLD_SIZE", 1))
    device = _join(settings.device, rank, ranks)
    seed = settings.seed + 1000 * rank
    config = resolved(task, machine, settings, {**(extra or {}), "processes": ranks})
    if rank == 0:
        open_folder(folder, config, task, machine, resume=resume, force=force)
    torch.manual_seed(seed)
    worlds = make_worlds(machine, settings, seed)
    environment = Environment(task, machine, worlds, settings.worlds, settings.randomisation, seed)
    environment.spread()
    side = Side(environment, device)
    group = {"global_rank": rank, "local_rank": rank, "world_size": ranks} if ranks > 1 else None
    torch.manual_seed(settings.seed)  # all processes begin with one policy
    ppo = make_ppo(side, settings.learning, task.hidden, group)
    torch.manual_seed(seed)
    own = folder / (CHECKPOINT if rank == 0 else f"checkpoint.{rank}.pt")
    first, tally, spent, seen = 0, Tally(settings.worlds, device), 0.0, side.observe()
    if resume:
        shared, mine = load(folder / CHECKPOINT, device), load(own, device)
        first, spent = int(shared["iteration"]), float(shared["seconds"])
        ppo.load(shared["learner"], None, True)
        environment.restore(mine["environment"])
        tally.restore(mine["tally"])
        seen = TensorDict(mine["seen"], batch_size=[settings.worlds], device=device)
        torch.set_rng_state(mine["random"].cpu())
        if "random_device" in mine:
            torch.cuda.set_rng_state(mine["random_device"].cpu(), device)
    ppo.train_mode()
    curve = Curve(folder, first, make_logger(logger, folder, first, config)) if rank == 0 else None

    def keep(done: int) -> None:
        mine: dict[str, Any] = {
            "environment": environment.state(),
            "tally": tally.state(),
            "seen": dict(seen.items()),
            "random": torch.get_rng_state(),
        }
        if device.startswith("cuda"):
            mine["random_device"] = torch.cuda.get_rng_state(device)
        shared = {"iteration": done, "seconds": spent, "learner": ppo.save()} if rank == 0 else {}
        save(own, {**mine, **shared})

    for iteration in range(first, settings.iterations):
        begun = time.perf_counter()
        with torch.no_grad():
            for _ in range(settings.learning.rollout):
                action = ppo.act(seen)
                seen, reward, ended, late, step = side.step(action)
                ppo.process_env_step(seen, reward, ended, {"time_outs": late})
                tally.add(reward, ended, step.terms)
            ppo.compute_returns(seen)
        losses = ppo.update()
        took = time.perf_counter() - begun
        spent += took
        row = tally.row()
        if not all(map(math.isfinite, losses.values())):
            raise SimulationError(f"training diverged in iteration {iteration + 1}: its losses are {losses}")
        done = iteration + 1
        if done == first + _JUDGED:
            _refuse_hopeless(row["episode_s"], task, machine)
        if curve is not None:
            rate = ranks * settings.worlds * settings.learning.rollout / took
            values = {"seconds": spent, "steps_per_s": rate, **row, "learning_rate": ppo.learning_rate}
            values["action_std"] = float(ppo.actor.output_std.detach().mean())
            curve.add(done, {**values, **{f"loss_{k}": v for k, v in losses.items()}})
            left = (settings.iterations - done) * (spent / done)
            tell(
                Progress(
                    done,
                    settings.iterations,
                    row["reward"],
                    row["episode_reward"],
                    row["episode_s"],
                    rate,
                    left,
                )
            )
        if done % settings.save_every == 0 or done == settings.iterations:
            if curve is not None:  # first: a row too many is dropped by who goes on, one too few is lost
                curve.flush()
            keep(done)
    if curve is not None:
        curve.close()
    if ranks > 1:
        torch.distributed.destroy_process_group()
    ppo.eval_mode()
    return ppo.get_policy() if rank == 0 else None


def _refuse_hopeless(episode_s: float, task: Task, machine: Machine) -> None:
    """Stop where every episode ends as soon as it begins: no policy has a say in that.

    Raises:
        SimulationError: says how long episodes last, and of what.
    """
    if not 0.0 < episode_s < _SHORTEST * POLICY_S:
        return
    what = (
        f"its trunk is {machine.height:.3g} m over the ground there" if machine.floating else "see its limits"
    )
    raise SimulationError(
        f"this cannot be trained: after {_JUDGED} iterations episodes last {episode_s:.3f} s of "
        f"{task.episode_s:g} s. {machine.model.name} falls at once from its start posture ({what}); try "
        "another posture, or gains that hold it"
    )


def _join(device: str, rank: int, ranks: int) -> str:
    """Join the other processes that torchrun started; returns this one's device."""
    if ranks == 1:
        return device
    local = int(os.environ.get("LOCAL_RANK", rank))
    if device.startswith("cuda"):
        device = f"cuda:{local}"
        torch.cuda.set_device(local)
    backend = "nccl" if device.startswith("cuda") else "gloo"
    torch.distributed.init_process_group(backend, rank=rank, world_size=ranks)
    return device
