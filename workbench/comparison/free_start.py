"""Where springs begin that no sensor shows: along a measured motion, what says it is the torque that is left.

A machine that is logged in the middle of a motion has its springs wound up at the first row, and they unwind
as they do freely, whatever happens then. How much of that there is follows by least squares, so that it is no
error of a model: two numbers a spring, of which damping leaves nothing after the first rows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from workbench.effects import Motion, giving_way
from workbench.models import Model

LEAST_GAIN = 1e-3  # a motor that a wrong guess has burnt gives no torque, whatever is asked of it
_NOTHING = 1e-9  # of the largest column: what a fit does not tell from rounding


@dataclass(frozen=True)
class FreeStart:
    """Torques that unknown initial states of springs may add.

    Attributes:
        columns: torque for each beginning of one, (N, n, S).
        solve: beginnings of a torque, flattened, (S, N n).
    """

    columns: np.ndarray
    solve: np.ndarray

    @staticmethod
    def of(
        model: Model,
        motion: Motion | None,
        passed: Callable[[np.ndarray], np.ndarray],
        counts: np.ndarray,
        size: np.ndarray,
    ) -> FreeStart:
        """Return the least-squares fit over the rows and axes that count.

        Args:
            model: with its springs.
            motion: along which they are carried; None where there are none.
            passed: torques of the drives (N, n, S) as they are compared.
            counts: rows and axes (N, n).
            size: of each axis's torque (n,): errors count in parts of it.
        """
        none = np.zeros((*counts.shape, 0))
        if motion is None:
            return FreeStart(none, np.zeros((0, counts.size)))
        found = [
            effect.free_responses(motion, model, place, shape) for effect, place, shape in giving_way(model)
        ]
        freely = np.concatenate([none, *found], axis=2)
        if not freely.shape[2]:  # a gap knows where it begins, and has no column
            return FreeStart(none, np.zeros((0, counts.size)))
        columns = passed(freely / np.maximum(motion.gain, LEAST_GAIN)[:, :, None])
        weight = counts / np.maximum(size, 1e-300)
        weighted = (columns * weight[:, :, None]).reshape(-1, columns.shape[2])
        scale = np.maximum(np.linalg.norm(weighted, axis=0), 1e-300)
        solve = np.linalg.pinv(weighted / scale, rcond=_NOTHING) / scale[:, None] * weight.ravel()
        return FreeStart(columns, solve)

    def without(self, torque: np.ndarray) -> np.ndarray:
        """Return a torque (N, n), or several (N, n, C), minus the part that the initial states explain."""
        if not len(self.solve):
            return torque
        begun = self.solve @ torque.reshape(self.solve.shape[1], -1)
        return torque - (self.columns @ begun).reshape(torque.shape)
