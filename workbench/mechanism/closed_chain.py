"""A mechanism with loops in Drake, projected onto the coordinates that its motors drive, or on serial ones.

The loops are cut, which leaves a tree with coordinates theta; closing them makes theta a function of the
drives' positions q, with theta_dot = L q_dot and theta_ddot = L q_ddot + gamma (see `closure`). By virtual
work

    M = L^T M_tree L,   bias = L^T (C_tree theta_dot + M_tree gamma),   gravity = L^T g_tree.

The same projection with the serial joints q_s as independent coordinates gives J^T M J and its like, where
q_p = q_p(q_s) and J = d q_p / d q_s (paper, Eqs. 1, 4 and 18; there J is constant, here it need not be).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workbench.core import InputError, Mechanism, SimulationError
from workbench.core.closure import DEAD, Closure
from workbench.core.moving import moving_with

from .assembly import assemble, check_names
from .reduced import Reduced, ratio
from .tree import Tree

_SAME = 1e-6  # rad or m
_SEED, _TRIES = 5, 60  # of guesses at other ways to close the loops


class ClosedChain:
    """A mechanism with n drives and any number of loops, links only (no rotors, no damping).

    Args:
        mechanism: what is known of it beside its file; a path alone is taken as a leg like the reference leg.
        payload: point mass [kg] at the foot.

    Raises:
        InputError: the file cannot be read, a name in `mechanism` is not in it, its loops do not close near
            the start posture, they leave other freedoms than the drives, or its mass matrix is singular.
    """

    def __init__(self, mechanism: Mechanism | Path, payload: float = 0.0) -> None:
        if isinstance(mechanism, Path):
            mechanism = Mechanism(mechanism)
        self.mechanism = mechanism
        check_names(mechanism)
        whole = Tree(mechanism, payload)
        drives = [whole.index(name, "drives") for name in mechanism.drives]
        joints = [whole.index(name, "joints") for name in mechanism.joints]
        self._names, self._posture = whole.names, assemble(whole, drives)
        # what moves with the drives is all that is worked with: of a whole robot one limb
        self._tree = whole.limb(self._posture, *moving_with(whole.movers(), [*drives, *joints]))
        self._places = [self._names.index(name) for name in self._tree.names]
        start = self._posture[self._places]
        drives = [self._tree.index(name, "drives") for name in mechanism.drives]
        self._joints = [self._tree.index(name, "joints") for name in mechanism.joints]
        self._moving = moving_with(self._tree.movers(), [*drives, *self._joints])
        self._driven = Closure(self._tree, drives, start, moving=self._moving)
        self._serial = Closure(self._tree, self._joints, start, moving=self._moving)
        self._start = self._inside_limits(start)
        self._check_mass()

    @property
    def size(self) -> int:
        """Number of drives n."""
        return len(self.mechanism.drives)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the tree's coordinates, length N, in the order of theta."""
        return self._names

    @property
    def start(self) -> tuple[np.ndarray, np.ndarray]:
        """q_p (n,) and q_s (n,) [rad or m] of the posture it was assembled in."""
        return self._start[self._driven.independent], self._start[self._joints]

    @property
    def assembled(self) -> np.ndarray:
        """The closed posture theta (N,) [rad or m] nearest to the start, whatever the limits are."""
        return self._posture.copy()

    def tree_position(self, q: np.ndarray) -> np.ndarray:
        """Tree coordinates theta (N,) [rad or m] that close the loops at drive positions `q` (n,).

        Followed from the start posture, so that the branch is the start posture's.

        Raises:
            SimulationError: the loops cannot be closed there.
        """
        theta = self._posture.copy()
        theta[self._places] = self._driven.at(q).theta
        return theta

    def projection(self, q: np.ndarray) -> np.ndarray:
        """L (N, n), d theta / d q at drive positions `q` (n,).

        Raises:
            SimulationError: the loops cannot be closed there, or are at a dead point.
        """
        slope = np.zeros((len(self._names), self.size))
        slope[self._places] = self._driven.regular(q)[1]
        return slope

    def reduced_dynamics(self, q: np.ndarray, v: np.ndarray) -> Reduced:
        """Return the equation of motion at drives `q` (n,) [rad or m] and speeds `v` (n,) [rad/s or m/s].

        Raises:
            SimulationError: the loops cannot be closed, or are at a dead point (links of a loop in line).
        """
        return self._project(self._driven, q, v)

    def energy(self, q: np.ndarray, v: np.ndarray) -> float:
        """Kinetic plus potential energy [J] of what moves, at drive positions `q` and speeds `v` (n,)."""
        self._tree.speed(self._driven.regular(q)[1] @ v)
        return self._tree.energy()

    @property
    def units(self) -> tuple[str, ...]:
        """Unit of each drive's position, ``rad`` or ``m``."""
        return tuple(self._tree.unit(name) for name in self.mechanism.drives)

    def serial_slope(self, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Serial positions q_s (n,) and d q_s / d q_p (n, n) at drive positions `q` (n,).

        Raises:
            SimulationError: the loops cannot be closed there, or are at a dead point.
        """
        theta, slope, _ = self._driven.regular(q)
        return theta[self._joints], slope[self._joints]

    def drive_position(self, joints: np.ndarray) -> np.ndarray:
        """Drive positions q_p (n,) at serial joint positions `joints` (n,) [rad or m].

        Raises:
            SimulationError: the loops cannot be closed there.
        """
        return self._serial.at(joints).theta[self._driven.independent]

    def jacobian(self, joints: np.ndarray) -> np.ndarray:
        """J (n, n), d q_p / d q_s at serial joint positions `joints` (n,) (paper, Eq. 1).

        Raises:
            SimulationError: the loops cannot be closed there, or a dead point: the joints do not determine
                the drives, or the drives not the posture.
        """
        jacobian = self._serial.regular(joints)[1][self._driven.independent]
        if ratio(jacobian) < DEAD:
            raise SimulationError(f"the drives are at a dead point at {self._serial.say(joints)}")
        return jacobian

    def jacobian_bias(self, joints: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """J' q_s' (n,) [rad/s^2 or m/s^2]: what the drives accelerate by when the joints move evenly."""
        _, projection, inverse = self._serial.regular(joints)
        self._tree.speed(projection @ speeds)
        return self._serial.gamma(inverse)[self._driven.independent]

    def serial_dynamics(self, joints: np.ndarray, speeds: np.ndarray) -> Reduced:
        """Return the equation of motion in serial coordinates, torque J^T tau_p: position and speed (n,).

        Raises:
            SimulationError: the loops cannot be closed there, or are at a dead point.
        """
        return self._project(self._serial, joints, speeds)

    def foot_position(self, joints: np.ndarray) -> np.ndarray:
        """Foot in the world (3,) [m] at serial joint positions `joints` (n,)."""
        self._serial.at(joints)
        return self._tree.foot()

    def foot_jacobian(self, joints: np.ndarray) -> np.ndarray:
        """d foot / d q_s (3, n) [m/rad or 1] at serial joint positions `joints` (n,)."""
        projection = self._serial.regular(joints)[1]
        return self._tree.foot_jacobian() @ projection

    def assemblies(self, joints: np.ndarray) -> list[np.ndarray]:
        """Positions of the drives (n,) in each way to close the loops at serial positions `joints` (n,).

        The first is that of this mechanism; there may be others, of the same links put together otherwise,
        here without whole turns.

        Raises:
            SimulationError: the loops cannot be closed there.
        """
        own, drives = self._serial.at(joints).theta, self._driven.independent
        generator, found = np.random.default_rng(_SEED), [own]
        for _ in range(_TRIES):
            guess = own.copy()
            guess[self._serial.dependent] += generator.uniform(-np.pi, np.pi, len(self._serial.dependent))
            theta = self._serial.solve(guess)
            if theta is not None and all(_apart(theta[drives], each[drives]) for each in found):
                found.append((theta + np.pi) % (2 * np.pi) - np.pi)
        return [theta[drives] for theta in found]

    def _inside_limits(self, start: np.ndarray) -> np.ndarray:
        """The start posture, or the middle of the limits where it lies outside and the middle is reached."""
        limits, joints = np.array(self.mechanism.limits).reshape(-1, 2), start[self._joints]
        if not len(limits) or np.all((joints >= limits[:, 0]) & (joints <= limits[:, 1])):
            return start
        drives = self._driven.independent
        try:
            middle = self._serial.at(limits.mean(axis=1)).theta
        except SimulationError:
            return start
        try:
            reached = self._driven.at(middle[drives]).theta
        except SimulationError:
            reached = start
        if np.abs(reached - middle).max() > _SAME:
            # a dead point of the drives lies between: they begin on the limits' side of it
            self._driven, reached = Closure(self._tree, drives, middle, moving=self._moving), middle
        return reached

    def _project(self, closure: Closure, q: np.ndarray, v: np.ndarray) -> Reduced:
        _, projection, inverse = closure.regular(q)
        self._tree.speed(projection @ v)
        mass = self._tree.mass()
        bias = self._tree.bias() + mass @ closure.gamma(inverse)
        gravity = self._tree.gravity()
        return Reduced(projection.T @ mass @ projection, projection.T @ bias, projection.T @ gravity)

    def _check_mass(self) -> None:
        mass = self.reduced_dynamics(self.start[0], np.zeros(self.size)).mass
        if not np.isfinite(mass).all():
            raise InputError(
                "the mass matrix is not finite", file=self.mechanism.file, column="inertial",
                remedy="give masses, inertias and lengths in SI",
            )  # fmt: skip
        if ratio(mass) > 1e-12:
            return
        links = ", ".join(self._tree.massless_links()) or "none"
        raise InputError(
            f"the mass matrix is singular; links without mass: {links}", file=self.mechanism.file,
            column="inertial", remedy="give every link that a drive moves a mass and an inertia",
        )  # fmt: skip


def _apart(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether positions differ by more than whole turns."""
    return bool(np.abs(np.exp(1j * one) - np.exp(1j * other)).max() > 1e-6)
