"""A mechanism whose transmission depends on the posture, in serial coordinates, over its whole workspace.

The closed chain is solved once over the workspace (`posture_chain`) and kept as series of three functions:
the links' inertia M_links(q), the potential energy V(q) of their weights, and the drives' positions q_p(q).
Everything else follows by differentiating those, so that what is simulated is a mechanical system exactly:

    M = M_links + J^T A J,                    gravity = -dV/dq,
    bias_i = (dM_links_ij/dq_k - dM_links_jk/dq_i / 2) v_j v_k + (J^T A J')_i,   J = dq_p/dq.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core import InputError, SimulationError
from workbench.models import Model
from workbench.serial_tree import SerialTree

from .posture_chain import PostureDynamics
from .posture_closure import say, workspace
from .posture_effects import AddedToLinks, of_tree
from .posture_known import KnownLinks
from .posture_table import Series, tabulate, together

_SLACK = 1e-9  # rad or m outside the limits that rounding may make
BEYOND = 0.1  # rad or m outside the limits within which the series go on as at the edge


@dataclass(frozen=True)
class Terms:
    """Values of the series at N postures.

    Attributes:
        links: inertia of the links (N, n, n) [kg m^2].
        slope: its derivatives, (N, k, n, n) to angle k.
        gravity: torque of the weights (N, n) [N m].
        potential: (N,) [J].
        drives: positions q_p (N, n).
        jacobian: J (N, n, n).
        curvature: second derivatives of q_p, (N, drive, n, n).
    """

    links: np.ndarray
    slope: np.ndarray
    gravity: np.ndarray
    potential: np.ndarray
    drives: np.ndarray
    jacobian: np.ndarray
    curvature: np.ndarray

    def link_bias(self, v: np.ndarray) -> np.ndarray:
        """Velocity terms of the links' inertia (N, n) [N m], by Christoffel's symbols."""
        along = np.einsum("nkij,nj,nk->ni", self.slope, v, v)
        return along - 0.5 * np.einsum("nijk,nj,nk->ni", self.slope, v, v)

    def drive_rate(self, v: np.ndarray) -> np.ndarray:
        """Return J' v (N, n): the drives' acceleration if the joints move at constant rate."""
        return np.einsum("naij,ni,nj->na", self.curvature, v, v)

    def pulled_back(self, drives: np.ndarray) -> np.ndarray:
        """J^T diag(x) J (N, n, n) of the drives' inertia or damping x, (n,) or (N, n)."""
        weighted = np.broadcast_to(drives, self.drives.shape)[:, :, None] * self.jacobian
        return self.jacobian.transpose(0, 2, 1) @ weighted


MOST_DRIVES = 3  # of a mechanism whose series are short enough to be had


