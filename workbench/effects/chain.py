"""The torque chain from command to mechanism, and the build that effects are installed into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np

from workbench.models import Inertial, Model, axis_tendon, base_spec, load_tree

from .law import Law


@dataclass(frozen=True)
class FrictionTerm:
    """Friction whose bound depends on the state, on one tendon.

    `law(speed, torque, *parameters)` gives the bound [N m or N] at a speed and a motor torque.
    """

    tendon: str
    law: Law
    parameters: tuple[float, ...]


@dataclass(frozen=True)
class TorqueTerm:
    """A torque that depends on the state, on one tendon.

    `law(position, speed, *parameters)` gives it [N m or N].
    """

    tendon: str
    law: Law
    parameters: tuple[float, ...]


@dataclass(frozen=True)
class HysteresisTerm:
    """Dahl's friction of `torque` [N m or N] and `stiffness`: the spring `spring` beside a `tendon`."""

    spring: str
    tendon: str
    torque: float
    stiffness: float


@dataclass(frozen=True)
class FlankTerm:
    """Damping of the tendon `spring` [N m s/rad or N s/m] while it is bent by more than `half` a gap."""

    spring: str
    damping: float
    half: float


@dataclass
class SensorErrors:
    """Errors between the drives' true motion and what the log and the controller read.

    Per axis, arrays (n,), actuator coordinates:

        position = scale q + sine sin q + cosine cos q + offset
        velocity = (scale + sine cos q - cosine sin q) w, behind a first-order lag of `lag` [s]

    and both `delay_s` [s] late. A sensor of speed is taken to differentiate the encoder, as drives do.
    """

    offset: np.ndarray
    scale: np.ndarray
    sine: np.ndarray
    cosine: np.ndarray
    lag: np.ndarray
    delay_s: float = 0.0

    @staticmethod
    def of(size: int) -> SensorErrors:
        """Return sensors without errors."""
        zero = np.zeros(size)
        return SensorErrors(zero.copy(), np.ones(size), zero.copy(), zero.copy(), zero.copy())

    @property
    def none(self) -> bool:
        """Return whether there is no error."""
        errors = self.offset, self.scale - 1.0, self.sine, self.cosine, self.lag, self.delay_s
        return not any(np.any(e) for e in errors)


@dataclass
class TorqueChain:
    """The steps between `torque_command` and the mechanism, in the order of these fields.

    command -> `delay_s` -> `limit` -> `stall`, `no_load` -> `lag` -> **torque_measured** -> `gain` ->
    `heating`, `heat_time` -> `bias` -> `torques` -> `friction`, `hysteresis`, `flanks` -> mechanism. Arrays
    (n,), actuator coordinates; what is not there has its neutral value. Each term of `friction` adds to its
    tendon's constant friction loss, while MuJoCo's friction constraint decides sign and sticking. Terms of
    the state are evaluated at the middle of a step. `sensors` stand between the motion and the loop, whose
    true gains are `kp_scale` and `kd_scale` times those stated (by axis of the controller's coordinates).
    """

    delay_s: float
    limit: np.ndarray
    stall: np.ndarray
    no_load: np.ndarray
    full_braking: bool
    lag: np.ndarray
    gain: np.ndarray
    heating: np.ndarray
    heat_time: np.ndarray
    bias: np.ndarray
    sensors: SensorErrors
    kp_scale: np.ndarray
    kd_scale: np.ndarray
    torques: list[TorqueTerm] = field(default_factory=list)
    friction: list[FrictionTerm] = field(default_factory=list)
    hysteresis: list[HysteresisTerm] = field(default_factory=list)
    flanks: list[FlankTerm] = field(default_factory=list)

    @staticmethod
    def of(model: Model) -> TorqueChain:
        """Return the chain of a model's drives before any effect."""
        one = np.ones(model.size)
        return TorqueChain(
            delay_s=model.actuators.delay_s,
            limit=np.array(model.actuators.torque_limit),
            stall=np.inf * one,
            no_load=np.inf * one,
            full_braking=model.actuators.full_braking,
            lag=0.0 * one,
            gain=one.copy(),
            heating=0.0 * one,
            heat_time=one.copy(),
            bias=0.0 * one,
            sensors=SensorErrors.of(model.size),
            kp_scale=one.copy(),
            kd_scale=one.copy(),
        )

    @property
    def follows_state(self) -> bool:
        """Return whether torques or friction bounds must be set step by step."""
        return bool(self.torques or self.friction or self.hysteresis or self.flanks)


@dataclass
class Build:
    """A model during construction: the spec that effects edit, and the chain in front of it.

    `links`: the spec that has the links, another one only where drives carry them. `rows`: the joints that
    each axis's tendon wraps, with their coefficients. `contacts`: pairs of the ground and each foot, none
    where the machine is off the ground; `contact_law`: their stiffness and damping [N/m, N s/m], None for
    what MuJoCo takes from the geoms. `inertials`: of links that effects changed, by body.
    """

    spec: mujoco.MjSpec
    links: mujoco.MjSpec
    chain: TorqueChain
    rows: dict[str, dict[str, float]]
    contacts: list[str] = field(default_factory=list)
    contact_law: tuple[float, float] | None = None
    inertials: dict[str, Inertial] = field(default_factory=dict)

    @staticmethod
    def of(model: Model, timestep: float = 0.001, held: Sequence[str] = ()) -> Build:
        """Return a model before any effect: its serial tree, and the chain of its drives."""
        rows = {
            axis_tendon(i, location): {
                name: float(c) for name, c in zip(model.joints, row, strict=True) if c and name not in held
            }
            for location, matrix in (("actuator", model.transmission), ("joint", np.eye(model.size)))
            for i, row in enumerate(matrix)
        }
        spec = base_spec(model, timestep, held)
        links = load_tree(model.carried.serial) if model.carried else spec
        return Build(spec, links, TorqueChain.of(model), rows)
