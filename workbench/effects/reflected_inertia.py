"""More rotor inertia behind the gear than the model has."""

from __future__ import annotations

from workbench.models import Model, Placement, rotors

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .corrected import AtJoint, added, down_to
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response, single


def _own(model: Model, place: Placement) -> float:
    """What the model states of the drive's own, and what was added."""
    own = float(rotors(model)[0][place.index])
    return own + added("reflected_inertia", "inertia", model, place)


def _most_less(model: Model, place: Placement) -> float:
    """The drive's own may turn out smaller than stated, but stays above a tenth of it in all."""
    own = rotors(model)[0][place.index]
    return max(0.9 * own + added("reflected_inertia", "inertia", model, place), 0.0)


class ReflectedInertia(Effect):
    """torque = -inertia * a at the drive; a rotor J_m behind a gear N has N^2 J_m (paper, Eq. 7)."""

    name = "reflected_inertia"
    parameters = Parameters(
        Parameter(
            "inertia", "kg*m^2", about="added to what the model has", within=down_to(_most_less), example=0.01
        )
    )
    stage = SignalStage.MECHANISM
    corrects = AtJoint("armature", "inertia", _own, called="rotor inertia")
    words = Words(
        source="paper, Eqs. 7 and 9",
        shows="torque residual proportional to the drive's acceleration; FRF magnitude is wrong at high "
        "frequency",
        reveal="a fast chirp of this axis about one posture, the other axes held",
        mujoco="native: armature of the axis's tendon",
    )
    search = Search(depends_on=("acceleration",), basic=True, shared_by_design=True)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus the acceleration."""
        _, _, acceleration = motion.along(place)
        return Response(single(place, -acceleration, motion)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Armature of the tendon; what is less than that has, of the joint that holds the rotor."""
        tendon = build.spec.tendon(place.tendon)
        whole = tendon.armature + values["inertia"]
        tendon.armature = max(whole, 0.0)
        if whole < 0.0:  # MuJoCo has no negative armature
            name, ratio = _holder(build, model, place)
            joint = build.spec.joint(name)
            joint.armature = max(joint.armature + whole * ratio**2, 0.0)


def _holder(build: Build, model: Model, place: Placement) -> tuple[str, float]:
    """Joint that holds a drive's rotor, and how far the rotor turns with it: its own, or the serial one."""
    turned = build.rows[place.tendon]
    return next(iter(turned.items())) if len(turned) == 1 else (model.joints[place.index], 1.0)
