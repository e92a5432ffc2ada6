"""What a step of each way of a mechanism takes, beside a step of the plain serial tree."""

from __future__ import annotations

import time
from collections.abc import Callable

import mujoco
import numpy as np
from mechanism_ways import WAYS, Bench, MappedWorld
from mujoco.batch import Batch
from posture_batch import ScheduledBatch

from workbench.s3n.worlds import World

WORLDS = 256


def costs(bench: Bench, rounds: int = 150) -> dict[str, float]:
    """Time of one step of one world over kin_only's, the median of alternating rounds."""
    worlds = {way: bench.world(way, 0.001) for way in WAYS}
    held = bench.law(np.tile(bench.middle, (1, 1)))(0, bench.middle, np.zeros_like(bench.middle))
    times: dict[str, list[float]] = {way: [] for way in WAYS}
    for _ in range(rounds):
        for way, world in worlds.items():
            steps = 20 if way.startswith("scheduled") or way == "callback" else 200
            mujoco.mj_resetData(world.m, world.data)
            world.put(bench.middle, np.zeros_like(bench.middle))
            if way == "constraint":
                world = worlds[way] = bench.world(way, 0.001)
            stepper = world.advance if type(world) is not MappedWorld else _in_c(world)
            begun = time.perf_counter()
            stepper(held, steps)
            times[way].append((time.perf_counter() - begun) / steps)
    base = np.array(times["kin_only"])
    return {way: float(np.median(np.array(values) / base)) for way, values in times.items()}


def _in_c(world: World) -> Callable[[np.ndarray, int], None]:
    def advance(torque: np.ndarray, steps: int) -> None:
        del torque
        mujoco.mj_step(world.m, world.data, steps)

    return advance


def batch_costs(bench: Bench, rounds: int = 120, steps: int = 4) -> dict[str, float]:
    """The same of a world among `WORLDS` in a batch on one thread; the callback has none."""
    plain = {way: bench.plain(way) for way in ("kin_only", "s3n_frozen", "fitted")}
    loop = bench.world("constraint", 0.001)
    batches = {way: Batch(m, WORLDS, 1) for way, m in (*plain.items(), ("constraint", loop.m))}
    for way, batch in batches.items():
        batch.bind("qpos")[:] = loop.data.qpos if way == "constraint" else bench.middle
    scheduled = {
        way: ScheduledBatch(bench.schedule, WORLDS, threads=1, hold=hold)
        for way, hold in (("scheduled", 1), ("scheduled_4", 4))
    }
    start = np.tile(bench.middle, (WORLDS, 1))
    times: dict[str, list[float]] = {way: [] for way in (*batches, *scheduled)}
    for _ in range(rounds):
        for way in times:
            if way in scheduled:
                scheduled[way].put(start, np.zeros_like(start))
            begun = time.perf_counter()
            if way in scheduled:
                scheduled[way].step(np.zeros_like(start), steps)
            else:
                batches[way].step(nstep=steps)
            times[way].append(time.perf_counter() - begun)
    base = np.array(times["kin_only"])
    out = {way: float(np.median(np.array(values) / base)) for way, values in times.items()}
    return out | {"callback": float("nan")}
