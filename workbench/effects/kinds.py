"""What follows from what an effect says of itself: how it is fitted, tried and seen."""

from __future__ import annotations

from collections.abc import Iterable

from workbench.models import Model

from .base import Effect, FrfSignature, SignalStage
from .compliance import Compliance
from .contact import OnGround
from .corrected import OfBody
from .setting import SLIDING_SPEED
from .structural import Structural

#: Stages of what acts on the motion; what shifts commands or readings is no torque.
TORQUES = frozenset({SignalStage.MOTOR, SignalStage.FRICTION, SignalStage.MECHANISM})


def tier_of(effect: Effect) -> int:
    """0 for the simple effects, 1 for refinements that are tried after them.

    A refinement contains another effect, gives way, or has a size and a shape.
    """
    if effect.search.tier is not None:
        return effect.search.tier
    sized = bool(effect.parameters.linear and effect.parameters.nonlinear)
    return int(sized or bool(effect.search.contains) or isinstance(effect, Compliance))


def depends_on(effect: Effect) -> tuple[str, ...]:
    """Quantities of its axis that decide its torque; friction's is the speed."""
    return (*(("speed",) if effect.stage is SignalStage.FRICTION else ()), *effect.search.depends_on)


def shared_by_design(effect: Effect) -> bool:
    """Whether all axes may have it alike: friction and limits come with the make of a drive."""
    usual = effect.stage in (SignalStage.COMMAND, SignalStage.FRICTION)
    return bool(effect.locations) and (usual or effect.search.shared_by_design)


def is_dry(effect: Effect) -> bool:
    """Whether it sticks, so that the model's sliding speed matters."""
    return SLIDING_SPEED in effect.parameters.settles


def is_pure_delay(effect: Effect) -> bool:
    """Whether an effect is a delay or a lag, and nothing else."""
    return effect.search.frf_signature is FrfSignature.DELAY and len(effect.parameters) == 1


def late_alike(effect: Effect, effects: Iterable[Effect]) -> tuple[str, ...]:
    """Other delays of the whole machine: no log without measured torque tells one from this one."""
    if not is_pure_delay(effect) or effect.locations:
        return ()
    return tuple(e.name for e in effects if e is not effect and is_pure_delay(e) and not e.locations)


def by_finite_difference(effect: Effect) -> bool:
    """Whether a fit has to take its derivatives from simulations.

    Without a linear coefficient no column is exact near parameters that do something, unless the motion
    before the effect is known.
    """
    p = effect.parameters
    return bool(p.nonlinear) and not p.linear and type(effect).before is Effect.before


def on_links(effect: Effect) -> bool:
    """Whether it acts on links, which a spring or a gap may hold away from the motors."""
    alone = effect.locations and depends_on(effect)  # a torque on one axis, which its place says
    return (
        effect.stage is SignalStage.MECHANISM and not isinstance(effect, Compliance | OnGround) and not alone
    )


def changes_foot_position(effect: Effect) -> bool:
    """Whether it puts a foot elsewhere at the same reading of the encoders: a length of a link does."""
    return on_links(effect) and any(p.unit == "m" for p in effect.parameters)


def of_mass(effect: Effect) -> bool:
    """Whether it changes what links weigh, and nothing of how they move."""
    return on_links(effect) and not (isinstance(effect, Structural) or changes_foot_position(effect))


def bends_reading(effect: Effect) -> bool:
    """Whether a sensor reads its angle along another scale, rather than shifted or late.

    Of no motion but that of gravity, this is a spring of another law.
    """
    shifted = effect.search.frf_signature is FrfSignature.EVEN
    return effect.stage is SignalStage.SENSOR and not effect.parameters.nonlinear and not shifted


def has_hidden_state(effect: Effect) -> bool:
    """Whether no run can begin with it in the middle of a recording; behind a spring no sensor looks."""
    return effect.search.hidden_state or isinstance(effect, Compliance)


def is_spring(effect: Effect) -> bool:
    """Whether it is a spring behind an axis, several of which are fitted to the torque together."""
    return isinstance(effect, Compliance) and effect.spring


def diverges(effect: Effect) -> bool:
    """Whether runs of nearly the same machine part, so that a fit of runs adds nothing."""
    return isinstance(effect, Compliance) and effect.diverges


def is_additive(effect: Effect) -> bool:
    """Whether what a model states of it and what is found of it are one effect, of their sum."""
    of_links = isinstance(effect, Structural) or isinstance(effect.corrects, OfBody)
    return of_links and bool(effect.parameters)


def free_parameters(effect: Effect, model: Model) -> int:
    """Number of parameters that the data have to determine in this model."""
    return effect.free(model) if isinstance(effect, Structural) else len(effect.parameters)
