"""The paper's implementation of S3N in many worlds: compensation torques from the step before.

The variant ``explicit`` simulates the Kin-Only tree with the diagonal of the drives' inertia and damping on
its joints, and injects the rest as torques (paper, Eqs. 25 to 27). They follow the acceleration of the
preceding step, unfiltered. A plain MJCF file does not hold them: the engine is told them at every step.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from workbench.models import Model
from workbench.s3n.explicit import Injection, injection

if TYPE_CHECKING:
    from .machine import Machine
    from .situation import Array
    from .worlds import Worlds

#: The variant's name.
EXPLICIT = "explicit"


def split(leg: mujoco.MjSpec, model: Model) -> Injection:
    """Return what is injected into a leg, and give its joints what is not: the diagonal of the increments.

    Args:
        leg: the Kin-Only tree of the leg; its joints are changed.
        model: of the leg, with its linkage.

    Raises:
        InputError: the model has no parallelogram with a linkage.
    """
    parts = injection(model)
    for name, inertia, damping in zip(model.joints, parts.inertia, parts.damping, strict=True):
        joint = leg.joint(name)
        joint.armature += float(inertia)
        joint.damping = np.asarray(joint.damping) + np.array([float(damping), 0.0, 0.0])
    return parts


class Injector:
    """Compensation torques of all legs of a machine whose variant is ``explicit``.

    Args:
        machine: the machine.
        put: gives a numpy array in the library, precision and device of the worlds.
        xp: `numpy` or `torch`.
    """

    def __init__(self, machine: Machine, put: Any, xp: Any) -> None:
        parts = machine.injected
        assert parts is not None
        self._xp, pairs = xp, machine.dofs.reshape(-1, len(machine.dofs) // _legs(machine))[:, -2:]
        alpha = machine.places.reshape(pairs.shape[0], -1)[:, -1]
        self.places, self.dofs = put(alpha), (put(pairs[:, 0]), put(pairs[:, 1]))
        self._coupling, self._drag, self._linkage = parts.coupling, parts.drag, parts.linkage

    def torque(self, qpos: Array, qvel: Array, qacc: Array) -> tuple[Array, Array]:
        """Return torques on hips and knees, (W, legs) each [N m], of positions, speeds and accelerations."""
        hip, knee = self.dofs
        fold = self._linkage[1] * self._xp.cos(qpos[:, self.places])
        a1, a2, v1, v2 = qacc[:, hip], qacc[:, knee], qvel[:, hip], qvel[:, knee]
        m11, _, m22 = self._linkage  # in the drives' coordinates; J^T M J in those of the joints
        across = m22 + fold + float(self._coupling[0, 1])
        drag = float(self._drag[0, 1])
        on_hip = (m11 + m22 + 2.0 * fold) * a1 + across * a2 + drag * v2
        return -on_hip, -(across * a1 + m22 * a2 + drag * v1)


class InjectedWorlds:
    """Worlds whose legs get compensation torques at every step; the interface is that of `worlds.Worlds`.

    Args:
        worlds: an engine that has `qacc` (W, nv) and `qfrc_applied` (W, nv).
        machine: what it simulates, of the variant ``explicit``.
    """

    def __init__(self, worlds: Any, machine: Machine) -> None:
        self._worlds: Worlds = worlds
        self._engine, self.xp = worlds, worlds.xp
        self.qpos, self.qvel, self.ctrl = worlds.qpos, worlds.qvel, worlds.ctrl
        self.sensordata = worlds.sensordata
        self._injector = Injector(machine, self._put_array, self.xp)
        self._before = self.xp.zeros_like(self.qvel)  # acceleration of the preceding step; none at a start

    def step(self) -> None:
        """Simulate one step of all worlds."""
        hip, knee = self._injector.torque(self.qpos, self.qvel, self._before)
        applied = self._engine.qfrc_applied
        applied[:, self._injector.dofs[0]], applied[:, self._injector.dofs[1]] = hip, knee
        self._worlds.step()
        self._before[:] = self._engine.qacc

    def put(self, where: Array, qpos: Array, qvel: Array) -> None:
        """Restart the worlds marked by `where`, without an acceleration before."""
        self._worlds.put(where, qpos, qvel)
        self._before[:] = self.xp.where(where[:, None], self.xp.zeros_like(self._before), self._before)

    def state(self) -> dict[str, Any]:
        """Return everything on which the next step depends."""
        return {**self._worlds.state(), "acceleration": self._copy(self._before)}

    def restore(self, state: Mapping[str, Any]) -> None:
        """Continue from a `state`."""
        self._worlds.restore({key: value for key, value in state.items() if key != "acceleration"})
        kept = state["acceleration"]
        self._before[:] = kept if self.xp is np else self.xp.as_tensor(kept, device=self._before.device)

    def _copy(self, array: Array) -> Array:
        return array.copy() if self.xp is np else array.clone()

    def _put_array(self, values: np.ndarray) -> Array:
        return values if self.xp is np else self.xp.as_tensor(values, device=self.qpos.device)


def with_torques(worlds: Any, machine: Machine) -> Worlds:
    """Return an engine's worlds, with compensation torques where the machine's variant has them."""
    return worlds if machine.injected is None else InjectedWorlds(worlds, machine)


def _legs(machine: Machine) -> int:
    """How many legs: each ends in a hip and a knee."""
    return sum(name.endswith(machine.model.joints[-1]) for name in machine.joints)
