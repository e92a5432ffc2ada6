"""Joints of a mechanism's tree that follow others or are held: equations beside those of its loops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import Coupling, InputError, Mechanism


def couple(
    spec: mujoco.MjSpec, coupling: Coupling, solref: Sequence[float], solimp: Sequence[float], file: Path
) -> None:
    """A joint that follows another, as MuJoCo's own constraint.

    Raises:
        InputError: it follows by more than MuJoCo's polynomial of the fourth degree.
    """
    if len(coupling.polynomial) > 5:
        raise InputError(
            f"joint '{coupling.joint}' follows by {len(coupling.polynomial)} coefficients", file=file,
            column="closed_chain.couplings", remedy="give five at most",
        )  # fmt: skip
    bound = spec.add_equality(name=f"coupling:{coupling.joint}")
    bound.type, bound.objtype = mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtObj.mjOBJ_JOINT
    bound.name1, bound.name2 = coupling.joint, coupling.follows or ""
    bound.data[:5] = [*coupling.polynomial, *[0.0] * (5 - len(coupling.polynomial))]
    bound.solref, bound.solimp = solref, solimp


@dataclass(frozen=True)
class BoundJoints:
    """Couplings as equations in the coordinates of a tree, zero where they hold."""

    pairs: tuple[tuple[Coupling, int, int | None], ...]

    @staticmethod
    def of(m: mujoco.MjModel, mechanism: Mechanism) -> BoundJoints:
        """Those of a mechanism in its tree as MuJoCo has it, cut open and without a free base.

        Raises:
            InputError: a joint is not in the tree.
        """

        def place(name: str) -> int:
            number = mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_JOINT, name)
            if number >= 0:
                return int(m.jnt_dofadr[number])
            raise InputError(
                f"no joint is called '{name}'", file=mechanism.file, column="closed_chain.couplings",
                remedy="correct it",
            )  # fmt: skip

        return BoundJoints(
            tuple(
                (c, place(c.joint), place(c.follows) if c.follows else None)
                for c in mechanism.all_couplings()
            )
        )

    def gap(self, theta: np.ndarray) -> np.ndarray:
        """How far each joint is from where it has to be (k,) [rad or m]."""
        return np.array([theta[a] - c.at(0.0 if b is None else theta[b])[0] for c, a, b in self.pairs])

    def jacobian(self, theta: np.ndarray) -> np.ndarray:
        """d gap / d theta (k, nv)."""
        rows = np.zeros((len(self.pairs), len(theta)))
        for row, (c, a, b) in zip(rows, self.pairs, strict=True):
            row[a] = 1.0
            if b is not None:
                row[b] -= c.at(theta[b])[1]
        return rows

    def bias(self, theta: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Second derivative of the gap at zero acceleration (k,)."""
        bends = (0.0 if b is None else -c.at(theta[b])[2] * rates[b] ** 2 for c, _, b in self.pairs)
        return np.fromiter(bends, float, len(self.pairs))
