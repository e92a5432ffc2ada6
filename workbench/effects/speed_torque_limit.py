"""A drive whose torque falls with speed, as back-EMF eats its voltage."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import minimize

from workbench.core import EffectKey
from workbench.core.compiled import compiled
from workbench.models import Model

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .motion import Motion, at_tap
from .parameter import Parameter, Parameters, Place, Values
from .response import Response
from .setting import FULL_BRAKING

_FLAT = 5.0  # times the fastest speed: a line that ends beyond hardly falls
_SIMPLEX = np.array([[0.0, 0.0], [0.05, 0.0], [0.0, 0.05]])  # in the logarithm of both


def _lines(motions: Sequence[Motion], model: Model, place: Place) -> Sequence[Values]:
    """Lines that cut something off; the likely one if the torque was measured."""
    asked, speed, measured = at_tap(motions, place.index)
    top, fast = float(np.abs(asked).max()) + 1e-9, float(np.abs(speed).max()) + 1e-9
    stalls, ends = (0.4, 0.6, 0.9, 1.3, 2.0), np.geomspace(0.4, 3.0, 6)
    if measured is not None:
        top = float(np.abs(measured).max()) + 1e-9
        stalls, ends = np.geomspace(0.3, 10.0, 24), np.geomspace(0.3, 20.0, 20)
    tried = [(top * s, fast * e) for s in stalls for e in ends]
    ways = [(s, v, braking) for braking in (False, True) for s, v in tried]
    if measured is not None:
        off = partial(_off, asked, speed, measured)
        ways = [_downhill(off, min(ways, key=lambda way: off(*way)))]
    return [
        {"stall_torque": float(s), "no_load_speed": float(v), "full_braking": float(b)} for s, v, b in ways
    ]


def _falls(motions: Sequence[Motion], place: Place, values: Values) -> bool:
    """Where the line falls steeply: a limit that was reached at one speed may be either's."""
    fastest = max(float(np.abs(m.velocity[:, place.index]).max()) for m in motions)
    return values["no_load_speed"] < _FLAT * fastest


def _shift(values: Values, position_noise: float, torque_noise: float) -> float:
    """A third of the noise at rest, all of it where the line falls."""
    share = torque_noise / values["stall_torque"]
    return share * values["no_load_speed"]


class SpeedTorqueLimit(Effect):
    """|torque| <= stall_torque * (1 - |w| / no_load_speed), zero beyond; the measured torque shows it.

    The same while braking, or |torque| <= stall_torque there if the drives have `full_braking`.
    """

    name = "speed_torque_limit"
    parameters = Parameters(
        Parameter(
            "stall_torque",
            "N*m",
            lower=1e-6,
            blur=lambda values, position, torque: 0.3 * torque,
            example=1.2,
            linear=False,
        ),
        Parameter("no_load_speed", "rad/s", lower=1e-6, blur=_shift, example=2.5, linear=False),
        starts=_lines,
        settles=(FULL_BRAKING,),
    )
    stage = SignalStage.COMMAND
    words = Words(
        source="torque-speed line of DC motors; Hughes, Electric Motors and Drives, Ch. 3",
        shows="measured torque has a ceiling that falls as speed rises",
        reveal="hard accelerations from rest up to the highest speed, in both directions",
        mujoco="torque function of the speed",
    )
    search = Search(differs=_falls, contains=("torque_saturation",))

    def applies(self, model: Model, key: EffectKey) -> bool:
        """Once a drive: two lines are no line."""
        return not model.has(self.name, key.axis)

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """No free coefficient: what the falling ceiling takes away."""
        stall, no_load = motion.line.stall.copy(), motion.line.no_load.copy()
        stall[place.index], no_load[place.index] = shape["stall_torque"], shape["no_load_speed"]
        full = bool(shape.get("full_braking", motion.line.full_braking))
        return Response.passed(motion, replace(motion.line, stall=stall, no_load=no_load, full_braking=full))

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """Line of the chain."""
        build.chain.stall[place.index] = values["stall_torque"]
        build.chain.no_load[place.index] = values["no_load_speed"]


@compiled(nogil=True)
def _off(
    asked: np.ndarray, speed: np.ndarray, measured: np.ndarray, stall: float, end: float, full: bool
) -> float:
    """Squared sum by which a line's torque is off a measured one; a thousand lines are asked."""
    total = 0.0
    for k in range(asked.size):
        left = stall
        if not full or asked[k] * speed[k] > 0.0:
            left = stall * max(1.0 - abs(speed[k]) / end, 0.0)
        total += (min(max(asked[k], -left), left) - measured[k]) ** 2
    return total


def _downhill(
    off: Callable[[float, float, bool], float], start: tuple[float, float, bool]
) -> tuple[float, float, bool]:
    """The line from which a measured torque is least off, from a start near it.

    Where a loop is at its limit for long, a start that is a per cent off leads a fit by simulation astray.
    """
    stall, end, full = start
    simplex = np.log([stall, end]) + _SIMPLEX
    found = minimize(
        lambda x: off(float(np.exp(x[0])), float(np.exp(x[1])), full),
        simplex[0],
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-5, "fatol": 0.0, "maxfev": 80},
    )
    return float(np.exp(found.x[0])), float(np.exp(found.x[1])), full
