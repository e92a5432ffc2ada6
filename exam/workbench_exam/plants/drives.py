"""What sits between a command and the joints, as arrays that compiled code takes: one number per drive.

A drive turns by `couple @ q` (through a belt or a differential; the identity where each motor has its own
joint). Behind a soft coupling the rotor is a body of its own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .chain import Machine, Numbers, numbers


class Drives(NamedTuple):
    """All drives; SI, of the drive's own angle and torque. Arrays (n,) but for `couple` (n, n).

    Attributes:
        couple: drive angles over joint angles.
        driven: 1 where a motor is.
        armature, damping, friction: of the rotor.
        gain, bias: true torque = gain x measured + bias [1, N m].
        limit: of torque [N m]. lag: of the current loop [s]. delay: of the command [s], the same for all.
        spring, rest: a spring to the frame [N m/rad, rad]. drag: of the squared speed [N m s^2/rad^2].
        static, slow: friction at rest above that in motion [N m], and the speed over which it falls [rad/s].
        ripple, order, phase: cogging [N m, 1/rev, rad].
        stiffness, series, gap: of the coupling, 0 where it is rigid [N m/rad, N m s/rad, rad].
        offset: of the encoder [rad].
    """

    couple: np.ndarray
    driven: np.ndarray
    armature: np.ndarray
    damping: np.ndarray
    friction: np.ndarray
    gain: np.ndarray
    bias: np.ndarray
    limit: np.ndarray
    lag: np.ndarray
    delay: np.ndarray
    spring: np.ndarray
    rest: np.ndarray
    drag: np.ndarray
    static: np.ndarray
    slow: np.ndarray
    ripple: np.ndarray
    order: np.ndarray
    phase: np.ndarray
    stiffness: np.ndarray
    series: np.ndarray
    gap: np.ndarray
    offset: np.ndarray


def plain(machine: Machine) -> tuple[Numbers, Drives]:
    """The links without rotors and friction, and drives that have these and nothing else."""
    m, n = numbers(machine.links), len(machine.links)
    zero = {name: np.zeros(n) for name in Drives._fields}
    couple = np.array(machine.couple, float) if machine.couple else np.eye(n)
    drives = Drives(
        **zero
        | {
            "couple": couple,
            "driven": np.array([float(link.driven) for link in machine.links]),
            "armature": m.armature,
            "damping": m.damping,
            "friction": m.friction,
            "gain": np.ones(n),
            "limit": np.full(n, 1e9),
            "slow": np.ones(n),
        }
    )
    nothing = np.zeros(n)
    return m._replace(armature=nothing, damping=nothing, friction=nothing), drives
