"""What the closed chain has and its serial tree has not, of a parallelogram (paper, Eqs. 14 to 19)."""

from __future__ import annotations

import numpy as np

from workbench.effects.structure import PARALLELOGRAM
from workbench.mechanism import ClosedChain, sample_joints
from workbench.models import Crank, Linkage, Model
from workbench.s3n.closed_forms import parallelogram_form
from workbench.serial_tree import SerialTree

_SAMPLES = 60
_SAME = 1e-9  # relative: the form of a parallelogram, to rounding


def parallelogram_linkage(chain: ClosedChain, model: Model) -> Linkage | None:
    """M11, M12 (factor of cos alpha), M22, g1 and g2 over the serial tree; None for another mechanism.

    Angles have to be measured from straight down, as everywhere: alpha is zero where the leg is stretched.

    Args:
        chain: the closed chain.
        model: with its serial tree and transmission.
    """
    same_size = model.transmission.shape == PARALLELOGRAM.shape
    if not (same_size and np.allclose(model.transmission, PARALLELOGRAM, atol=_SAME)):
        return None
    q = sample_joints(chain, _SAMPLES)
    real = [chain.serial_dynamics(row, np.zeros(2)) for row in q]
    tree, back = SerialTree(model), np.linalg.inv(model.transmission)
    masses = np.array([r.mass for r in real])
    missing = back.T @ (masses - tree.link_mass_matrix(q)) @ back
    weights = np.array([r.gravity for r in real])
    pull = (weights - tree.gravity(q)) @ back
    inertia, gravity, off, off_pull = parallelogram_form(missing, pull, q, model.transmission)
    if off > _SAME * np.abs(masses).max() or off_pull > _SAME * max(np.abs(weights).max(), 1e-12):
        return None
    m11, m12, m22, g1, g2 = map(float, (*inertia, *gravity))
    # the tree has thigh and shank whole, so that what it lacks of the knee's drive is crank and coupler
    return Linkage(m11, m12, m22, g1, g2, identified=True, crank=Crank(m12, m22, g2))


def is_all(chain: ClosedChain, model: Model) -> bool:
    """Return whether the serial tree has the mechanism's whole mass and weight, and the loops none.

    Args:
        chain: the closed chain.
        model: with its serial tree and transmission.
    """
    q = sample_joints(chain, _SAMPLES)
    real = [chain.serial_dynamics(row, np.zeros(len(row))) for row in q]
    tree = SerialTree(model)
    masses, weights = np.array([r.mass for r in real]), np.array([r.gravity for r in real])
    off = np.abs(tree.link_mass_matrix(q) - masses).max() / max(np.abs(masses).max(), 1e-12)
    pull = np.abs(tree.gravity(q) + weights).max(), np.abs(tree.gravity(q) - weights).max()
    return bool(off < _SAME and min(pull) < _SAME * max(np.abs(weights).max(), 1.0))
