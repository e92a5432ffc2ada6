"""The nominal leg's inverse dynamics, filtered motion, and what each effect adds to the torque: numpy only.

The torque that the motors lack over the nominal model is linear in most effects' parameters. Motion and
torque go through one filter, both sides of the regression through another, so that neither is late against
the other (M. Gautier, Dynamic identification of robots with power model, ICRA 1997).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core import EffectKey, Recording

M11, M12, M22 = 0.04793, 0.005413, 0.02368  # with drives [kg m^2]; M12 is the factor of cos alpha
G1, G2 = 1.850411, 0.274007  # N m
DAMPING = 0.0972  # N m s/rad
THIGH, SHANK, GRAVITY = 0.175, 0.24, 9.81  # m, m, m/s^2
_FIRST = 0.004  # half the window that motion and torque go through [s]: short, for products of speeds
_SECOND = 0.025  # half the window that both sides go through [s]: passes up to some 20 Hz
_ROW = 0.02  # rows of the regression [s], about as many as are independent
_SLOW = 0.01  # speed at which a direction of motion is sure [rad/s]
PLACES = (("hip", "actuator", (1.0, 0.0)), ("knee", "actuator", (0.0, 1.0)), ("knee", "joint", (-1.0, 1.0)))

#: Columns (K, N, 2) to estimates by name: coefficients (K,) -> {parameter: (value, gradient (K,))}.
FilteredRecording = Callable[[np.ndarray], dict[str, tuple[float, np.ndarray]]]


@dataclass(frozen=True)
class Motion:
    """Filtered motion and torque of all recordings, (N, 2) each, and the filter that both sides go through.

    `smooth` takes (N, ...) and leaves the rows of the regression.
    """

    q: np.ndarray
    w: np.ndarray
    a: np.ndarray
    u: np.ndarray
    smooth: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Candidate:
    """An effect as columns (K, N, 2) of torque, and how its parameters are read from their factors."""

    key: EffectKey
    columns: np.ndarray
    reading: FilteredRecording


def motion_of(recordings: Sequence[Recording]) -> Motion:
    """Filters motion and torque of recordings in actuator coordinates.

    Raises:
        KeyError: a recording has no measured torque.
    """
    parts, lengths, periods = [], [], []
    for recording in recordings:
        period = recording.period
        window = _window(_FIRST, period)
        torque = recording.signals["torque_measured"]
        held = np.vstack([torque[:1], 0.5 * (torque[1:] + torque[:-1])])  # the torque is held over each row
        q, w, u = (_convolved(x, window) for x in (recording.position, recording.velocity, held))
        parts.append((q, w, np.gradient(w, period, axis=0), u))
        lengths.append(len(q))
        periods.append(period)
    starts = np.cumsum([0, *lengths])

    def smooth(values: np.ndarray) -> np.ndarray:
        out = []
        for start, end, period in zip(starts[:-1], starts[1:], periods, strict=True):
            window = _window(_SECOND, period)
            edge = 2 * len(window)
            out.append(
                _convolved(values[start:end], window)[edge : -edge or None : max(1, round(_ROW / period))]
            )
        return np.concatenate(out)

    return Motion(*(np.concatenate(x) for x in zip(*parts, strict=True)), smooth=smooth)


def needed(q: np.ndarray, w: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Torque (N, 2) [N m] that the nominal leg needs for a motion, (N, 2) each."""
    cosine, sine = np.cos(q[:, 1] - q[:, 0]), np.sin(q[:, 1] - q[:, 0])
    hip = M11 * a[:, 0] + M12 * (cosine * a[:, 1] - sine * w[:, 1] ** 2) + G1 * np.sin(q[:, 0])
    knee = M22 * a[:, 1] + M12 * (cosine * a[:, 0] + sine * w[:, 0] ** 2) + G2 * np.sin(q[:, 1])
    return np.column_stack([hip, knee]) + DAMPING * w


def candidates(m: Motion) -> Iterator[Candidate]:
    """Every effect that is linear in the torque, or is over a small grid."""
    yield from _anywhere(m)
    yield from _whole_leg(m)
    nominal = needed(m.q, m.w, m.a)
    for axis, (name, unit) in enumerate((("hip", [1.0, 0.0]), ("knee", [0.0, 1.0]))):
        at = np.array(unit)
        yield Candidate(EffectKey("reflected_inertia", name), _stack(m.a[:, axis], at), _plain("inertia"))
        yield Candidate(EffectKey("torque_bias", name), _stack(-np.ones(len(m.q)), at), _plain("torque"))
        yield Candidate(EffectKey("torque_constant_error", name), _stack(nominal[:, axis], at), _gain)
        load = np.abs(m.u[:, axis])
        for _, location, direction in (p for p in PLACES if p[0] == name):
            way = _way(m.w @ direction)
            columns = _stack(np.column_stack([way, load * way]), np.array(direction))
            key = EffectKey("load_dependent_friction", name, "joint" if location == "joint" else "actuator")
            yield Candidate(key, columns, _plain("torque", "ratio"))
        for order in range(6, 25, 2):
            waves = np.column_stack([np.sin(order * m.q[:, axis]), np.cos(order * m.q[:, axis])])
            yield Candidate(EffectKey("cogging", name), _stack(-waves, at), _wave(float(order)))
        shift = np.zeros_like(m.q)
        shift[:, axis] = 1e-4
        slope = (needed(m.q - shift, m.w, m.a) - nominal) / 1e-4
        yield Candidate(EffectKey("encoder_offset", name), slope[None], _plain("angle"))
        less = np.ones(2)
        less[axis] = 1 - 1e-4
        slope = (needed(m.q * less, m.w * less, m.a * less) - nominal) / 1e-4
        yield Candidate(EffectKey("encoder_scale", name), slope[None], _more("scale"))


