"""Links of a mechanism at many postures, kept from one question to the next.

Their dynamics is the same in every model of a mechanism: drives and effects come on top. A command asks for
them several times, at the same postures (the nodes of a series), and solving the loops there takes long.
"""

from __future__ import annotations

from collections import OrderedDict
from hashlib import sha256
from typing import Any

import numpy as np

from workbench.models import Model, load_mjcf

from .loop import mechanism_of
from .posture_chain import PostureChain, PostureDynamics

_MOST = 64  # questions; one about a thousand postures of three drives is about 300 kB
_known: OrderedDict[Any, PostureDynamics] = OrderedDict()


class KnownLinks:
    """A closed chain's links without rotors, at rest.

    Args:
        model: names the closed chain.

    Raises:
        InputError: it names none, or its loops do not close at the start posture.
    """

    def __init__(self, model: Model) -> None:
        self._model, self._key = model, _key(model)
        self._chain: PostureChain | None = None

    def dynamics(self, q: np.ndarray) -> PostureDynamics:
        """Return everything at positions `q` (N, n), as `PostureChain.dynamics` does.

        Raises:
            SimulationError: a posture where the loops cannot be closed, or that is singular.
        """
        key = (self._key, q.tobytes())
        if key not in _known:
            self._chain = self._chain or PostureChain(self._model, links_only=True)
            _known[key] = self._chain.dynamics(q)
        _known.move_to_end(key)
        while len(_known) > _MOST:
            _known.popitem(last=False)
        return _known[key]


def _key(model: Model) -> Any:
    """All that the links depend on: the mechanism and its file, gravity, and where assembly begins."""
    mechanism = mechanism_of(model)
    content = sha256(mechanism.file.read_bytes()).digest() if mechanism.file.is_file() else b""
    gravity = tuple(load_mjcf(model.serial).option.gravity)
    return mechanism, content, gravity, model.posture_dependent, model.transmission.tobytes()
