"""The learning loop: collect, update, write down; stops and goes on without a difference."""

from __future__ import annotations

import json
import math
import os
import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import torch
from tensordict import TensorDict

from workbench.core import InputError, SimulationError
from workbench.core.files import write_whole
from workbench.models import Model, write_model

from .checkpoint import load, save
from .curve import Curve, Tally
from .environment import Environment
from .machine import Machine
from .ppo import Side, make_ppo
from .randomisation import world_fields
from .settings import Settings, resolved
from .situation import POLICY_S
from .task_file import TASK_FILE
from .tasks import Task
from .worlds import BatchWorlds, Worlds

CONFIG, CHECKPOINT, MJCF, MODEL = "config.json", "checkpoint.pt", "machine.xml", "model"
_JUDGED, _SHORTEST = 5, 4.0  # iterations; policy steps of an episode that no policy can do anything about


@dataclass(frozen=True)
class Progress:
    """After one iteration.

    Attributes:
        iteration, iterations: done, and in all.
        reward: mean reward a second over the iteration.
        episode_reward: mean over episodes that ended in it, or the last that did.
        episode_s: their mean length [s].
        steps_per_s: policy steps of all worlds a second.
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
    """The engine for a device: MuJoCo's batch on the CPU, MuJoCo Warp on a GPU."""
    fields = world_fields(machine, settings.randomisation, settings.worlds, seed)
    if settings.device.startswith("cuda"):
        from .warp_worlds import WarpWorlds

        return WarpWorlds(machine, settings.worlds, fields, settings.device)
    return BatchWorlds(machine, settings.worlds, fields, settings.threads)


def learn(
    task: Task,
    machine: Machine,
    settings: Settings,
    folder: Path,
    *,
    extra: Mapping[str, Any] | None = None,
    resume: bool = False,
    force: bool = False,
    tell: Callable[[Progress], None] = lambda progress: None,
) -> torch.nn.Module | None:
    """Train a policy, or go on with one.

    The folder gets the resolved configuration, the machine's MJCF, a learning curve (CSV and TensorBoard) and
    a checkpoint that is replaced every `save_every` iterations.

    Args:
        task: what to learn.
        machine: with what.
        settings: how; a resumed run has to be given those it began with, but for `iterations`.
        folder: of the run.
        extra: further entries of the configuration.
        resume: whether to go on from the folder's checkpoint; on the CPU this gives the result of a run that
            was never stopped.
        force: whether to begin anew where the folder holds a run.
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
        _open_folder(folder, config, machine, resume, force)
        if task.source is not None:
            write_whole(folder / MODEL / TASK_FILE, task.source, force=True)
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
    curve = Curve(folder, first) if rank == 0 else None

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
            raise SimulationError(
                f"learning broke down in iteration {iteration + 1}: its losses are {losses}"
            )
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
            keep(done)
            if curve is not None:
                curve.flush()
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
        f"{task.episode_s:g} s. {machine.model.name} falls as soon as it begins in its posture ({what}); "
        "try another posture, or gains that hold it"
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


def _open_folder(folder: Path, config: dict[str, Any], machine: Machine, resume: bool, force: bool) -> None:
    """Write what the run is; a run is gone on with only with the same, and is lost only by force."""
    file = folder / CONFIG
    if resume:
        try:
            before = json.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise InputError("no run to go on with", file=file, remedy="name the folder of a run") from error
        for key in ("task", "variant", "model", "processes"):
            if before.get(key) != config[key]:
                raise InputError(
                    f"the run has another {key}",
                    file=file,
                    column=key,
                    remedy="resume with what it began with",
                )
        old, new = before.get("settings", {}), config["settings"]
        for key in ("worlds", "seed", "learning", "randomisation"):
            if old.get(key) != json.loads(json.dumps(new[key])):
                raise InputError(
                    f"the run began with {key} = {old.get(key)}", file=file, column=key,
                    remedy="resume with the same",
                )  # fmt: skip
    elif force:
        (folder / CHECKPOINT).unlink(missing_ok=True)  # or --resume would go on with it
    elif (folder / CHECKPOINT).exists():  # a run that ended before its first one begins anew
        raise InputError(
            "the folder holds a run",
            file=folder,
            remedy="choose another, go on with --resume, or begin anew with --force",
        )
    write_whole(file, json.dumps(config, indent=1) + "\n", force=True)
    write_whole(folder / MJCF, machine.xml, force=True)
    _copy_model(machine.model, folder / MODEL)


def _copy_model(model: Model, folder: Path) -> None:
    """The leg's model as a file, with the files that it names, and those that they name."""
    copied: dict[Path, Path] = {}
    for path in replace(model, source=None).files:  # its own is written anew
        copied[path] = folder / model.place(path)
        copied[path].parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, copied[path])
    chain = model.closed_chain
    own = replace(
        model,
        serial=copied[model.serial].resolve(),
        closed_chain=chain and replace(chain, file=copied[chain.file].resolve()),
    )
    write_model(own, folder / "model.toml", force=True)
