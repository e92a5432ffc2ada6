"""Two inertias on a flexible coupling: resonance, anti-resonance, damping."""

from __future__ import annotations

import numpy as np

from workbench.core import AXIS_SIGNALS, Estimate, InputError
from workbench.frf.response import Frf
from workbench.frf.sampled import System, second_order
from workbench.identification.fit import Fit, Parameter, Problem, solve

_LONGEST = 0.01  # delay that is looked for [s]; half a hold or a sensor's lag may make it negative
_OUTPUTS = {  # row over (q_motor, q_load, w_motor, w_load)
    "position": (1.0, 0.0, 0.0, 0.0),
    "link_position": (0.0, 1.0, 0.0, 0.0),
    "velocity": (0.0, 0.0, 1.0, 0.0),
}

_DERIVED = {  # of the parameters, in their order: function and unit
    "antiresonance_hz": (lambda t: np.sqrt(t[2] / t[1]) / (2 * np.pi), "Hz"),
    "resonance_hz": (lambda t: np.sqrt(t[2] * (1 / t[0] + 1 / t[1])) / (2 * np.pi), "Hz"),
    "inertia_ratio": (lambda t: t[1] / t[0], "1"),
}


def fit_two_mass(frf: Frf) -> Fit:
    """Fit a motor and a load on a spring, driven at the motor.

        J_m q_m'' + b_m q_m' + c (q_m' - q_l') + k (q_m - q_l) = u(t - T)
        J_l q_l'' + b_l q_l' + c (q_l' - q_m') + k (q_l - q_m) = 0

    Seen from the motor it has an anti-resonance at sqrt(k / J_l) and a resonance at
    sqrt(k (1 / J_m + 1 / J_l)); their ratio gives J_l / J_m whatever the unit of the input. With a current as
    input all mechanical parameters are per torque constant. D. Schroeder and J. Boecker, "Electrical Drives:
    Control", ch. on elastic drives.

    Args:
        frf: one input (torque, current or voltage); outputs ``position`` or ``velocity`` of the motor and,
            where it was measured, ``link_position``.

    Returns:
        Parameters ``inertia_motor``, ``inertia_load``, ``stiffness``, ``damping_coupling``,
        ``damping_motor``, ``damping_load``, ``delay``.

    Raises:
        InputError: other signals, or no motor signal among the outputs.
    """
    signals = [c.signal for c in frf.outputs]
    axes = {c.axis for c in (*frf.outputs, *frf.inputs)}
    if len(frf.inputs) != 1 or len(axes) != 1 or any(s not in _OUTPUTS for s in signals):
        raise InputError(
            f"a response from {', '.join(map(str, frf.inputs))} to {', '.join(map(str, frf.outputs))}",
            remedy="give one axis: its torque or current to position or velocity (and link_position)",
        )
    motor = next((k for k, s in enumerate(signals) if s != "link_position"), None)
    if motor is None:
        raise InputError(
            "the load's position alone shows no anti-resonance",
            remedy="estimate with the motor's position or velocity as well",
        )
    push = frf.inputs[0].unit
    linear = frf.outputs[motor].unit in ("m", "m/s")
    angle = "m" if linear else "rad"
    assert frf.inputs[0].signal in AXIS_SIGNALS
    kg = {"N m": "kg m^2", "N": "kg"}.get(push, f"{push} s^2/{angle}")
    least = -2.0 / frf.rate_hz
    parameters = (
        Parameter("inertia_motor", kg, 1e-15),
        Parameter("inertia_load", kg, 1e-15),
        Parameter("stiffness", f"{push}/{angle}", 1e-15),
        Parameter("damping_coupling", f"{push} s/{angle}", 0.0),
        Parameter("damping_motor", f"{push} s/{angle}", 0.0),
        Parameter("damping_load", f"{push} s/{angle}", 0.0),
        Parameter("delay", "s", least, _LONGEST),
    )
    rows = np.array([_OUTPUTS[s] for s in signals])

    def system(theta: np.ndarray) -> System:
        jm, jl, k, c, bm, bl, delay = theta
        spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
        damping = c * spring + np.diag(np.array([bm, bl]))
        both = second_order(np.diag(np.array([jm, jl])), damping, k * spring, delay, rows)
        return System(both.a, both.b[:, :1], both.c, both.delay)

    starts = _starts(frf, motor, signals[motor], least, _LONGEST)
    return solve(Problem("two_mass", parameters, (frf,), (system,), starts))


def two_mass_numbers(fit: Fit) -> dict[str, Estimate]:
    """Return ``antiresonance_hz``, ``resonance_hz`` and ``inertia_ratio`` of a fit, by the delta method."""
    theta = np.array([e.value for e in fit.parameters.values()])
    out = {}
    for name, (function, unit) in _DERIVED.items():
        slope = np.array([np.imag(function(theta + 1e-25j * e)) / 1e-25 for e in np.eye(len(theta))])
        deviation = float(np.sqrt(max(slope @ fit.covariance @ slope, 0.0)))
        out[name] = Estimate(float(np.real(function(theta))), deviation, unit)
    return out


def _starts(frf: Frf, motor: int, signal: str, low: float, high: float) -> list[np.ndarray]:
    """From where the motor's acceleration is smallest and, above that, largest."""
    power = 1 if signal == "velocity" else 2
    acceleration = np.abs(frf.response[:, motor, 0]) * frf.omega**power
    inner = slice(1, -1) if len(frf) > 4 else slice(None)
    places = np.arange(len(frf))[inner]
    # the pair is where the response climbs most from a minimum to a later maximum
    climb = np.maximum.accumulate(acceleration[inner][::-1])[::-1] / acceleration[inner]
    dip = places[int(np.argmax(climb))]
    top = dip + int(np.argmax(acceleration[dip:]))
    w_a, w_r = frf.omega[dip], max(frf.omega[top], 1.02 * frf.omega[dip])
    ratio = (w_r / w_a) ** 2 - 1
    # below the pair both inertias move as one, far above it the motor's alone
    rigid = 1.0 / np.median(acceleration[: max(dip // 2, 1)])
    alone = 1.0 / np.median(acceleration[-max((len(frf) - top) // 4, 1) :])
    starts = []
    for jm in (rigid / (1 + ratio), alone):
        jl = ratio * jm
        k = jl * w_a**2
        for damping in (0.01, 0.05):
            for delay in (0.0, 0.5 * high, max(low, -0.25 / frf.rate_hz)):
                c = 2 * damping * np.sqrt(k * jl)
                starts.append(np.array([jm, jl, k, c, 0.1 * c, 0.1 * c, delay]))
    return starts