def _anywhere(m: Motion) -> Iterator[Candidate]:
    """Friction, damping and springs at each place."""
    for axis, location, direction in PLACES:
        at, q, w = np.array(direction), m.q @ direction, m.w @ direction
        way, one = _way(w), np.ones(len(m.q))

        def key(effect: str, axis: str = axis, location: str = location) -> EffectKey:
            return EffectKey(effect, axis, "joint" if location == "joint" else "actuator")

        yield Candidate(key("viscous_damping"), _stack(w, at), _plain("damping"))
        yield Candidate(key("quadratic_drag"), _stack(w * np.abs(w), at), _plain("drag"))
        yield Candidate(key("coulomb_friction"), _stack(way, at), _plain("torque"))
        for speed in (0.1, 0.15, 0.2, 0.25, 0.3, 0.4):
            peak = way * np.exp(-((w / speed) ** 2))
            yield Candidate(
                key("stribeck_friction"), _stack(np.column_stack([way, peak]), at), _stribeck(speed)
            )
        forward, back = 0.5 * (1 + way), 0.5 * (1 - way)
        columns = np.column_stack([w * forward, w * back, forward, -back])
        names = ("damping_positive", "damping_negative", "torque_positive", "torque_negative")
        yield Candidate(key("asymmetric_friction"), _stack(columns, at), _plain(*names))
        yield Candidate(key("parallel_spring"), _stack(np.column_stack([q, -one]), at), _spring)


def _whole_leg(m: Motion) -> Iterator[Candidate]:
    alpha = m.q[:, 1] - m.q[:, 0]
    cosine, sine, zero = np.cos(alpha), np.sin(alpha), np.zeros(len(alpha))
    first = cosine * m.a[:, 1] - sine * m.w[:, 1] ** 2
    second = cosine * m.a[:, 0] + sine * m.w[:, 0] ** 2
    inertia = [np.column_stack(c) for c in ((m.a[:, 0], zero), (first, second), (zero, m.a[:, 1]))]
    gravity = [np.column_stack(c) for c in ((np.sin(m.q[:, 0]), zero), (zero, np.sin(m.q[:, 1])))]
    yield Candidate(EffectKey("linkage_inertia", None), np.stack(inertia), _plain("M11", "M12", "M22"))
    yield Candidate(EffectKey("linkage_gravity", None), np.stack(gravity), _plain("g1", "g2"))
    sizes = (THIGH**2, THIGH * SHANK, SHANK**2, THIGH * GRAVITY, SHANK * GRAVITY)
    payload = sum(size * column for size, column in zip(sizes, [*inertia, *gravity], strict=True))
    yield Candidate(EffectKey("payload_mass", None), np.asarray(payload)[None], _plain("mass"))


def _stack(along: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Columns (K, N, 2) of factors (N,) or (N, K) along a direction (2,)."""
    return np.atleast_2d(along.T)[:, :, None] * direction


def _way(w: np.ndarray) -> np.ndarray:
    """Direction of motion (N,), from -1 to 1."""
    return np.tanh(w / _SLOW)


def _unit(count: int, index: int) -> np.ndarray:
    return np.eye(count)[index]


def _plain(*names: str) -> FilteredRecording:
    return lambda x: {name: (float(x[i]), _unit(len(x), i)) for i, name in enumerate(names)}


def _gain(x: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
    """The measured torque is that needed, over the gain."""
    return {"gain": (1.0 / (1.0 + float(x[0])), np.array([-1.0 / (1.0 + float(x[0])) ** 2]))}


def _more(name: str) -> FilteredRecording:
    return lambda x: {name: (1.0 + float(x[0]), np.array([1.0]))}


def _stribeck(speed: float) -> FilteredRecording:
    return lambda x: {
        "coulomb": (float(x[0]), _unit(2, 0)),
        "static": (float(x[0] + x[1]), np.ones(2)),
        "speed": (speed, np.zeros(2)),
    }


def _spring(x: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
    k, moment = float(x[0]), float(x[1])
    return {"stiffness": (k, _unit(2, 0)), "rest": (moment / k, np.array([-moment / k**2, 1.0 / k]))}


def _wave(order: float) -> FilteredRecording:
    def read(x: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
        size = float(np.hypot(*x))
        return {
            "torque": (size, x / size),
            "order": (order, np.zeros(2)),
            "phase": (float(np.arctan2(x[1], x[0])) % (2 * np.pi), np.array([-x[1], x[0]]) / size**2),
        }

    return read


def _window(width: float, period: float) -> np.ndarray:
    half = max(1, round(width / period))
    window = np.hanning(2 * half + 3)[1:-1]
    return window / window.sum()


def _convolved(values: np.ndarray, window: np.ndarray) -> np.ndarray:
    """Columns (N, n) through a symmetric window; the ends are held."""
    half = len(window) // 2
    padded = np.concatenate([np.repeat(values[:1], half, 0), values, np.repeat(values[-1:], half, 0)])
    return np.column_stack([np.convolve(column, window, "valid") for column in padded.T])
