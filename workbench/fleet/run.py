"""All robots of a fleet side by side: on the cores of this machine, or on a cluster."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from joblib import Parallel, cpu_count, delayed, parallel_config

from workbench.core import FORMAT, InputError
from workbench.core.text import counted

from .robots import Robot
from .store import fingerprint, result_file, stored

Progress = Callable[[str, float], None]

_ROUNDS = 3  # a worker that dies takes others' work with it; the last round takes one robot at a time


def run_fleet(
    robots: Sequence[Robot],
    folder: str | Path,
    *,
    seed: int = 0,
    jobs: int = -1,
    ray: str | None = None,
    force: bool = False,
    progress: Progress = lambda text, done: None,
) -> list[dict[str, Any]]:
    """Improve the model of every robot with its own recordings.

    Every result is kept in `folder` as soon as it is there. A robot whose result is there, of the same model,
    recordings, seed and versions, is not run again, so that a run that was stopped goes on.

    Args:
        robots: of `find_robots`.
        folder: for results, one file per robot, and improved models; on a cluster, one that all machines see.
        seed: of the noise simulations.
        jobs: workers; -1 for as many as there are cores, here or in the cluster.
        ray: address of a Ray cluster (``"auto"`` for the one of this machine); None for this machine's cores.
        force: replace results of other inputs.
        progress: told how many robots are done, and which part.

    Returns:
        What was kept of each, in the order of `robots`; of one that failed, ``failed`` says why in one line.
        The same whatever the number of workers.

    Raises:
        InputError: a model that cannot be read, a result of other inputs in the folder, no such cluster.
    """
    folder = Path(folder).resolve()
    prints = {r.name: fingerprint(r, seed) for r in robots}
    robots = [_anywhere(r) for r in robots]
    waiting = []
    for robot in robots:
        kept = stored(folder, robot.name)
        if kept is None or kept["inputs"] != prints[robot.name]:
            if kept is not None and not force:
                raise InputError(
                    f"holds the result of '{robot.name}' from other recordings, another model or seed, or "
                    "other versions of workbench and its libraries",
                    file=result_file(folder, robot.name), remedy="choose another folder, or add --force",
                )  # fmt: skip
            waiting.append(robot)
    for robot in waiting:
        # what is not there was not done: a run that is stopped now knows by this
        result_file(folder, robot.name).unlink(missing_ok=True)
    folder.mkdir(parents=True, exist_ok=True)
    failed: dict[str, str] = {}
    with nullcontext() if ray is None else _cluster(ray):
        count = jobs if ray is not None or jobs > 0 else max(1, cpu_count() + 1 + jobs)
        for turn in range(_ROUNDS):
            batches = [waiting] if turn < _ROUNDS - 1 else [[robot] for robot in waiting]
            for batch in batches:
                work = [(r, folder, seed, prints[r.name]) for r in batch]
                _run(work, count, ray is not None, failed, len(robots), progress)
            waiting = [r for r in waiting if r.name not in failed and stored(folder, r.name) is None]
            if not waiting:
                break
    failed |= {r.name: "its worker died each time; out of memory, perhaps" for r in waiting}
    return [_result(folder, r, prints[r.name], failed) for r in robots]


def _run(
    work: Sequence[tuple[Robot, Path, int, str]],
    count: int,
    on_cluster: bool,
    failed: dict[str, str],
    whole: int,
    progress: Progress,
) -> None:
    """One go at robots; `failed` gets the reasons of those that failed. One whose worker died has none."""
    share = 1 if on_cluster or count < 1 else max(1, (os.cpu_count() or 1) // count)
    # in a process of its own a robot that kills it takes nobody along; a lone worker is this very process
    alone = len(work) == 1 and count > 1
    jobs = 2 if alone else count
    # joblib's backend for Ray tells all at the end
    told_as = "list" if on_cluster else "generator_unordered"
    side_by_side: Any = Parallel(jobs, batch_size=1, pre_dispatch="all", return_as=told_as)  # pyright: ignore
    done = whole - len(work)
    try:
        for name, problem in side_by_side(delayed(of_one_robot)(*task, share) for task in work):
            done += 1
            progress(f"{done} of {counted(whole, 'robot')}", done / whole)
            if problem is not None:
                failed[name] = problem
    except Exception as error:
        if not _worker_died(error):
            raise


def of_one_robot(robot: Robot, folder: Path, seed: int, inputs: str, cores: int) -> tuple[str, str | None]:
    """Diagnose one robot in the process of a worker: its name, and why it failed, if it did."""
    from .task import diagnose_robot  # simulators and all are for who works with them

    return robot.name, diagnose_robot(robot, folder, seed, inputs, cores)


def _worker_died(error: Exception) -> bool:
    kinds = {kind.__name__ for kind in type(error).__mro__}
    return bool(kinds & {"BrokenProcessPool", "TerminatedWorkerError", "RayError"})


def _cluster(address: str) -> AbstractContextManager[Any]:
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    try:
        import ray as cluster
        from ray.util.joblib import register_ray
    except ImportError as error:
        raise InputError("a cluster needs Ray", remedy="pip install 'robot-workbench[ray]'") from error
    try:
        cluster.init(address, log_to_driver=False, logging_level=logging.ERROR, ignore_reinit_error=True)
    except (ConnectionError, RuntimeError, ValueError) as error:
        remedy = "start one with 'ray start --head', or give its address"
        raise InputError(f"no Ray cluster answers at '{address}'", remedy=remedy) from error
    register_ray()
    # a worker that dies is started again, and so is what it was at, unless that is what kills it
    again = {"max_restarts": 8, "max_task_retries": 2, "num_cpus": 1}
    return parallel_config(backend="ray", ray_remote_args=again)


def _anywhere(robot: Robot) -> Robot:
    """A robot whose files any process finds."""
    model = str(Path(robot.model).resolve()) if Path(robot.model).exists() else robot.model
    training, held_out = (tuple(f.resolve() for f in x) for x in (robot.training, robot.held_out))
    return replace(robot, model=model, training=training, held_out=held_out)


def _result(folder: Path, robot: Robot, inputs: str, failed: dict[str, str]) -> dict[str, Any]:
    content = stored(folder, robot.name) if robot.name not in failed else None
    if content is not None:
        return content
    return {
        "format": FORMAT,
        "rig": robot.name,
        "inputs": inputs,
        "model": Path(robot.model).stem,
        "recordings": [f.stem for f in robot.training],
        "held_out": [f.stem for f in robot.held_out],
        "left_out": [],
        "failed": failed[robot.name],
        "verdict": None,
        "improved": None,
        "diagnosis": None,
        "improvement": None,
    }
