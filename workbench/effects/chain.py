"""The torque chain from command to mechanism, and the build that effects are installed into."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import mujoco
import numpy as np


@dataclass(frozen=True)
class FrictionTerm:
    """Friction whose bound depends on the state, on one tendon.

    `law(speed, torque, *parameters)` gives the bound [N m or N] for arrays of speeds and motor torques;
    the parameters broadcast, so many candidates are evaluated in one call.
    """

    tendon: str
    law: Callable[..., np.ndarray]
    parameters: tuple[float, ...]


@dataclass
class TorqueChain:
    """What happens between `torque_command` and the mechanism, in the order of these fields.

    command -> `delay_s` -> `limit` -> **torque_measured** -> `gain` -> `bias` -> friction -> mechanism.
    Arrays (n,), actuator coordinates. Each term of `friction` adds to its tendon's constant friction loss;
    it is evaluated at the middle of a step, while MuJoCo's friction constraint decides sign and sticking.
    """

    delay_s: float
    limit: np.ndarray
    gain: np.ndarray
    bias: np.ndarray
    friction: list[FrictionTerm] = field(default_factory=list)


@dataclass
class Build:
    """A model on its way to MuJoCo: the spec that effects edit, and the chain in front of it."""

    spec: mujoco.MjSpec
    chain: TorqueChain
