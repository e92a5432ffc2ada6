"""What a torque record does to drives and links: the projected equation of motion integrated in time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import SimulationError

from .closed_chain import ClosedChain


@dataclass(frozen=True)
class Motion:
    """Drive positions and speeds over time.

    Attributes:
        time: (T + 1,) [s].
        position: (T + 1, n) [rad or m].
        velocity: (T + 1, n) [rad/s or m/s].
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray


def simulate(
    chain: ClosedChain,
    inertia: Sequence[float],
    damping: Sequence[float],
    torque: np.ndarray,
    step: float,
    q0: np.ndarray,
    v0: np.ndarray | None = None,
    *,
    substeps: int = 1,
) -> Motion:
    """Integrate (M + J_a) a + bias + B_a v = gravity + torque by RK4.

    Args:
        chain: the links.
        inertia: of each actuator at its output (n,) [kg m^2].
        damping: of each actuator at its output (n,) [N m s/rad].
        torque: (T, n) [N m], each row held for one step.
        step: [s].
        q0: drive positions at the beginning (n,).
        v0: speeds at the beginning (n,), zero if not given.
        substeps: RK4 steps within one step of the record.

    Raises:
        SimulationError: the motion leaves the workspace or meets a dead point; says when.
    """
    rotor, drag = np.diag(np.array(inertia, float)), np.array(damping, float)
    n, torque = chain.size, np.asarray(torque, float)
    state = np.concatenate([q0, np.zeros(n) if v0 is None else v0])

    def rate(state: np.ndarray, torque: np.ndarray) -> np.ndarray:
        q, v = state[:n], state[n:]
        at = chain.reduced_dynamics(q, v)
        return np.concatenate([v, np.linalg.solve(at.mass + rotor, at.gravity + torque - at.bias - drag * v)])

    states = [state]
    h = step / substeps
    for k, held in enumerate(torque):
        try:
            for _ in range(substeps):
                k1 = rate(state, held)
                k2 = rate(state + h / 2 * k1, held)
                k3 = rate(state + h / 2 * k2, held)
                k4 = rate(state + h * k3, held)
                state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        except SimulationError as error:
            raise SimulationError(f"{chain.mechanism.file.name}: t = {k * step:.4f} s: {error}") from error
        states.append(state)
    record = np.array(states)
    return Motion(step * np.arange(len(record)), record[:, :n], record[:, n:])