class PostureDependent:
    """A model's closed chain as series over its limits; everything is vectorised over N postures.

    Attributes:
        added: what effects of the model add to the links.

    Args:
        model: names the closed chain with its limits, and the drives; effects on its links are in them.
        tree: leave out what this serial tree's links have already; totals without it.
        tolerance: size of the terms that the series leave out, relative.

    Raises:
        InputError: no closed chain or limits, or a posture within the limits that cannot be reached or is
            too close to a singular one; names it.
    """

    def __init__(self, model: Model, *, tree: SerialTree | None = None, tolerance: float = 1e-12) -> None:
        if model.size > MOST_DRIVES:
            raise InputError(
                f"model '{model.name}' has {model.size} coordinates that depend on each other",
                file=model.source, remedy="split it into mechanisms of three drives or fewer",
            )  # fmt: skip
        self.model, self.box, self.added = model, workspace(model), AddedToLinks(model)
        self.inertia, self.damping = np.array(model.actuators.inertia), np.array(model.actuators.damping)
        self.least_margin, self.least_at = np.inf, self.box.mean(axis=1)
        n = model.size
        self._upper = np.triu_indices(n)
        found = self._solve(tree, tolerance)
        size = len(self._upper[0])
        links, energy, drives = (found.part(s) for s in (slice(size), [size], slice(size + 1, None)))
        # in the order of `at`
        parts = [found, *(links.slope(k) for k in range(n)), *(energy.slope(k) for k in range(n))]
        parts += [drives.slope(k) for k in range(n)]
        parts += [drives.slope(int(i)).slope(int(j)) for i, j in zip(*self._upper, strict=True)]
        self._series = together(parts)

    @property
    def series(self) -> tuple[np.ndarray, np.ndarray]:
        """All terms as Chebyshev coefficients (d_1 ... d_n, K), and d_1 ... d_n."""
        return (c := self._series.coefficients).reshape(-1, c.shape[-1]), np.array(c.shape[:-1])

    def at(self, q: np.ndarray) -> Terms:
        """Return every term at `q` (N, n) [rad or m].

        Raises:
            SimulationError: a posture outside the limits; names its joint.
        """
        q = np.atleast_2d(np.asarray(q, float))
        self.check(q)
        n, count, values = self.model.size, len(self._upper[0]), self._series(q)
        sizes = [count, 1, n, n * count, n, n * n, n * count]
        links, energy, drives, slope, pull, jacobian, curvature = np.split(values, np.cumsum(sizes)[:-1], 1)
        return Terms(
            self._square(links),
            self._square(slope.reshape(-1, n, count)),
            -pull,
            energy[:, 0],
            drives,
            jacobian.reshape(-1, n, n).transpose(0, 2, 1),
            self._square(curvature.reshape(-1, count, n).transpose(0, 2, 1)),
        )

    def dynamics(self, q: np.ndarray, v: np.ndarray | None = None) -> PostureDynamics:
        """Return all terms at positions `q` and rates `v` (N, n); without `v`, at rest.

        Raises:
            SimulationError: a posture outside the limits; names its joint.
        """
        t = self.at(q)
        v = np.zeros_like(t.gravity) if v is None else np.atleast_2d(np.asarray(v, float))
        thrown = np.einsum("nai,na->ni", t.jacobian, self.inertia * t.drive_rate(v))
        return PostureDynamics(
            t.links + t.pulled_back(self.inertia),
            t.link_bias(v) + thrown,
            t.gravity,
            t.pulled_back(self.damping),
            t.jacobian,
            t.drives,
            t.potential,
        )

    def mass(self, q: np.ndarray) -> np.ndarray:
        """Mass matrix (N, n, n) [kg m^2] at `q` (N, n)."""
        return self.dynamics(q).mass

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """J (N, n, n), d q_p / d q_s at `q` (N, n)."""
        return self.at(q).jacobian

    def inside(self, q: np.ndarray) -> np.ndarray:
        """Return which postures (N, n) lie within the limits, (N,)."""
        within = (q >= self.box[:, 0] - _SLACK) & (q <= self.box[:, 1] + _SLACK)
        return np.all(within, axis=1)

    def nearest_inside(self, q: np.ndarray) -> np.ndarray:
        """Return postures (N, n) with those a little outside the limits moved onto them.

        Raises:
            SimulationError: one that is further outside, or NaN.
        """
        inside = np.clip(q, *self.box.T)
        if not np.abs(q - inside).max(initial=0.0) < BEYOND:
            self.check(q)
            raise SimulationError(f"model '{self.model.name}': no posture has its drives there")
        return inside

    def check(self, q: np.ndarray) -> None:
        """Raise if one of the postures (N, n) lies outside the limits.

        Raises:
            SimulationError: names the first joint that is, its position and its limits.
        """
        good = self.inside(q)
        if good.all():
            return
        k = int(np.argmin(good))
        off = np.maximum(self.box[:, 0] - q[k], q[k] - self.box[:, 1])
        i = int(np.argmax(np.where(np.isnan(off), np.inf, off)))
        low, high = self.box[i]
        where = f" of state {k}" if len(q) > 1 else ""
        raise SimulationError(
            f"model '{self.model.name}': joint '{self.model.joints[i]}'{where} is at {q[k, i]:.4g}, outside "
            f"its workspace of {low:.4g} to {high:.4g}"
        )

    def _solve(self, tree: SerialTree | None, tolerance: float) -> Series:
        """Return series of the links' inertia, potential energy and drive positions."""
        chain = KnownLinks(self.model)
        sides: set[bool] = set()

        def sample(q: np.ndarray) -> np.ndarray:
            at = chain.dynamics(q)
            assert at.margin is not None
            if at.margin.min() < self.least_margin:
                self.least_margin, self.least_at = float(at.margin.min()), q[int(np.argmin(at.margin))]
            sides.update(np.linalg.det(at.jacobian) > 0.0)
            more, higher = self.added.at(q)
            mass, energy = at.mass + more, at.potential + higher
            if tree is not None:
                own, low = of_tree(tree, q)
                mass, energy = mass - own, energy - low
            return np.concatenate([mass[:, *self._upper], energy[:, None], at.drives], axis=1)

        where = {"file": self.model.source, "column": "closed_chain.limits"}
        try:
            found = tabulate(sample, self.box, tolerance, self._least(chain))
        except SimulationError as error:
            raise InputError(
                f"{error}, which is within the limits", **where, remedy="narrow the limits to the workspace"
            ) from error
        if found is None or len(sides) > 1:
            passed = "passes a dead point of its drives" if found else "comes too close to a singular posture"
            raise InputError(
                f"the mechanism {passed} within its limits (margin {self.least_margin:.2g} at "
                f"{say(self.model, self.least_at)})", **where, remedy="narrow the limits",
            )  # fmt: skip
        return found

    def _least(self, chain: KnownLinks) -> np.ndarray:
        """Return a thousandth of the total mass and weight; below it, a term may be rounding only."""
        at = chain.dynamics(self.box.mean(axis=1))
        mass = float(np.abs(at.mass).max())
        pull = max(float(np.abs(at.gravity).max()), float(np.abs(at.potential).max()))
        return 1e-3 * np.array([*[mass] * len(self._upper[0]), pull or 1.0, *[1.0] * self.model.size])

    def _square(self, upper: np.ndarray) -> np.ndarray:
        """Return symmetric matrices (..., n, n) from their upper triangles (..., n (n + 1) / 2)."""
        n = self.model.size
        out = np.empty((*upper.shape[:-1], n, n))
        i, j = self._upper
        out[..., i, j] = out[..., j, i] = upper
        return out
