"""The stated control law as a linear regression on the logged signals at the controller's ticks.

pd, in the controller's coordinates c, with the commands given in the recording's coordinates:
``command = feedforward + T (kp (q_ref - M q) + kd (v_ref - M v)) + bias``, where M takes the
recording's positions to the controller's and T = M^T takes its torques back (virtual work).
cascade_pv: ``command = gain kv (kp (q_ref - q) - v) + bias`` where it is not at its limit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from workbench.core import Controller, Recording

_MOST = 4000  # ticks used; the law holds at each of them, so more adds nothing


@dataclass(frozen=True)
class Ticks:
    """Signals at the controller's ticks, each (K, n), under short names."""

    command: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    reference: np.ndarray
    velocity_reference: np.ndarray
    feedforward: np.ndarray

    def swapped(self, signals: tuple[str, ...], a: int, b: int) -> Ticks:
        """Return signals with columns a and b exchanged."""
        order = np.arange(self.command.shape[1])
        order[[a, b]] = order[[b, a]]
        return replace(self, **{s: getattr(self, s)[:, order] for s in signals})


def ticks(recording: Recording, ratio: int, phase: int, lag: int = 0) -> Ticks:
    """Return the rows at which the controller computed, with measurements from `lag` rows earlier."""
    s = recording.signals
    k = np.arange(phase, len(recording), ratio)
    k = k[k >= lag]
    valid = recording.valid
    k = k[valid[k] & valid[k - lag]]
    k = k[np.linspace(0, len(k) - 1, min(_MOST, len(k))).astype(int)] if len(k) else k
    none = np.zeros((len(k), len(recording.axes)))
    return Ticks(
        command=s["torque_command"][k],
        position=s["position"][k - lag],
        velocity=s["velocity"][k - lag],
        reference=s["position_reference"][k],
        velocity_reference=s["velocity_reference"][k] if "velocity_reference" in s else none,
        feedforward=s["torque_feedforward"][k] if "torque_feedforward" in s else none,
    )


@dataclass(frozen=True)
class LawFit:
    """A least-squares fit of the law: factors on the stated values, 1 if the statement is right.

    `rest` is the root mean square of what stays, as a part of the command's variation.
    """

    names: tuple[str, ...]
    factors: np.ndarray
    stds: np.ndarray
    rest: float

    @cached_property
    def by_name(self) -> dict[str, tuple[float, float]]:
        """Name -> (factor, standard deviation)."""
        pairs = zip(self.factors.tolist(), self.stds.tolist(), strict=True)
        return dict(zip(self.names, pairs, strict=True))


def fit_gains(t: Ticks, controller: Controller, to_controller: np.ndarray) -> LawFit:
    """Fit a factor on each stated gain: ``kp_0``, ``kd_0``, ... in the controller's coordinates."""
    kp, kd = _gains(controller)
    error = t.reference - t.position @ to_controller.T
    damped = t.velocity_reference - t.velocity @ to_controller.T
    blocks: dict[str, np.ndarray] = {}
    for i in range(len(kp)):
        back = to_controller[i]  # row i of M is column i of T
        blocks[f"kp_{i}"] = kp[i] * error[:, i : i + 1] * back
        blocks[f"kd_{i}"] = kd[i] * damped[:, i : i + 1] * back
    return _solve(blocks, t, controller)


def fit_sensors(t: Ticks, controller: Controller, to_controller: np.ndarray) -> LawFit:
    """Fit a factor on each logged position, velocity and reference, gains as stated: ``position_0``..."""
    kp, kd = _gains(controller)
    damping = (t.velocity_reference * kd) @ to_controller
    blocks: dict[str, np.ndarray] = {}
    for j in range(len(kp)):
        column = to_controller[:, j]
        blocks[f"position_{j}"] = -t.position[:, j : j + 1] * ((kp * column) @ to_controller)
        blocks[f"velocity_{j}"] = -t.velocity[:, j : j + 1] * ((kd * column) @ to_controller)
        blocks[f"reference_{j}"] = t.reference[:, j : j + 1] * (kp[j] * to_controller[j])
    return _solve(blocks, replace(t, command=t.command - damping), controller, whole=t.command)


