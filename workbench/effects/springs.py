"""Several springs behind drives at once: their links swing against each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

import numpy as np
import scipy
from scipy.linalg import expm

from workbench.models import Model, Placement

from .flexible import frequencies, link_inertia, spring_lack, stiffest
from .lacking import Lack, refined, share_left
from .motion import Motion

_STARTS = 5  # frequencies a spring to begin with
_SHARE = 0.1  # of critical damping, to begin with


class Springs:
    """Springs at some places of a rigid model, along motions that its motors made.

    Each by itself obeys `flexible.spring_wind`; together the inertia on them is a matrix, so that one spring
    fitted alone takes the softness of all.
    """

    def __init__(self, motions: Sequence[Motion], model: Model, places: Sequence[Placement]) -> None:
        """Work out what the motions ask of each spring.

        Args:
            motions: measured.
            model: without these springs.
            places: where they are.
        """
        self._places, self._model, self._motions = places, model, motions
        self._lacks = [[spring_lack(m, model, p)[0] for p in places] for m in motions]
        self._inertias = [_inertia(m, model, places) for m in motions]

    def share(self, shapes: Sequence[Mapping[str, float]]) -> float:
        """What these springs leave of the squared torque that is missing without any."""
        values = np.array([[shape["stiffness"], shape["damping"]] for shape in shapes])
        return share_left([lacks[0] for lacks in self._lacks], self._left(values.ravel()))

    def guess(self) -> list[dict[str, float]]:
        """Stiffness and damping of each that leave least, from many antiresonances."""
        inertia = np.diag(self._inertias[0])
        rates = frequencies(self._motions, 4.0, 150.0, _STARTS)
        starts = [
            [x for i, w in zip(inertia, chosen, strict=True) for x in (i * w**2, 2.0 * _SHARE * i * w)]
            for chosen in product(rates, repeat=len(inertia))
        ]
        found = refined(self._left, starts).reshape(-1, 2)
        tops = [stiffest(self._model, place) for place in self._places]
        return [
            {"stiffness": float(min(k, top)), "damping": float(min(d, top))}
            for (k, d), top in zip(found, tops, strict=True)
        ]

    def _left(self, values: np.ndarray) -> np.ndarray:
        """What is still missing, of all motions, with stiffness and damping of each spring in turn."""
        stiffness, damping = values.reshape(-1, 2).T
        parts = []
        for lacks, inertia in zip(self._lacks, self._inertias, strict=True):
            load = np.stack([lack.load for lack in lacks], axis=1)
            answer = _winds(load, lacks[0].step, inertia, stiffness, damping)
            parts.append(_missing(lacks, answer))
        return np.concatenate(parts)


def _missing(lacks: Sequence[Lack], answer: np.ndarray) -> np.ndarray:
    rows = lacks[0].rows
    return (
        lacks[0].missing - sum(lack.column * answer[rows, k, None] for k, lack in enumerate(lacks))
    ).ravel()


def _inertia(motion: Motion, model: Model, places: Sequence[Placement]) -> np.ndarray:
    """Mean inertia (S, S) on the springs."""
    columns = [link_inertia(motion, model, place)[1] for place in places]
    index = [place.index for place in places]
    mean = np.stack([column.mean(axis=0)[index] for column in columns], axis=1)
    return 0.5 * (mean + mean.T)


def _winds(
    load: np.ndarray, step: float, inertia: np.ndarray, stiffness: np.ndarray, damping: np.ndarray
) -> np.ndarray:
    """Second derivatives (N, S) of the springs' winds under the torques that pass rigidly (N, S).

    inertia d'' + damping d' + stiffness d = torque, held over each step, mode by mode.
    """
    n = len(stiffness)
    through = np.linalg.inv(inertia)
    change = np.block([[np.zeros((n, n)), np.eye(n)], [-through * stiffness, -through * damping]])
    entry = np.vstack([np.zeros((n, n)), through])
    whole = expm(step * np.block([[change, entry], [np.zeros((n, 3 * n))]]))
    rates, modes = np.linalg.eig(whole[: 2 * n, : 2 * n])
    driven = load @ np.linalg.solve(modes, whole[: 2 * n, 2 * n :]).T
    state = np.stack(
        [scipy.signal.lfilter([0.0, 1.0], [1.0, -rate], driven[:, k]) for k, rate in enumerate(rates)],
        axis=1,
    )
    return np.asarray((state @ (change[n:] @ modes).T).real + load @ through.T)
