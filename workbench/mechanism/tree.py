"""The tree that is left when every loop is cut, in Drake: its dynamics, and how far its loops gape.

Coordinates are those of the file's joints, theta (N,); a joint with more than one (a universal joint) has
coordinates named after it with Drake's suffix, ``rod_qx`` and ``rod_qy``. Links only: no rotors, and
damping and springs that the file gives its joints are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable

from workbench.core import InputError, Mechanism, SimulationError
from workbench.core.coupling import BoundJoints

from .cut import Cut, cut_open, moving_part, no_foot
from .ends import Ends, ends_of

_ORIGIN: Any = np.zeros(3)


class Tree:
    """The cut mechanism at one posture and speed; `move` and `speed` set them, everything else reads them.

    Args:
        mechanism: file, loops and foot.
        payload: point mass [kg] at the foot.
        cut: in place of the file, what `limb` left of it.

    Raises:
        InputError: the file cannot be read, or has no frame of a name that `mechanism` gives.
    """

    def __init__(self, mechanism: Mechanism, payload: float = 0.0, cut: Cut | None = None) -> None:
        self.mechanism, self._cut = mechanism, cut or cut_open(mechanism, payload)
        self._plant, self._model, self._pairs = self._cut.plant, self._cut.model, self._cut.pairs
        self._context = self._plant.CreateDefaultContext()
        self._ends = ends_of(self._plant, self._context, self._pairs)
        self._world = self._plant.world_frame()
        self._inboards: dict[Any, Any] = {}
        self.names = _coordinate_names(self._plant)
        self._bound = BoundJoints.of(self._cut.couplings, lambda name: self.index(name, "couplings"))

    def limb(self, theta: np.ndarray, rows: Sequence[int], coordinates: Sequence[int]) -> Tree:
        """Return this tree with nothing left that moves but the joints of some coordinates.

        Args:
            theta: where all the others stay (N,) [rad or m].
            rows: of the gap that are left, three for each of their loops.
            coordinates: positions in theta. Of a joint with more than one coordinate all are left.
        """
        self.move(theta)
        loops = sorted({row // 3 for row in rows if row < 3 * len(self._pairs)})
        bound = [row - 3 * len(self._pairs) for row in rows if row >= 3 * len(self._pairs)]
        return Tree(self.mechanism, cut=moving_part(self._cut, self._context, coordinates, loops, bound))

    def index(self, coordinate: str, key: str) -> int:
        """Position of a coordinate in theta; `key` is where a model file names it.

        Raises:
            InputError: the file has none.
        """
        if coordinate in self.names:
            return self.names.index(coordinate)
        raise InputError(
            f"the file has no joint '{coordinate}' with one coordinate", file=self.mechanism.file,
            column=f"closed_chain.{key}", remedy=f"coordinates are {', '.join(self.names)}",
        )  # fmt: skip

    def unit(self, coordinate: str) -> str:
        """Unit of a coordinate, ``rad`` or ``m``."""
        named = self._plant.HasJointNamed(coordinate, self._model)  # those of a universal joint are not
        sliding = named and self._plant.GetJointByName(coordinate, self._model).type_name() == "prismatic"
        return "m" if sliding else "rad"

    def massless_links(self) -> list[str]:
        """Names of links without mass."""
        bodies = [self._plant.get_body(i) for i in self._plant.GetBodyIndices(self._model)]
        return [body.name() for body in bodies if body.default_mass() == 0.0]

    def move(self, theta: np.ndarray) -> None:
        """To the posture theta (N,) [rad or m]."""
        self._plant.SetPositions(self._context, _finite(theta))

    def speed(self, rates: np.ndarray) -> None:
        """To the speeds d theta / dt (N,) [rad/s or m/s]."""
        self._plant.SetVelocities(self._context, _finite(rates))

    def gap(self, rows: Sequence[int] | None = None) -> np.ndarray:
        """Of m loops from the second point to the first [m], then how far k couplings are off, (3 m + k,).

        With `rows` those alone, in their order: of a robot with many loops the others cost nothing then.
        """
        theta = self._plant.GetPositions(self._context)
        out = np.zeros(3 * len(self._pairs) + len(self._bound.pairs))
        for ends in self._needed(rows):
            out[ends.rows] = ends.gap(self._plant, self._context)
        out[3 * len(self._pairs) :] = self._bound.gap(theta)
        return out if rows is None else out[list(rows)]

    def open_loops(self) -> np.ndarray:
        """Return how far each loop gapes (m,) [m]."""
        return np.linalg.norm(self.gap()[: 3 * len(self._pairs)].reshape(-1, 3), axis=1)

    def gap_jacobian(self, rows: Sequence[int] | None = None) -> np.ndarray:
        """d gap / d theta (3 m + k, N) [m/rad or 1]; with `rows` those alone."""
        theta = self._plant.GetPositions(self._context)
        out = np.zeros((3 * len(self._pairs) + len(self._bound.pairs), len(self.names)))
        for ends in self._needed(rows):
            out[ends.rows] = ends.jacobian(self._plant, self._context)
        out[3 * len(self._pairs) :] = self._bound.jacobian(theta)
        return out if rows is None else out[list(rows)]

    def gap_bias(self, rows: Sequence[int] | None = None) -> np.ndarray:
        """Second derivative of the gap at zero tree acceleration (3 m + k,) [m/s^2]; or `rows` alone."""
        theta, rates = self._plant.GetPositions(self._context), self._plant.GetVelocities(self._context)
        out = np.zeros(3 * len(self._pairs) + len(self._bound.pairs))
        for ends in self._needed(rows):
            out[ends.rows] = ends.bias(self._plant, self._context)
        out[3 * len(self._pairs) :] = self._bound.bias(theta, rates)
        return out if rows is None else out[list(rows)]

    def mass(self) -> np.ndarray:
        """Mass matrix (N, N)."""
        return self._plant.CalcMassMatrix(self._context)

    def bias(self) -> np.ndarray:
        """Coriolis and centrifugal forces (N,), on the side of the accelerations."""
        return self._plant.CalcBiasTerm(self._context)

    def gravity(self) -> np.ndarray:
        """Forces of gravity (N,)."""
        return self._plant.CalcGravityGeneralizedForces(self._context)

    def energy(self) -> float:
        """Kinetic plus potential energy [J]."""
        kinetic = self._plant.CalcKineticEnergy(self._context)
        return float(kinetic + self._plant.CalcPotentialEnergy(self._context))

    def foot(self) -> np.ndarray:
        """Position of the foot in the world (3,) [m]."""
        return self._needed_foot().CalcPoseInWorld(self._context).translation()

    def foot_jacobian(self) -> np.ndarray:
        """d foot / d theta (3, N)."""
        return self._point_jacobian(self._needed_foot())

    def way(self) -> list[int]:
        """Coordinates between the world and the serial joints and foot, those included."""
        ends = [self._plant.GetJointByName(n, self._model).child_body() for n in self.mechanism.joints]
        ends += [self._cut.foot.body()] if self._cut.foot is not None else []
        return sorted(set().union(*map(self._inboard, ends)))

    def movers(self) -> list[list[int]]:
        """Of each row of the gap (3 m + k) the coordinates that open or close it.

        Those on the ways to both ends of a loop turn it as a whole.
        """
        loops = [self._inboard(a.body()) ^ self._inboard(b.body()) for a, b in self._pairs]
        coupled = [{own} | ({other} if other is not None else set()) for _, own, other in self._bound.pairs]
        return [sorted(each) for each in (*(loop for loop in loops for _ in range(3)), *coupled)]

    def _inboard(self, body: Any) -> set[int]:
        """Coordinates between the world and a body."""
        if not self._inboards:
            for index in self._plant.GetJointIndices():
                joint = self._plant.get_joint(index)
                self._inboards[joint.child_body().index()] = joint
        out: set[int] = set()
        while (joint := self._inboards.get(body.index())) is not None:
            out |= set(range(joint.position_start(), joint.position_start() + joint.num_positions()))
            body = joint.parent_body()
        return out

    def _needed(self, rows: Sequence[int] | None) -> Iterable[Ends]:
        """Ends of the loops that rows of the gap are of."""
        if rows is None:
            return self._ends
        loops = {row // 3 for row in rows}
        return [ends for ends in self._ends if not loops.isdisjoint(ends.loops)]

    def _needed_foot(self) -> Any:
        return self._cut.foot or no_foot(self.mechanism)

    def _point_jacobian(self, frame: Any) -> np.ndarray:
        return self._plant.CalcJacobianTranslationalVelocity(
            self._context, JacobianWrtVariable.kV, frame, _ORIGIN, self._world, self._world
        )


def _finite(values: np.ndarray) -> np.ndarray:
    """Drake ends the whole process where a number is not finite.

    Raises:
        SimulationError: one is not.
    """
    if np.isfinite(values).all():
        return values
    raise SimulationError("positions or speeds are not finite numbers")


def _coordinate_names(plant: Any) -> tuple[str, ...]:
    names = [""] * plant.num_positions()
    for index in plant.GetJointIndices():
        joint, count = plant.get_joint(index), plant.get_joint(index).num_positions()
        for i in range(count):
            suffix = f"_{joint.position_suffix(i)}" if count > 1 else ""
            names[joint.position_start() + i] = joint.name() + suffix
    return tuple(names)
