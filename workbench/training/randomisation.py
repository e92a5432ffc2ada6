"""Differences between worlds: links, ground, base, and uncertain identified parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from workbench.core import Estimate, InputError
from workbench.models import Model

from .machine import LEGS, Machine, make_machine

Fields = dict[str, np.ndarray]
_DRAWN_MODELS = 32  # models drawn from identification's intervals; worlds share them
#: Fields of a compiled model that a parameter of an effect can change.
_FIELDS = (
    *("body_mass", "body_inertia", "body_ipos", "body_iquat", "body_gravcomp"),
    *("dof_armature", "dof_damping", "dof_frictionloss", "jnt_stiffness"),
    *("tendon_armature", "tendon_damping", "tendon_frictionloss", "tendon_stiffness"),
    *("actuator_gainprm", "actuator_biasprm", "pair_friction", "pair_solref"),
)


@dataclass(frozen=True)
class LinkRange:
    """Ranges for every link of every leg (paper, Table IV); each link is drawn separately.

    Attributes:
        centre: largest offset of the centre of mass, each way and axis [m].
        inertia: lowest and highest scale of the inertia.
        mass: lowest and highest scale of the mass.
    """

    centre: float
    inertia: tuple[float, float]
    mass: tuple[float, float]


LEG_RANDOMISATION: dict[str, LinkRange | None] = {
    "none": None,
    "leg_rand": LinkRange(0.01, (0.95, 1.05), (0.95, 1.05)),
    "heavy_leg_rand": LinkRange(0.03, (0.50, 1.50), (0.70, 1.30)),
}


@dataclass(frozen=True)
class Randomisation:
    """Ranges of what is drawn for each world, once per run, and of the pushes.

    Attributes:
        legs: name in `LEG_RANDOMISATION`.
        friction: of the feet on the ground, lowest and highest; not where an effect says it.
        base_mass: lowest and highest addition to the trunk's mass [kg].
        base_centre: largest offset of the trunk's centre of mass, each way and axis [m].
        push: largest sudden change of the base's horizontal velocity [m/s], each way.
        push_every_s: mean time between two [s].
        intervals: whether effects' parameters are drawn from the deviations that identification gave.
    """

    legs: str = "none"
    friction: tuple[float, float] = (0.5, 1.1)
    base_mass: tuple[float, float] = (-0.5, 1.0)
    base_centre: float = 0.02
    push: float = 0.3
    push_every_s: float = 4.0
    intervals: bool = True


def world_fields(machine: Machine, settings: Randomisation, worlds: int, seed: int) -> Fields:
    """Return per-world values (worlds, ...) of MuJoCo's model fields, without constants derived from them.

    Args:
        machine: the machine.
        settings: what to draw.
        worlds: how many.
        seed: of the draw.

    Raises:
        InputError: the lowest addition to the trunk's mass leaves none of it.
    """
    generator, m = np.random.default_rng(seed), machine.mujoco
    out: Fields = _drawn_models(machine, settings, worlds, generator)

    def field(name: str) -> np.ndarray:
        if name not in out:
            out[name] = np.repeat(np.asarray(getattr(m, name), float)[None], worlds, axis=0)
        return out[name]

    links = LEG_RANDOMISATION[settings.legs]
    if links is not None:
        # a leg's links are what carries its joints, less the bracket that only holds it
        bodies = [m.jnt_bodyid[m.joint(n).id] for n in machine.joints if not n.endswith("abduction")]
        many = worlds, len(bodies)
        field("body_mass")[:, bodies] *= generator.uniform(*links.mass, many)
        field("body_inertia")[:, bodies] *= generator.uniform(*links.inertia, many)[..., None]
        field("body_ipos")[:, bodies] += generator.uniform(-links.centre, links.centre, (*many, 3))
    if machine.floating:
        trunk = m.body("trunk").id
        if m.body_mass[trunk] + settings.base_mass[0] <= 0.0:
            raise InputError(
                f"{settings.base_mass[0]:g} kg more leave a trunk of {m.body_mass[trunk]:g} kg without mass",
                column="trunk_mass", remedy="give a larger lowest value",
            )  # fmt: skip
        field("body_mass")[:, trunk] += generator.uniform(*settings.base_mass, worlds)
        spread = settings.base_centre
        field("body_ipos")[:, trunk] += generator.uniform(-spread, spread, (worlds, 3))
        feet = [m.geom(f"{leg}_sphere").id for leg in LEGS]
        field("geom_friction")[:, feet, 0] = generator.uniform(*settings.friction, (worlds, 1))
    return out


def _drawn_models(
    machine: Machine, settings: Randomisation, worlds: int, generator: np.random.Generator
) -> Fields:
    """Fields in which models drawn from the parameters' deviations differ."""
    model = machine.model
    if not settings.intervals or not any(p.std for e in model.effects for p in e.parameters.values()):
        return {}
    drawn = [
        make_machine(machine.kind, _draw(model, generator)).mujoco for _ in range(min(_DRAWN_MODELS, worlds))
    ]
    which = np.arange(worlds) % len(drawn)
    return {name: stacked[which] for name in _FIELDS if (stacked := _differing(drawn, name)) is not None}


def _differing(models: Sequence[mujoco.MjModel], name: str) -> np.ndarray | None:
    stacked = np.stack([np.asarray(getattr(m, name), float) for m in models])
    return stacked if np.ptp(stacked, axis=0).any() else None


def _draw(model: Model, generator: np.random.Generator) -> Model:
    """The model with every effect's parameters drawn; one whose sign would change keeps its value."""
    effects = []
    for effect in model.effects:
        drawn = {}
        for name, p in effect.parameters.items():
            value = p.value + p.std * generator.standard_normal()
            drawn[name] = Estimate(value if value * p.value > 0.0 else p.value, p.std, p.unit)
        effects.append(replace(effect, parameters=drawn))
    return replace(model, effects=tuple(effects))
