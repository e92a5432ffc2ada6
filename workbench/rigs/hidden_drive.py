"""Hidden effects in the torque chain, unmeasured disturbances, and what adds inertia or gravity."""

from __future__ import annotations

import numpy as np

from .machine import Derating, Machine, Place, SpeedLimit, once


def torque_bias(machine: Machine, at: Place, *, torque: float) -> None:
    """Added after the torque sensor."""
    machine.bias[at.index] += torque


def torque_constant_error(machine: Machine, at: Place, *, gain: float) -> None:
    """True torque is `gain` times the measured one."""
    machine.gain[at.index] *= gain


def command_delay(machine: Machine, at: Place, *, time: float) -> None:
    """A delay beyond T_d in both drives, ahead of the torque sensor."""
    machine.delay += time


def current_loop_lag(machine: Machine, at: Place, *, time_constant: float) -> None:
    """First-order lag ahead of the torque sensor."""
    once(machine.lag[at.index], "current-loop lag per motor")
    machine.lag[at.index] = time_constant


def torque_saturation(machine: Machine, at: Place, *, limit: float) -> None:
    """The drive clips at `limit`."""
    machine.limit[at.index] = min(machine.limit[at.index], limit)


def speed_torque_limit(machine: Machine, at: Place, *, stall_torque: float, no_load_speed: float) -> None:
    """The drive clips at stall_torque (1 - w / no_load_speed) driving, at stall_torque braking."""
    once(machine.speed_limit[at.index], "speed limit per motor")
    machine.speed_limit[at.index] = SpeedLimit(stall_torque, no_load_speed)


def thermal_derating(machine: Machine, at: Place, *, coefficient: float, time_constant: float) -> None:
    """True torque is (1 - coefficient y) times the measured one, y its square through a first-order lag."""
    once(machine.derating[at.index], "derating a motor")
    machine.derating[at.index] = Derating(coefficient, time_constant)


def periodic_disturbance(
    machine: Machine, at: Place, *, torque: float, frequency: float, phase: float
) -> None:
    """An unmeasured tone of `frequency` [Hz]; an outsider."""

    def disturbance(t: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        return torque * np.sin(2 * np.pi * frequency * t + phase)

    machine.disturbances.append((at.index, disturbance))


def random_walk_torque(machine: Machine, at: Place, *, torque: float, time_constant: float) -> None:
    """A walk pulled back to zero (Ornstein-Uhlenbeck) of RMS `torque`; an outsider."""

    def disturbance(t: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        kept = np.exp(-(t[1] - t[0]) / time_constant)
        kicks = generator.standard_normal(len(t)) * torque * np.sqrt(1 - kept**2)
        walk, value = np.empty(len(t)), torque * generator.standard_normal()
        for row, kick in enumerate(kicks):
            walk[row] = value
            value = kept * value + kick
        return walk

    machine.disturbances.append((at.index, disturbance))


def reflected_inertia(machine: Machine, at: Place, *, inertia: float) -> None:
    """More rotor inertia."""
    machine.rotor[at.index] += inertia


def linkage_inertia(machine: Machine, at: Place, *, M11: float, M12: float, M22: float) -> None:
    """Increments in actuator coordinates, with their Coriolis terms; M12 is the factor of cos alpha."""
    machine.increment = machine.increment.plus(m11=M11, m12=M12, m22=M22)


def linkage_gravity(machine: Machine, at: Place, *, g1: float, g2: float) -> None:
    """Increments; the torque is -g sin q."""
    machine.increment = machine.increment.plus(g1=g1, g2=g2)


def payload_mass(machine: Machine, at: Place, *, mass: float) -> None:
    """A point mass on the foot of the Drake model."""
    machine.payload += mass
