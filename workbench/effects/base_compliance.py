"""A fixture under the machine that moves with the machine's forces."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import mujoco
import numpy as np

from workbench.core import EffectKey, SimulationError
from workbench.models import Model

from .base import WHOLE, FrfSignature, Search, Words
from .chain import Build
from .compliance import Compliance
from .flexible import free_wind, frequencies, spring_wind
from .lacking import Lack, refined, share_left
from .motion import Motion
from .parameter import Chart, Parameter, Parameters, Place, Unknown, Values
from .response import Response

BASE_JOINT = "base:x"
_NONE = np.zeros(0)


def _known(name: str, values: Values, position: float, torque: float) -> float:
    """A fourteenth: how well a tree knows what its machine weighs sideways (see `weights`)."""
    return values[name] / 14.0


def _values(coefficients: np.ndarray, shape: Values) -> dict[str, float]:
    """Stiffness and damping of what rings at this rate with this share of critical damping."""
    rate, mass = shape["rate"], shape["mass"]
    damping = 2.0 * shape["share"] * mass * rate
    return {"stiffness": mass * rate**2, "damping": damping, "mass": mass}


def _solved(values: Values) -> tuple[np.ndarray, dict[str, float]]:
    """Rate and share of the fixture without the machine."""
    mass, rate = values["mass"], float(np.sqrt(values["stiffness"] / values["mass"]))
    return _NONE, {"rate": rate, "share": values["damping"] / (2.0 * mass * rate), "mass": mass}


#: rate^2 = k / m, share = d / (2 sqrt(k m)): what shows each by itself, of a fixture that rings, not creeps.
_RINGING = Chart(
    (
        Unknown(
            "rate",
            linear=False,
            lower=0.1,
            upper=1e5,
            reach=lambda shape: 0.2 * shape["rate"],
            least=lambda shape: 1e-6 * shape["rate"],
        ),
        Unknown(
            "share", linear=False, upper=5.0, reach=lambda shape: max(0.5 * shape["share"], 0.02), least=1e-3
        ),
        Unknown(
            "mass",
            linear=False,
            lower=1e-3,
            reach=lambda shape: 0.5 * shape["mass"],
            least=lambda shape: 1e-6 * shape["mass"],
        ),
    ),
    _values,
    _solved,
)


class BaseCompliance(Compliance):
    """mass x'' + damping x' + stiffness x = force of the machine on its base along x; both move together."""

    name = "base_compliance"
    parameters = Parameters(
        Parameter("stiffness", "N/m", lower=1e-3, example=4000.0, blur=partial(_known, "stiffness")),
        Parameter("damping", "N*s/m", example=20.0, blur=partial(_known, "damping")),
        Parameter(
            "mass",
            "kg",
            lower=1e-3,
            example=10.0,
            blur=partial(_known, "mass"),
            about="of the moving part of the fixture, without the machine",
        ),
        chart=_RINGING,
    )
    locations = WHOLE
    words = Words(
        source="Newton's law for a base on a spring; Ott et al., Base force feedback, IROS 2006",
        shows="torque residual at one frequency on all axes that push the base sideways; FRF peaks in common",
        reveal="chirps of each axis through the fixture's resonance, and an accelerometer on the base",
        mujoco="native: a slide joint with stiffness and damping between world and base",
    )
    search = Search(frf_signature=FrfSignature.RESONANCE)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Once."""
        return not model.has(self.name)

    def initial_values(
        self, motions: Sequence[Motion], model: Model, place: Place
    ) -> Sequence[tuple[Values, float]]:
        """What the lacking torque asks for, from resonances from 2 Hz on, of fixtures light and heavy."""
        machine, starts = motions[0].momentum()[1], []
        for together in frequencies(motions, 2.0, 80.0, 12):
            for mass in machine * np.array([0.5, 3.0, 20.0]):
                total = mass + machine
                starts.append((total * together**2, 0.1 * total * together, mass))
        made = [Lack.of(m, model, *_push(m)) for m in motions]

        def left(values: np.ndarray) -> np.ndarray:
            stiffness, damping, mass = values
            total = float(mass + machine)
            answers = [spring_wind(x.load, x.step, total, stiffness, damping) for x in made]
            return np.concatenate([x.left(answer) for x, answer in zip(made, answers, strict=True)])

        found = refined(left, starts)
        values = dict(zip((p.name for p in self.parameters), map(float, found), strict=True))
        return [(_solved(values)[1], share_left(made, left(found)))]

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: what the base's acceleration makes the links feel."""
        recoil = _recoil(motion, _values(_NONE, shape))
        return Response(np.zeros((0, *motion.position.shape)), offset=recoil)

    def free_responses(self, motion: Motion, model: Model, place: Place, shape: Values) -> np.ndarray:
        """How a base swings out that was away from its rest, or moving, at the first row."""
        values, (_, column) = _values(_NONE, shape), _push(motion)
        total = values["mass"] + motion.momentum()[1]
        sway = free_wind(len(column), motion.step, total, values["stiffness"], values["damping"])
        return column[:, :, None] * sway[:, None, :]

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """A slide with the fixture's mass, before the first joint of the body that stands on the ground."""
        root = _root(build.spec, model)
        _put_first(build, root, values["mass"])
        build.rows[BASE_JOINT] = {BASE_JOINT: 1.0}
        spring = build.spec.add_tendon(name=BASE_JOINT)
        spring.wrap_joint(BASE_JOINT, 1.0)
        spring.stiffness[0], spring.damping[0] = values["stiffness"], values["damping"]
        spring.springlength = np.zeros(2)


