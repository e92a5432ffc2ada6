"""Joints to hold where a limb is taken out of a whole robot: what neither drives nor loops move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from workbench.core import Coupling, InputError, Mechanism

from .assembly import generic_jacobian, rank
from .closing import closed_near_start
from .tree import Tree

_STILL = 1e-9  # of a unit of motion


def held_rest(mechanism: Mechanism, first: Sequence[str] = ()) -> tuple[Coupling, ...]:
    """Return the joints to hold so that the loops leave as many freedoms as there are drives.

    Each is held where it is at the start. Serial joints and drives are never held; of the others those in
    `first` are taken before the rest, and of the rest those nearest to the base.

    Args:
        mechanism: what is known so far.
        first: joints that something else would hold, as motors that are not asked for and stiff springs.

    Raises:
        InputError: a name is not in the file, or the loops do not close near the start posture.
    """
    tree = Tree(mechanism)
    drives = [tree.index(name, "drives") for name in mechanism.drives]
    serial = {tree.index(name, "joints") for name in mechanism.joints}
    early = [tree.names.index(name) for name in first if name in tree.names]
    theta = closed_near_start(tree, [*drives, *early])
    count = len(theta)
    passive = [i for i in range(count) if i not in drives]
    bonds, driven = generic_jacobian(tree, theta, passive), np.eye(count)[drives]
    held: list[int] = []
    for i in (*early, *(i for i in passive if i not in early)):
        known = rank(np.vstack([bonds, driven]))
        if known == count:
            break
        more = np.vstack([bonds, np.eye(count)[[i]]])
        if i not in serial and i not in drives and rank(np.vstack([more, driven])) > known:
            bonds, held = more, [*held, i]
    if rank(np.vstack([bonds, driven])) < count:
        raise InputError(
            f"with all other joints held {', '.join(mechanism.joints)} still move without a drive",
            file=mechanism.file, column="closed_chain.loops",
            remedy="name the drive, or the loop that is missing",
        )  # fmt: skip
    # on the way to the foot what only held joints move stays as they do: the knee whose motor is held
    free = np.linalg.svd(bonds)[2][rank(bonds) :]
    still = np.abs(free).max(axis=0, initial=0.0) < _STILL
    held += [i for i in tree.way() if still[i] and i not in held and i not in serial]
    return tuple(Coupling(tree.names[i], None, (float(theta[i]) + 0.0,)) for i in held)
