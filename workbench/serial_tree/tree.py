"""The serial tree's dynamics by Pinocchio, over arrays of postures."""

from __future__ import annotations

from functools import cached_property

import mujoco
import numpy as np
import pinocchio as pin  # pyright: ignore[reportMissingImports]  (found by way of a .pth file)

from workbench.core import InputError
from workbench.models import Model, base_spec

from .build import beside_the_links, build_tree


class SerialTree:
    """A serial tree with its drives: ``M(q) a + C(q, v) v + D v = gravity(q) + torque`` of the joints.

    Positions, velocities and accelerations are (N, k) over `joints`: the model's serial joints first, then
    those of the MJCF that no axis drives. Springs, dry friction and limits are not part of it.

    Attributes:
        rotor_inertia: over the joints, (k, k) [kg m^2]: diagonal, or J^T diag(J_i) J (paper, Eq. 9).
        damping: viscous, over the joints, (k, k) [N m s/rad] (paper, Eq. 10).

    Args:
        model: names the MJCF and its joints.
        compiled: the MuJoCo model to rebuild, with whatever effects are installed in it; left out, the
            serial tree with its actuators the Kin-Only way, where no effect is installed.
    """

    def __init__(self, model: Model, compiled: mujoco.MjModel | None = None) -> None:
        m = base_spec(model).compile() if compiled is None else compiled
        self._tree = build_tree(m)
        own = self._tree.joints
        self.joints = (*model.joints, *(name for name in own if name not in model.joints))
        # a row over `joints` becomes one in Pinocchio's order by [:, self._order]
        self._order = [self.joints.index(name) for name in own]
        self._back = [own.index(name) for name in self.joints]
        self.rotor_inertia, self.damping = beside_the_links(m, self.joints)
        self._data, self._free = self._tree.model.createData(), self._tree.weightless.createData()

    @property
    def size(self) -> int:
        """Number of joints k."""
        return len(self.joints)

    def link_mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """Mass matrix of the links alone, (N, k, k) [kg m^2]."""
        out = np.empty((len(q), self.size, self.size))
        for i, position in enumerate(self._positions(q)):
            upper = np.triu(pin.crba(self._tree.weightless, self._free, position))
            full = upper + np.triu(upper, 1).T
            out[i] = full[np.ix_(self._back, self._back)]
        return out

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        """Mass matrix of links and rotors, (N, k, k) [kg m^2]."""
        return self.link_mass_matrix(q) + self.rotor_inertia

    def coriolis(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Coriolis and centrifugal torque C(q, v) v, (N, k) [N m]; joints need it to keep their speed."""
        return self._newton_euler(q, v, np.zeros_like(np.asarray(v, float)))

    def gravity(self, q: np.ndarray) -> np.ndarray:
        """Torque that gravity exerts on the joints, (N, k) [N m], gravity compensation subtracted."""
        weights, still = self._weights.ravel(), np.zeros(self.size)
        return -np.stack([self._links(p, still, still) @ weights for p in self._positions(q)])[:, self._back]

    def inverse_dynamics(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Torque on the joints for a motion, (N, k) [N m]: ``M a + C v + D v - gravity``."""
        rotors = np.asarray(a, float) @ self.rotor_inertia + np.asarray(v, float) @ self.damping
        return self._newton_euler(q, v, a) + rotors - self.gravity(q)

    def potential_energy(self, q: np.ndarray) -> np.ndarray:
        """Of the weights, gravity compensation subtracted, (N,) [J]; zero at the world's origin."""
        g = self._tree.model.gravity.linear
        out = np.empty(len(q))
        for i, position in enumerate(self._positions(q)):
            pin.forwardKinematics(self._tree.model, self._data, position)
            places = list(self._data.oMi)[1:]
            out[i] = -sum(
                g @ (w[0] * at.translation + at.rotation @ w[1:4])
                for at, w in zip(places, self._weights, strict=True)
            )
        return out

    def site_position(self, site: str, q: np.ndarray) -> np.ndarray:
        """World position of an MJCF site, (N, 3) [m].

        Raises:
            InputError: the MJCF has no such site.
        """
        frame = self._frame(site)
        out = np.empty((len(q), 3))
        for i, position in enumerate(self._positions(q)):
            pin.framesForwardKinematics(self._tree.model, self._data, position)
            out[i] = self._data.oMf[frame].translation
        return out

    def site_jacobian(self, site: str, q: np.ndarray) -> np.ndarray:
        """Jacobian of a site's world position, (N, 3, k) [m/rad].

        Raises:
            InputError: the MJCF has no such site.
        """
        frame, along = self._frame(site), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        out = np.empty((len(q), 3, self.size))
        for i, position in enumerate(self._positions(q)):
            jacobian = pin.computeFrameJacobian(self._tree.model, self._data, position, frame, along)
            # of a single joint Pinocchio gives a plain column
            out[i] = jacobian.reshape(6, -1)[:3][:, self._back]
        return out

    @cached_property
    def _weights(self) -> np.ndarray:
        """Parameters that gravity acts on, (k, 10): mass and first moment of each joint's link."""
        out = np.array([inertia.toDynamicParameters() for inertia in list(self._tree.model.inertias)[1:]])
        out[:, :4] -= self._tree.compensated
        return out

    def _links(self, position: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Pinocchio's regressor, (k, 10 k), its order; of a single joint Pinocchio gives a plain row."""
        y = pin.computeJointTorqueRegressor(self._tree.model, self._data, position, v, a)
        return y.reshape(self.size, -1).copy()

    def _newton_euler(self, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Torque of the weightless links for a motion, (N, k)."""
        v, a = np.asarray(v, float)[:, self._order], np.asarray(a, float)[:, self._order]
        rows = zip(self._positions(q), v, a, strict=True)
        torque = [pin.rnea(self._tree.weightless, self._free, *row).copy() for row in rows]
        return np.stack(torque)[:, self._back]

    def _positions(self, q: np.ndarray) -> np.ndarray:
        """Pinocchio's positions from (N, k) over `joints`."""
        q = np.asarray(q, float)
        if q.ndim != 2 or q.shape[1] != self.size:
            raise InputError(f"positions of shape {q.shape}", remedy=f"give (N, {self.size})")
        return q[:, self._order] - self._tree.reference

    def _frame(self, site: str) -> int:
        name = f"site:{site}"
        if not self._tree.model.existFrame(name):
            raise InputError(f"the MJCF has no site '{site}'", remedy="name one of its sites")
        return self._tree.model.getFrameId(name)