def _root(spec: mujoco.MjSpec, model: Model) -> mujoco.MjsBody:
    """The one body on the ground that carries all joints.

    Raises:
        SimulationError: there are several.
    """
    roots = [b for b in spec.worldbody.bodies if not b.name.startswith("rotor:")]
    moving = [b for b in roots if b.joints or b.find_all("joint")]
    if len(moving) != 1:
        raise SimulationError(f"model '{model.name}' stands on the ground with {len(moving)} bodies, not one")
    return moving[0]


def _put_first(build: Build, body: mujoco.MjsBody, mass: float) -> None:
    """Give a body a slide along x before its other joints, made anew; before anything sits on tendons."""
    for tendon in build.rows:
        build.spec.delete(build.spec.tendon(tendon))
    kept = [{key: getattr(joint, key) for key in _JOINT} for joint in body.joints]
    kept = [{k: np.copy(v) if isinstance(v, np.ndarray) else v for k, v in each.items()} for each in kept]
    for joint in list(body.joints):
        build.spec.delete(joint)
    axis = np.zeros(3)
    inverse = np.zeros(4)
    mujoco.mju_negQuat(inverse, np.asarray(body.quat, float))
    mujoco.mju_rotVecQuat(axis, np.array([1.0, 0.0, 0.0]), inverse)
    body.add_joint(name=BASE_JOINT, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis, armature=mass)
    body.simple = 0  # MuJoCo takes slides of one body for perpendicular where it may
    for each in kept:
        body.add_joint(**each)
    for tendon, row in build.rows.items():
        fresh = build.spec.add_tendon(name=tendon)
        for joint, coefficient in row.items():
            fresh.wrap_joint(joint, coefficient)


#: What a joint is made of.
_JOINT = (
    "name", "type", "pos", "axis", "ref", "stiffness", "springref", "springyield", "springdamper", "limited",
    "range", "margin", "solref_limit", "solimp_limit", "actfrclimited", "actfrcrange", "armature", "damping",
    "frictionloss", "solref_friction", "solimp_friction", "group", "actgravcomp", "userdata",
)  # fmt: skip


def _push(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Force (N,) on a base that stands, and what the drives feel of each unit of its acceleration, (N, n)."""
    sideways = motion.momentum()[0][:, 0]
    return -np.gradient(np.einsum("ki,ki->k", sideways, motion.velocity), motion.step), -sideways


def _recoil(motion: Motion, values: Values) -> np.ndarray:
    """Torque (N, n) that the links feel as the base gives way to their motion."""
    push, column = _push(motion)
    total = values["mass"] + motion.momentum()[1]
    moved = spring_wind(push - push[0], motion.step, total, values["stiffness"], values["damping"])
    return column * moved[:, None]
