"""Random numbers for the worlds, with numpy or torch; their state can be saved and restored."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .situation import Array


class Draws:
    """Uniform random numbers from one seed.

    Args:
        xp: `numpy` or `torch`.
        seed: of the generator.
        like: an array of the worlds, whose device and precision are taken.
    """

    def __init__(self, xp: Any, seed: int, like: Array) -> None:
        self.xp, self._like = xp, like
        self._known: dict[tuple[float, ...], Array] = {}
        if xp is np:
            self._generator = np.random.default_rng(seed)
        else:
            self._generator = xp.Generator(device=like.device)
            self._generator.manual_seed(seed)

    def constant(self, values: Sequence[float], shape: tuple[int, ...]) -> Array:
        """Return the same numbers in every row."""
        key = tuple(values)
        if key not in self._known:  # a copy to a GPU makes everything wait
            like = self._like
            self._known[key] = (
                np.asarray(key, like.dtype)
                if self.xp is np
                else self.xp.as_tensor(key, dtype=like.dtype, device=like.device)
            )
        return self.xp.broadcast_to(self._known[key], shape)

    def uniform(self, low: Sequence[float], high: Sequence[float], shape: tuple[int, ...]) -> Array:
        """Return numbers between `low` and `high`, one pair per column, or one for all."""
        if self.xp is np:
            unit = self._generator.random(shape)
        else:
            like = self._like
            unit = self.xp.rand(shape, generator=self._generator, dtype=like.dtype, device=like.device)
        floor, ceiling = self.constant(low, (len(low),)), self.constant(high, (len(high),))
        return floor + (ceiling - floor) * unit

    def state(self) -> dict[str, Any]:
        """Return the argument of `restore`: numbers, text and tensors only."""
        if self.xp is not np:
            return {"torch": self._generator.get_state()}
        inner = self._generator.bit_generator.state
        return {"numpy": [str(inner["state"]["state"]), str(inner["state"]["inc"])]}

    def restore(self, state: dict[str, Any]) -> None:
        """Continue from a `state`."""
        if self.xp is not np:
            self._generator.set_state(state["torch"].cpu())
            return
        inner: dict[str, Any] = dict(self._generator.bit_generator.state)
        inner["state"] = {"state": int(state["numpy"][0]), "inc": int(state["numpy"][1])}
        inner["has_uint32"], inner["uinteger"] = 0, 0
        self._generator.bit_generator.state = inner
