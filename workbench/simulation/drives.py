"""The drives of one run: from the commanded torque to the torque on the shaft."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workbench.core.compiled import compiled
from workbench.effects import Plant, follow

from .experiment import Experiment, whole_and_part


class Drives(NamedTuple):
    """The torque chain of the drives as numbers, in the order of its stages; arrays (n,).

    Attributes:
        whole, fraction: delay in substeps.
        limit, stall, no_load: of the torque; infinite for none.
        full_braking: whether torque against the motion keeps the stall torque.
        lag: time constant of the current loops over the substep, 0 for none.
        gain, bias: behind the tap.
        heating, cooling: share that heat takes per squared torque; time constant over the substep.
        step: substep [s].
        current, heat, speed: state of the current loops, of the heat, and the speed a substep ago.
    """

    whole: int
    fraction: float
    limit: np.ndarray
    stall: np.ndarray
    no_load: np.ndarray
    full_braking: bool
    lag: np.ndarray
    gain: np.ndarray
    bias: np.ndarray
    heating: np.ndarray
    cooling: np.ndarray
    step: float
    current: np.ndarray
    heat: np.ndarray
    speed: np.ndarray


def drives_of(e: Experiment, plant: Plant) -> Drives:
    """Return the drives of a plant in an experiment, at its start."""
    chain, n = plant.chain, plant.model.size
    # where a loop's log already carries the delay it has been applied all the same, only before the log
    whole, fraction = whole_and_part(e.delay(chain.delay_s, plant.model) / e.step)
    # torque measured behind the drive has its lag already
    lag = np.zeros(n) if e.behind == "all" else chain.lag / e.step
    return Drives(
        whole=whole,
        fraction=fraction,
        limit=np.array(chain.limit, float),
        stall=np.array(chain.stall, float),
        no_load=np.array(chain.no_load, float),
        full_braking=chain.full_braking,
        lag=lag,
        gain=np.array(chain.gain, float),
        bias=np.array(chain.bias, float),
        heating=np.array(chain.heating, float),
        cooling=chain.heat_time / e.step,
        step=e.step,
        current=e.before.copy(),
        heat=np.zeros(n),
        speed=plant.model.transmission @ e.start[1],
    )


@compiled()
def pass_on(
    d: Drives,
    command: np.ndarray,
    now: int,
    speed: np.ndarray,
    tap: np.ndarray,
    shaft: np.ndarray,
    early: np.ndarray,
) -> None:
    """Pass the command (rows, n) of substep `now` (its row) through the chain, with drive speeds (n,).

    Writes, (n,) each: `tap`, `torque_measured` just after the substep's start; `shaft`, the mean torque
    over it; `early`, what an edge inside it adds to the impulse's moment [N m s^2]: a mean torque has the
    right impulse, but an edge also moves the position.
    """
    for i in range(len(tap)):
        newer, older = command[now - d.whole, i], command[now - d.whole - 1, i]
        # a tap shows the torque at one time, a step feels limits that follow the speed half a step later
        half = 1.5 * speed[i] - 0.5 * d.speed[i]
        d.speed[i] = speed[i]
        at = older if d.fraction > 0.0 else newer
        tap[i] = _limited(d, i, at, speed[i])
        newer, older = _limited(d, i, newer, half), _limited(d, i, older, half)
        mean, edge = newer * (1.0 - d.fraction) + older * d.fraction, older - newer
        if d.lag[i] > 0.0:
            tap[i], edge = d.current[i], 0.0
            d.current[i], mean = follow(d.current[i], older, newer, d.fraction, d.lag[i])
        gain = d.gain[i]
        if d.heating[i] != 0.0:
            square = mean * mean
            d.heat[i], warm = follow(d.heat[i], square, square, 0.0, d.cooling[i])
            gain *= max(1.0 - d.heating[i] * warm, 0.0)
        shaft[i] = gain * mean + d.bias[i]
        early[i] = 0.5 * d.step * d.step * d.fraction * (1.0 - d.fraction) * gain * edge


@compiled()
def _limited(d: Drives, axis: int, torque: float, speed: float) -> float:
    """What a drive gives of a torque at a speed."""
    top = d.limit[axis]
    if np.isfinite(d.stall[axis]):
        driving = torque * speed > 0.0 or not d.full_braking
        share = min(max(1.0 - abs(speed) / d.no_load[axis], 0.0), 1.0) if driving else 1.0
        top = min(top, d.stall[axis] * share)
    return min(max(torque, -top), top)
