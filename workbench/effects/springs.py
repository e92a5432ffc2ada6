"""Several springs behind drives together: their links swing against each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import scipy

from workbench.models import Model, Placement

from .flexible import frequencies, link_inertia, spring_lack, stiffest
from .lacking import Lack, refined, share_left
from .motion import Motion

_STARTS = 8  # frequencies to begin with
_HARDER = (1.0, 1.3, 2.0)  # times the stiffness that springs had before
_APART = 1e-6  # of links that move by themselves: what is left of the inertia of each where others follow
_SHARE = 0.1  # of critical damping, to begin with


class Springs:
    """Springs at some places of a rigid model, along motions of its motors.

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

    @property
    def apart(self) -> bool:
        """Return whether the links behind each spring can move separately."""
        own = [np.diag(inertia) for inertia in self._inertias]
        if any(np.any(i <= 0.0) for i in own):
            return False
        alike = (m / np.sqrt(np.outer(i, i)) for m, i in zip(self._inertias, own, strict=True))
        return all(np.linalg.eigvalsh(m)[0] > _APART for m in alike)

    def share(self, shapes: Sequence[Mapping[str, float]]) -> float:
        """Return the share of the squared residual torque that these springs do not explain."""
        values = np.array([[shape["stiffness"], shape["damping"]] for shape in shapes])
        return share_left([lacks[0] for lacks in self._lacks], self._left(values.ravel()))

    def guess(self, before: Sequence[Mapping[str, float]]) -> list[dict[str, float]]:
        """Return stiffness and damping of each with the smallest error, from many antiresonances of the
        last.

        Args:
            before: of all but the last, as they were found without it: too soft.
        """
        inertia = float(self._inertias[0][-1, -1])
        starts = [
            [x for shape in before for x in (harder * shape["stiffness"], max(shape["damping"], 1e-3))]
            + [inertia * w**2, 2.0 * _SHARE * inertia * w]
            for w in frequencies(self._motions, 4.0, 150.0, _STARTS)
            for harder in _HARDER
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

    inertia d'' + damping d' + stiffness d = torque, which goes straight from row to row, mode by mode.
    """
    n = len(stiffness)
    through = np.linalg.inv(inertia)
    change = np.block([[np.zeros((n, n)), np.eye(n)], [-through * stiffness, -through * damping]])
    entry = np.vstack([np.zeros((n, n)), through])
    kept, added, seen, direct, _ = scipy.signal.cont2discrete(
        (change, entry, change[n:], through), step, "foh"
    )
    rates, modes = np.linalg.eig(kept)
    driven = load @ np.linalg.solve(modes, added).T
    state = np.stack(
        [scipy.signal.lfilter([0.0, 1.0], [1.0, -rate], driven[:, k]) for k, rate in enumerate(rates)],
        axis=1,
    )
    return np.asarray((state @ (seen @ modes).T).real + load @ direct.T)
