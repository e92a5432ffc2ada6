"""Inertia, damping and delay of a drive from its torque-to-velocity response (paper, Sec. IV-A)."""

from __future__ import annotations

import numpy as np

from workbench.core import InputError
from workbench.core.text import counted
from workbench.frf.response import Frf
from workbench.frf.sampled import System, second_order

from .fit import Fit, Parameter, Problem, solve

_STARTS = 4
_LONGEST = 0.03  # delay that is looked for [s]


def fit_actuator(frf: Frf) -> Fit:
    """Fit exp(-s T) / (J s + B), the torque-to-velocity response of a drive.

    From the torque *command*, T is the delay of the command path. From the *measured* torque, which lies
    behind that delay, T is only what lies between torque sensor and motion (about zero), and says so in the
    notes. The hold of a sampled command is part of the model.

    Args:
        frf: one input (a torque), one output (velocity or position) of one axis; see `Frf.select`.

    Returns:
        Parameters ``inertia`` [kg m^2 or kg], ``damping`` [N m s/rad or N s/m], ``delay`` [s].

    Raises:
        InputError: a response of another shape or other signals.
    """
    if frf.response.shape[1:] != (1, 1):
        raise InputError(
            f"the response has {counted(len(frf.outputs), 'output')} and {counted(len(frf.inputs), 'input')}",
            remedy="select one axis, or fit the leg",
        )
    moves = motion_of(frf)
    least = 0.0 if frf.inputs[0].signal != "torque_measured" else -2.0 / frf.rate_hz
    linear = frf.inputs[0].unit == "N"
    parameters = (
        Parameter("inertia", "kg" if linear else "kg m^2", 1e-12),
        Parameter("damping", "N s/m" if linear else "N m s/rad", 0.0),
        Parameter("delay", "s", least, _LONGEST),
    )
    zero = np.zeros((1, 1))
    rows = np.array([[0.0, 1.0]] if moves == "velocity" else [[1.0, 0.0]])

    def system(theta: np.ndarray) -> System:
        if moves == "velocity":  # without the position no state integrates
            one = np.ones((1, 1))
            return System(-one * theta[1] / theta[0], one / theta[0], one, theta[2])
        return second_order(theta[0] * np.eye(1), theta[1] * np.eye(1), zero, theta[2], rows)

    notes = ()
    if frf.inputs[0].signal == "torque_measured":
        notes = ("The torque was measured after the command's delay, so 'delay' does not include it.",)
    starts = [np.array([*np.maximum(x, 1e-6), delay]) for x, delay in _starts(frf, moves, least, _LONGEST)]
    return solve(Problem("actuator", parameters, (frf,), (system,), starts, notes))


def motion_of(frf: Frf) -> str:
    """``"velocity"`` or ``"position"``.

    Raises:
        InputError: outputs of another kind, or an input that is no torque.
    """
    signals = {c.signal for c in frf.outputs}
    if signals not in ({"velocity"}, {"position"}) or not frf.inputs[0].signal.startswith("torque"):
        raise InputError(
            f"a response from {frf.inputs[0].signal} to {', '.join(sorted(signals))} is not one to fit here",
            remedy="take the response from torque_command (or torque_measured) to velocity or position",
        )
    return signals.pop()


def delays(low: float, high: float, omega: np.ndarray) -> np.ndarray:
    """Delays to try, close enough that no phase wraps between two of them."""
    return np.linspace(low, high, int(np.clip(np.ceil((high - low) * omega[-1] / 0.5), 8, 200)))


def to_velocity(frf: Frf, moves: str) -> np.ndarray:
    """Return the response's velocity per torque, roughly, half a hold earlier, (F, ny, nu)."""
    early = np.exp(0.5j * frf.omega * (frf.hold_s or 0.0))[:, None, None]
    return frf.response * early * (1j * frf.omega[:, None, None] if moves == "position" else 1.0)


def _starts(frf: Frf, moves: str, low: float, high: float) -> list[tuple[np.ndarray, float]]:
    """Best (inertia, damping) and delay over a grid of delays: for a given delay 1 / G is linear in both."""
    g = to_velocity(frf, moves)[:, 0, 0]
    weight = np.abs(g) / np.maximum(frf.std[:, 0, 0] / np.abs(frf.response[:, 0, 0]), 1e-6)
    columns = np.stack([1j * frf.omega, np.ones(len(frf))], axis=1) * weight[:, None]
    real = np.concatenate([columns.real, columns.imag])
    found = []
    for delay in delays(low, high, frf.omega):
        wanted = weight * np.exp(-1j * frf.omega * delay) / g
        right = np.concatenate([wanted.real, wanted.imag])
        x, *_ = np.linalg.lstsq(real, right, rcond=None)
        found.append((float(np.sum((real @ x - right) ** 2)), x, float(delay)))
    return [(x, delay) for _, x, delay in sorted(found, key=lambda f: f[0])[:_STARTS]]