def fit_commands(t: Ticks, controller: Controller, to_controller: np.ndarray) -> LawFit:
    """Fit a factor on each logged command, all else as stated: ``torque_command_0``, ..."""
    wanted = t.feedforward + feedback(t, controller, to_controller)
    free = _free(t.command, controller)
    found, rests = [], []
    for i in range(wanted.shape[1]):
        rows = free[:, i]
        x, y = (s[rows, i] - s[rows, i].mean() if rows.any() else np.zeros(1) for s in (t.command, wanted))
        factor = float(x @ y / (x @ x)) if x @ x > 0 else 0.0
        found.append(factor)
        rests.append(float(np.linalg.norm(y - factor * x) / max(np.linalg.norm(y), 1e-300)))
    names = tuple(f"torque_command_{i}" for i in range(len(found)))
    return LawFit(names, np.array(found), np.abs(found) * np.array(rests) / np.sqrt(len(wanted)), max(rests))


def feedback(t: Ticks, controller: Controller, to_controller: np.ndarray) -> np.ndarray:
    """Return the law's command at the ticks (T, n), without feedforward and limits."""
    kp, kd = _gains(controller)
    error = t.reference - t.position @ to_controller.T
    damped = t.velocity_reference - t.velocity @ to_controller.T
    return (kp * error + kd * damped) @ to_controller


def _gains(c: Controller) -> tuple[np.ndarray, np.ndarray]:
    """Return torque per position error and per velocity error."""
    if c.kind == "pd":
        return np.array(c.kp), np.array(c.kd)
    velocity = np.array(c.gain) * np.array(c.kv)
    return velocity * np.array(c.kp), velocity


def _solve(
    blocks: dict[str, np.ndarray], t: Ticks, controller: Controller, whole: np.ndarray | None = None
) -> LawFit:
    """Solve least squares over all axes at once, each axis with its own bias."""
    whole = t.command if whole is None else whole
    n = whole.shape[1]
    eye = np.eye(n)
    blocks |= {f"feedforward_{j}": t.feedforward[:, j : j + 1] * eye[j] for j in range(n)}
    free = _free(whole, controller)
    size = whole.std(axis=0)
    weight = 1 / np.maximum(size, 1e-3 * size.max() + 1e-300)
    x = np.column_stack([_centred(b * weight, free) for b in blocks.values()])
    y = _centred(t.command * weight, free)
    scale = np.linalg.norm(x, axis=0)
    raw = np.array([np.linalg.norm(b * weight) for b in blocks.values()])
    scale[scale <= 1e-9 * raw] = np.inf  # constant: the bias takes it, its factor stays unknown
    scale[scale == 0] = np.inf
    left, strength, right = np.linalg.svd(x / scale, full_matrices=False)
    told = strength > 1e-7 * max(strength[0], 1e-300)
    inverse = right[told].T / strength[told]
    found = inverse @ (left[:, told].T @ y)
    rest = y - (x / scale) @ found
    variance = rest @ rest / max(1, free.sum() - x.shape[1] - n)
    stds = np.sqrt(variance * (inverse**2).sum(axis=1)) / scale
    unknown = (right[~told] ** 2).sum(axis=0) > 1e-6
    stds[unknown | np.isinf(scale)] = np.inf
    return LawFit(tuple(blocks), found / scale, stds, float(np.sqrt(np.mean(rest**2))))


def _centred(values: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return each axis minus its mean over the free entries, others 0; flat."""
    mean = np.sum(values * free, axis=0) / np.maximum(1, free.sum(axis=0))
    return ((values - mean) * free).ravel()


def _free(command: np.ndarray, c: Controller) -> np.ndarray:
    """Return which commands are at no limit, stated or seen, (K, n) bool."""
    free = np.ones(command.shape, bool)
    if c.kind == "cascade_pv" and c.limit:
        free &= np.abs(command) < 0.98 * np.array(c.limit) * np.abs(np.array(c.gain))
    near = 1e-6 * np.ptp(command, axis=0)
    highest, lowest = command.max(axis=0), command.min(axis=0)
    # the same extreme twice, or on both sides, is a limit; a few rows of it pull gains by a thousandth
    both = np.abs(highest + lowest) <= near
    for extreme in (highest, lowest):
        at = np.abs(command - extreme) <= near
        free &= ~(at & ((at.sum(axis=0) > 1) | both))
    return free


def unexplained(rest: float) -> str:
    """Return the part of a command's variation that a law leaves, in words; rounding gets no digits."""
    return f"{f'{100 * rest:.1g}' if rest >= 1e-5 else 'less than 0.001'} % of it remains unexplained"
