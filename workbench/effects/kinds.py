"""Properties of an effect for the diagnosis: how it is fitted, tried and seen."""

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
    """Return 0 for simple effects, 1 for refinements that are tried after them.

    A refinement contains another effect, gives way, or has a size and a shape.
    """
    if effect.search.tier is not None:
        return effect.search.tier
    sized = bool(effect.parameters.linear and effect.parameters.nonlinear)
    return int(sized or bool(effect.search.contains) or isinstance(effect, Compliance))


def depends_on(effect: Effect) -> tuple[str, ...]:
    """Return the quantities of its axis on which its torque depends; for friction, the speed."""
    return (*(("speed",) if effect.stage is SignalStage.FRICTION else ()), *effect.search.depends_on)


def shared_by_design(effect: Effect) -> bool:
    """Return whether all axes may have it in the same way, as friction and limits of equal drives."""
    usual = effect.stage in (SignalStage.COMMAND, SignalStage.FRICTION)
    return bool(effect.locations) and (usual or effect.search.shared_by_design)


def is_dry(effect: Effect) -> bool:
    """Return whether it has stiction, so that the sliding speed of the model matters."""
    return SLIDING_SPEED in effect.parameters.settles


def is_pure_delay(effect: Effect) -> bool:
    """Return whether an effect is only a delay or a lag."""
    return effect.search.frf_signature is FrfSignature.DELAY and len(effect.parameters) == 1


def late_alike(effect: Effect, effects: Iterable[Effect]) -> tuple[str, ...]:
    """Return other delays of the complete machine that a log without measured torque cannot distinguish from
    this one.
    """
    if not is_pure_delay(effect) or effect.locations:
        return ()
    return tuple(e.name for e in effects if e is not effect and is_pure_delay(e) and not e.locations)


def by_finite_difference(effect: Effect) -> bool:
    """Return whether a fit has to compute its derivatives by simulation.

    Without a linear coefficient no column is exact near parameters that do something, unless the motion
    before the effect is known.
    """
    p = effect.parameters
    return bool(p.nonlinear) and not p.linear and type(effect).before is Effect.before


def on_links(effect: Effect) -> bool:
    """Return whether it acts on links, which a spring or a gap may separate from the motors."""
    alone = effect.locations and depends_on(effect)  # a torque on one axis, which its place says
    return (
        effect.stage is SignalStage.MECHANISM and not isinstance(effect, Compliance | OnGround) and not alone
    )


def changes_foot_position(effect: Effect) -> bool:
    """Return whether it changes the position of a foot at the same encoder readings, as a link length
    does.
    """
    return on_links(effect) and any(p.unit == "m" for p in effect.parameters)


def of_mass(effect: Effect) -> bool:
    """Return whether it changes the weight of links, and not how they move."""
    return on_links(effect) and not (isinstance(effect, Structural) or changes_foot_position(effect))


def bends_reading(effect: Effect) -> bool:
    """Return whether a sensor reads its angle on a different scale, not only shifted or late.

    Of no motion but that of gravity, this is a spring of another law.
    """
    shifted = effect.search.frf_signature is FrfSignature.EVEN
    return effect.stage is SignalStage.SENSOR and not effect.parameters.nonlinear and not shifted


def has_hidden_state(effect: Effect) -> bool:
    """Return whether it has a state that no sensor shows, so that no run can start in the middle of a
    recording.
    """
    return effect.search.hidden_state or isinstance(effect, Compliance)


def is_spring(effect: Effect) -> bool:
    """Return whether it is a spring behind an axis; several of these are fitted to the torque together."""
    return isinstance(effect, Compliance) and effect.spring


def diverges(effect: Effect) -> bool:
    """Return whether trajectories diverge for small parameter changes, so that a fit of runs adds nothing."""
    return isinstance(effect, Compliance) and effect.diverges


def is_additive(effect: Effect) -> bool:
    """Return whether the stated and the found part are one effect with the sum of both values."""
    of_links = isinstance(effect, Structural) or isinstance(effect.corrects, OfBody)
    return of_links and bool(effect.parameters)


def free_parameters(effect: Effect, model: Model) -> int:
    """Return the number of parameters that the data have to determine in this model."""
    if isinstance(effect, Structural):
        return effect.free(model)
    return sum(not p.optional for p in effect.parameters)
