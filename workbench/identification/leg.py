"""Total inertia of a parallel leg from its torque responses about several postures (paper, Sec. IV-B)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from workbench.core import InputError
from workbench.frf.response import Frf
from workbench.frf.sampled import System, second_order

from .actuator import delays, motion_of, to_velocity
from .fit import Fit, Parameter, Problem, solve

_STARTS = 3
_LONGEST = 0.03  # delay that is looked for [s]


def fit_leg(frfs: Frf | Sequence[Frf], *, transmission: np.ndarray | None = None) -> Fit:
    """Fit [[M11, M12 cos a], [M12 cos a, M22]] q'' + D q' + K q = tau(t - T) to all postures at once.

    In actuator coordinates: q1 the thigh's and q2 the shank's absolute angle from straight down,
    a = q2 - q1 (paper, Eq. 9), each taken from the mean measured position of its recordings. D is diagonal;
    K = diag(g1 cos q1, g2 cos q2) is what gravity adds about the posture. Velocity-dependent terms vanish
    about rest, and the hold of a sampled command is part of the model.

    Args:
        frfs: responses of both axes, 2 x 2, one per posture; M12 and the diagonal come apart wherever cos a
            is not zero.
        transmission: J of q_p = J q_s, (2, 2), for responses in joint coordinates.

    Returns:
        Parameters ``M11``, ``M12``, ``M22`` [kg m^2], ``damping_1``, ``damping_2`` [N m s/rad], ``delay``
        [s], and ``g1``, ``g2`` [N m].

    Raises:
        InputError: no response, one that is not 2 x 2, or joint coordinates without a transmission.
    """
    group = [frfs] if isinstance(frfs, Frf) else list(frfs)
    if not group:
        raise InputError("no responses given", remedy="estimate one per posture")
    group = [_in_actuator_coordinates(f, transmission) for f in group]
    moves = motion_of(group[0])
    # from a torque measured behind the delay, what is left may be slightly negative
    least = -2.0 / group[0].rate_hz if group[0].inputs[0].signal == "torque_measured" else 0.0
    parameters = (
        Parameter("M11", "kg m^2", 1e-12),
        Parameter("M12", "kg m^2"),
        Parameter("M22", "kg m^2", 1e-12),
        Parameter("damping_1", "N m s/rad", 0.0),
        Parameter("damping_2", "N m s/rad", 0.0),
        Parameter("delay", "s", least, _LONGEST),
        Parameter("g1", "N m"),
        Parameter("g2", "N m"),
    )
    one, zero = np.eye(2), np.zeros((2, 2))
    rows = np.concatenate([zero, one] if moves == "velocity" else [one, zero], axis=1)

    def system_at(frf: Frf) -> Callable[[np.ndarray], System]:
        mixed = np.cos(frf.posture[1] - frf.posture[0])
        pull = np.cos(np.array(frf.posture))

        def system(theta: np.ndarray) -> System:
            m11, m12, m22 = theta[0], theta[1] * mixed, theta[2]
            inertia = np.array([[m11, m12], [m12, m22]])
            return second_order(inertia, np.diag(theta[3:5]), np.diag(theta[6:8] * pull), theta[5], rows)

        return system

    starts = _starts(group, moves, least, _LONGEST)
    notes = ()
    if group[0].inputs[0].signal == "torque_measured":
        notes = ("The torque was measured after the command's delay, so 'delay' does not include it.",)
    systems = tuple(map(system_at, group))
    return solve(Problem("leg", parameters, tuple(group), systems, starts, notes))


def _in_actuator_coordinates(frf: Frf, transmission: np.ndarray | None) -> Frf:
    if frf.response.shape[1:] != (2, 2):
        raise InputError(
            f"the response has {frf.response.shape[1]} outputs and {frf.response.shape[2]} inputs",
            remedy="estimate both axes of the leg, with one output signal",
        )
    if frf.coordinates == "actuator":
        return frf
    if transmission is None:
        raise InputError(
            "the response is in joint coordinates", column="coordinates",
            remedy="give the transmission, q_p = J q_s",
        )  # fmt: skip
    j = np.asarray(transmission, float)
    named = [
        tuple(replace(c, axis=f"actuator_{k + 1}") for k, c in enumerate(channels))
        for channels in (frf.outputs, frf.inputs)
    ]
    turned = frf.transformed(j, j.T, outputs=named[0], inputs=named[1])
    posture = tuple(float(x) for x in j @ np.array(frf.posture))
    return replace(turned, posture=posture, coordinates="actuator")


def _starts(group: Sequence[Frf], moves: str, low: float, high: float) -> list[np.ndarray]:
    """For a given delay the inverse response s M + D + K / s is linear in all else: least squares."""
    blocks, weights, inverses = [], [], []
    for f in group:
        s = 1j * f.omega
        mixed, pull = np.cos(f.posture[1] - f.posture[0]), np.cos(np.array(f.posture))
        zero, one = np.zeros(len(f)), np.ones(len(f))
        columns = np.zeros((len(f), 2, 2, 7), complex)
        columns[:, 0, 0] = np.stack([s, zero, zero, one, zero, pull[0] / s, zero], axis=1)
        columns[:, 0, 1, 1] = columns[:, 1, 0, 1] = s * mixed
        columns[:, 1, 1] = np.stack([zero, zero, s, zero, one, zero, pull[1] / s], axis=1)
        inverse = np.linalg.inv(to_velocity(f, moves))
        relative = np.sqrt(
            np.einsum("fii->f", f.covariance).real / np.sum(np.abs(f.response) ** 2, axis=(1, 2))
        )
        weights.append(1.0 / np.maximum(relative, 1e-4) / np.linalg.norm(inverse, axis=(1, 2)))
        blocks.append(columns)
        inverses.append(inverse)
    found = []
    omega = np.concatenate([f.omega for f in group])
    for delay in delays(low, high, np.sort(omega)):
        left, right = [], []
        for f, columns, weight, inverse in zip(group, blocks, weights, inverses, strict=True):
            late = weight * np.exp(-1j * f.omega * delay)
            left.append((weight[:, None, None, None] * columns).reshape(-1, 7))
            right.append((late[:, None, None] * inverse).ravel())
        a, b = np.concatenate(left), np.concatenate(right)
        a, b = np.concatenate([a.real, a.imag]), np.concatenate([b.real, b.imag])
        x, *_ = np.linalg.lstsq(a, b, rcond=None)
        found.append((float(np.sum((a @ x - b) ** 2)), x, float(delay)))
    starts = []
    for _, x, delay in sorted(found, key=lambda f: f[0])[:_STARTS]:
        positive = np.maximum(x[[0, 2, 3, 4]], 1e-6)
        starts.append(np.array([positive[0], x[1], *positive[1:], delay, *x[5:7]]))
    return starts
