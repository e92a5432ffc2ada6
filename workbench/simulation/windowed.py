"""Windows of a machine on its ground, simulated and differentiated row by row as machine code."""

from __future__ import annotations

import numpy as np

from workbench.core.compiled import compiled

from .native import mj_step
from .world import World, push

_PROBE = 1e-6  # of the state and the torque: step of a difference


@compiled()
def _place(world: World, state: np.ndarray) -> None:
    """Put a world into a state (2, nv)."""
    world.position[:], world.speed[:] = state[0], state[1]
    world.laws.before[:] = state[1]


@compiled()
def _row(
    world: World, sensed: np.ndarray, columns: np.ndarray, shaft: np.ndarray, stride: int, force: np.ndarray
) -> None:
    """Go through one row under a held torque; `force` (3 F,) is what stands at its beginning."""
    for k in range(stride * world.substeps):
        push(world, shaft)
        mj_step(world.model, world.data)
        if k == 0:
            for i in range(len(columns)):
                force[i] = sensed[columns[i]]


@compiled(nogil=True)
def run_windows(
    world: World,
    sensed: np.ndarray,
    columns: np.ndarray,
    shaft: np.ndarray,
    stride: int,
    edges: np.ndarray,
    states: np.ndarray,
    position: np.ndarray,
    speed: np.ndarray,
    force: np.ndarray,
) -> None:
    """Fill the motion of the joints (N, nv) and the force (N, 3 F)."""
    for w in range(len(states)):
        _place(world, states[w])
        for k in range(edges[w], edges[w + 1]):
            position[k], speed[k] = world.position, world.speed
            _row(world, sensed, columns, shaft[k], stride, force[k])


@compiled(nogil=True)
def differentiate(
    world: World,
    sensed: np.ndarray,
    columns: np.ndarray,
    shaft: np.ndarray,
    stride: int,
    edges: np.ndarray,
    states: np.ndarray,
    slopes: np.ndarray,
    touch: np.ndarray,
) -> None:
    """Fill the derivatives of each row of the windows that begin in `states` (see `_Rows`)."""
    joints, n, feet = len(world.speed), shaft.shape[1], len(columns)
    size = 2 * joints
    base, felt, other, pushed = np.zeros((2, joints)), np.zeros(feet), np.zeros(feet), np.zeros(n)
    after, now, end = np.zeros((2, joints)), np.zeros((2, joints)), np.zeros((2, joints))
    for w in range(len(states)):
        after[:] = states[w]
        for k in range(edges[w], edges[w + 1]):
            row = k - edges[0]
            now[:] = after
            _place(world, now)
            _row(world, sensed, columns, shaft[k], stride, felt)
            after[0], after[1] = world.position, world.speed
            for i in range(size + n):
                base[:], pushed[:] = now, shaft[k]
                if i < size:
                    base[i // joints, i % joints] += _PROBE
                else:
                    pushed[i - size] += _PROBE
                _place(world, base)
                _row(world, sensed, columns, pushed, stride, other)
                end[0], end[1] = world.position, world.speed
                for j in range(size):
                    slopes[row, j, i] = (
                        end[j // joints, j % joints] - after[j // joints, j % joints]
                    ) / _PROBE
                for j in range(feet):
                    touch[row, j, i] = (other[j] - felt[j]) / _PROBE


@compiled(nogil=True)
def travel(
    edges: np.ndarray,
    slopes: np.ndarray,
    touch: np.ndarray,
    extra: np.ndarray,
    starts: np.ndarray,
    out: np.ndarray,
    force: np.ndarray,
) -> None:
    """Fill changes of the state (N, 2 nv, C) and the force (N, 3 F, C) in the windows between `edges`.

    `extra` (N, n, C) on the drives, `starts` (N, 2 nv, C) at the windows' beginnings.
    """
    size, count, n = out.shape[1], out.shape[2], extra.shape[1]
    change, fresh = np.zeros((size + n, count)), np.zeros((size, count))
    for w in range(len(edges) - 1):
        fresh[:] = starts[edges[w]]
        for k in range(edges[w], edges[w + 1]):
            out[k] = fresh
            change[:size], change[size:] = fresh, extra[k]
            force[k] = touch[k - edges[0]] @ change
            fresh = slopes[k - edges[0]] @ change
