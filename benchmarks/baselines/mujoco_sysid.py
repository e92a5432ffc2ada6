"""MuJoCo's own system identification on recordings of the leg: from measured torque to position.

Its optimiser, residual and intervals are used as they come. It fits parameters of a structure that it is
given, and says nothing of others: named is every parameter that moved by more than its interval, which
supposes white residuals and is narrow, and by as much as matters.
Needs ``pip install 'mujoco[sysid]'``.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any

import mujoco
import numpy as np
from exam.answers import Answer, Named

from workbench.core import EffectKey, Estimate, InputError, Recording
from workbench.effects import load_model
from workbench.s3n import normalise

#: Where MuJoCo keeps armature, damping and frictionloss: element kind, name, and the place that it is.
HIP, KNEE, KNEE_JOINT = ("joint", "hip"), ("tendon", "knee"), ("joint", "knee")
#: The catalogue's names of what these parameters are.
EFFECTS = {
    "armature": ("reflected_inertia", "inertia"),
    "damping": ("viscous_damping", "damping"),
    "frictionloss": ("coulomb_friction", "torque"),
}
#: Moves that matter: of armature and damping as a share of nominal, of dry friction in N m.
_MATTERS = {"armature": 0.05, "damping": 0.05, "frictionloss": 0.02}
_MOST = {"armature": 0.1, "damping": 2.0, "frictionloss": 3.0}
Place = tuple[str, str]
#: Two axes' armature, damping and dry friction.
SIX = tuple((place, name) for place in (HIP, KNEE) for name in EFFECTS)
#: And damping and friction of the pin between the links.
EIGHT = (*SIX, (KNEE_JOINT, "damping"), (KNEE_JOINT, "frictionloss"))


@dataclass(frozen=True)
class Fit:
    """What system identification gave.

    Attributes:
        values: parameter -> nominal value, fitted value, half width of its interval.
        residual: root mean square of its own normalised residual, before and after.
    """

    values: dict[tuple[Place, str], tuple[float, float, float]]
    residual: tuple[float, float]


def identify_everything(recordings: Sequence[Recording]) -> Answer:
    """Fits `EIGHT` and names what moved, farthest beyond its interval first."""
    return answer_of_fit(identify(recordings, EIGHT))


def answer_of_fit(fit: Fit, only_moved: bool = True) -> Answer:
    """Parameters that moved, by more than their interval and as much as matters, or all; farthest first."""
    moved = {p: abs(value - nominal) / max(half, 1e-300) for p, (nominal, value, half) in fit.values.items()}
    named = []
    for place, name in sorted(moved, key=lambda p: -moved[p]):
        nominal, value, half = fit.values[place, name]
        matters = _MATTERS[name] * (nominal or 1.0)
        if only_moved and abs(value - nominal) <= max(half, matters):
            continue
        effect, key = EFFECTS[name]
        location = "joint" if place == KNEE_JOINT else "actuator"
        estimate = Estimate(value - nominal, half / 1.96, "")
        named.append(Named(EffectKey(effect, place[1], location), {key: estimate}))
    return Answer("missing_effect", tuple(named)) if named else Answer("consistent")


def identify(
    recordings: Sequence[Recording], parameters: Sequence[tuple[Place, str]], integrator: str = "implicitfast"
) -> Fit:
    """Fits parameters of the nominal leg with the toolbox's own defaults.

    Args:
        recordings: at rest in the beginning, with measured torque.
        parameters: place and name of each.
        integrator: of MuJoCo. RK4 takes several times as long as implicitfast and fits no better here.

    Raises:
        InputError: the toolbox is not installed.
    """
    sysid = _toolbox()
    spec = leg_spec(integrator)
    wanted = sysid.ParameterDict()
    for place, name in parameters:
        nominal = _get(spec, place, name)
        wanted.add(
            sysid.Parameter(
                f"{place[0]}_{place[1]}_{name}",
                nominal=nominal,
                min_value=0.0,
                max_value=_MOST[name],
                modifier=lambda s, p, place=place, name=name: _set(s, place, name, float(p.value[0])),
            )
        )
    model = spec.compile()
    sequences = sysid.ModelSequences(
        "leg",
        spec,
        [r.name for r in recordings],
        [_start(sysid, model, r) for r in recordings],
        [sysid.TimeSeries(r.time, np.array(r.signals["torque_measured"])) for r in recordings],
        [_measured(sysid, model, r) for r in recordings],
        allow_missing_sensors=True,
    )
    residual = sysid.build_residual_fn(models_sequences=[sequences])

    def stacked(params: Any) -> np.ndarray:
        return np.concatenate([np.ravel(r) for r in residual(params.as_vector(), params)[0]])

    nominal = wanted.as_vector().copy()
    before = stacked(wanted)
    with redirect_stdout(StringIO()):  # it tells of every step
        fitted, result = sysid.optimize(wanted, residual, verbose=False)
    after = stacked(fitted)
    _, half = sysid.calculate_intervals([after], np.asarray(result.jac))
    values = zip(nominal, fitted.as_vector(), half, strict=True)
    return Fit(
        {p: (float(n), float(v), float(h)) for p, (n, v, h) in zip(parameters, values, strict=True)},
        (float(np.sqrt(np.mean(before**2))), float(np.sqrt(np.mean(after**2)))),
    )


def leg_spec(integrator: str) -> mujoco.MjSpec:
    """The nominal leg as plain MJCF, torque in and motion out with no delay between."""
    spec = mujoco.MjSpec.from_string(normalise(load_model("leg"), integrator=integrator).xml)
    for actuator in spec.actuators:
        actuator.delay, actuator.nsample = 0.0, 0
    return spec


def _toolbox() -> Any:
    from mujoco import sysid

    if not hasattr(sysid, "optimize"):
        raise InputError(
            "MuJoCo's system identification is not installed", remedy="pip install 'mujoco[sysid]'"
        )
    return sysid


def _start(sysid: Any, model: mujoco.MjModel, recording: Recording) -> np.ndarray:
    q1, q2 = recording.position[0]
    return sysid.create_initial_state(model, np.array([q1, q2 - q1]), np.zeros(2))


def _measured(sysid: Any, model: mujoco.MjModel, recording: Recording) -> Any:
    """Positions as observations of the state: sensors are stamped a step late, which looks like inertia."""
    joints = recording.position @ np.array([[1.0, -1.0], [0.0, 1.0]])
    return sysid.TimeSeries(recording.time, joints, sysid.TimeSeries.compute_all_state_mappings(model)[0])


def _element(spec: mujoco.MjSpec, place: Place) -> Any:
    return getattr(spec, place[0])(place[1])


def _get(spec: mujoco.MjSpec, place: Place, name: str) -> float:
    return float(np.ravel(getattr(_element(spec, place), name))[0])


def _set(spec: mujoco.MjSpec, place: Place, name: str, value: float) -> None:
    element = _element(spec, place)
    old = getattr(element, name)
    polynomial = np.ndim(old) > 0  # in speed, of which only the first is meant
    setattr(element, name, np.array([value, *np.ravel(old)[1:]]) if polynomial else value)
