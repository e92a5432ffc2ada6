"""Numbers of a model that an effect corrects: the value in the model, and its place in the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from workbench.models import (
    AppliedEffect,
    BodyNumbers,
    JointNumber,
    Model,
    Placement,
    drive_tendons,
    own_friction,
    turned_joint,
)

#: What a model has of a number in a place, with what was added to it.
Own = Callable[[Model, Placement], float]


@dataclass(frozen=True)
class AtJoint:
    """A number of a joint, or of a tendon that is a drive.

    Attributes:
        number: as MJCF calls it.
        parameter: the effect's, added to it; `rest`: another one that says where a spring rests.
        own: None where a model is not known to have one.
        power: of the ratio between axis and joint, by which it is turned.
        called: what a person calls it; empty where an effect is missing, rather than a number wrong.
    """

    number: str
    parameter: str
    own: Own | None = None
    power: int = 2
    rest: str = ""
    called: str = ""

    def told_by(self, values: Mapping[str, float]) -> AtJoint:
        """Return itself, whatever the values."""
        del values
        return self

    def in_file(self, model: Model, place: Placement, values: Mapping[str, float]) -> JointNumber | None:
        """Return the number in the model's MJCF or URDF that holds this; None if there is none."""
        turned, more = turned_joint(model, place), values[self.parameter]
        if turned is not None:
            joint, ratio = turned
            rest = values[self.rest] / ratio if self.rest else 0.0
            return JointNumber(joint, self.number, more * abs(ratio) ** self.power, rest)
        seats = [s for s in drive_tendons(model) if s.index == place.index and s.name]
        if place.location != "actuator" or self.rest or not seats:
            return None
        more /= abs(seats[0].ratio) ** self.power
        return JointNumber(seats[0].name, self.number, more, element="tendon")


@dataclass(frozen=True)
class OfBody:
    """The mass, centre or inertia of a link's body; `own`, `parameter` and `called` as in `AtJoint`.

    `special`: another number that is wrong where a parameter that may be left out is there, by its name.
    """

    own: Own | None = None
    parameter: str = ""
    called: str = ""
    special: Mapping[str, OfBody] = field(default_factory=dict)

    def told_by(self, values: Mapping[str, float]) -> OfBody:
        """Return the number that is wrong if an effect has these values."""
        return next((number for name, number in self.special.items() if name in values), self)

    def in_file(self, model: Model, place: Placement, values: Mapping[str, float]) -> BodyNumbers | None:
        """Return the numbers in the model's MJCF or URDF that hold this; none if they are in the file of the
        closed chain.
        """
        del values
        closed = model.posture_dependent or model.carried
        return None if closed else BodyNumbers(model.joints[place.index])


def there(
    effect: str, model: Model, place: Placement, beside: Sequence[AppliedEffect] = ()
) -> list[dict[str, float]]:
    """Return values of each effect of this name that a model has in this place, and of those `beside`
    them.
    """
    where = effect, model.axes[place.index], place.location
    known = (*beside, *model.effects)
    return [e.values for e in known if (e.key.effect, e.key.axis, e.key.location) == where]


def added(effect: str, parameter: str, model: Model, place: Placement) -> float:
    """Return the sum of the effects of a model in this place."""
    return sum(values[parameter] for values in there(effect, model, place))


def own_dry_friction(model: Model, place: Placement) -> float:
    """Return ``frictionloss`` [N m or N] that the file of a model states in a place, and what was added."""
    return sum(v["torque"] for v in there("coulomb_friction", model, place, own_friction(model)))


def down_to(most: Own) -> Callable[[Model, Placement], tuple[float, float]]:
    """Return bounds of a correction that may remove at most so much of a number."""
    return lambda model, place: (-most(model, place), float("inf"))
