"""Mass that effects add to the links of a closed chain, as to the serial tree that moves with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.effects import build, effect_named, kinds
from workbench.models import Model
from workbench.serial_tree import SerialTree


class AddedToLinks:
    """Mass that effects of a model add to its links, or remove.

    Attributes:
        mass: of all of it [kg].

    Args:
        model: with its effects; those at drives are no matter here.
    """

    def __init__(self, model: Model) -> None:
        own = tuple(e for e in model.effects if kinds.of_mass(effect_named(e.key.effect)))
        made = [build(replace(model, effects=e)).spec.compile() for e in (own, ())] if own else []
        self._trees = [SerialTree(model, m) for m in made]
        self.mass = float(made[0].body_mass.sum() - made[1].body_mass.sum()) if made else 0.0

    def at(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Inertia (N, n, n) [kg m^2] and potential energy (N,) [J] at serial positions (N, n)."""
        if not self._trees:
            return np.zeros((*q.shape, q.shape[1])), np.zeros(len(q))
        (mass, energy), (own_mass, own_energy) = (of_tree(tree, q) for tree in self._trees)
        return mass - own_mass, energy - own_energy


def of_tree(tree: SerialTree, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Inertia of the links (N, n, n) [kg m^2] and their potential energy (N,) [J]; other joints at zero."""
    n = q.shape[1]
    whole = np.concatenate([q, np.zeros((len(q), tree.size - n))], axis=1)
    return tree.link_mass_matrix(whole)[:, :n, :n], tree.potential_energy(whole)
