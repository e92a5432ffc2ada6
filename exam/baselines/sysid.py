"""MuJoCo's system identification of all numbers of the model, then BIC over which of them moved.

The toolbox's own optimiser and residual: from torque to position, in windows of three seconds that begin
where the machine was. From the file's numbers on, one after another is let free as long as BIC falls, by the
Jacobian at the fit of all. Needs `pip install 'mujoco[sysid]'`.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any

import mujoco
import numpy as np
from absl import logging
from dynamics import speed_of, torque_of
from mujoco import sysid
from scipy.signal import savgol_filter
from workbench_exam.answers import Answer, Named
from workbench_exam.cases import Case

_STEP = 2e-3  # s
_WINDOW, _EVERY = 2.9, 5.9  # s: of a window, and between their beginnings
_LEAST = 0.03  # of the squares, that a number takes
_ALIKE = 20  # rows of a window that say much the same
_SPAN = 1.959964
_MATTERS = 0.05  # of a number's scale: less is a model error of windows


@dataclass(frozen=True)
class Number:
    """A number of the model: its name in the vocabulary, usual size, bounds, and how it is set."""

    effect: str
    place: str | None
    value: str
    nominal: float
    scale: float
    bounds: tuple[float, float]
    put: Callable[[Any, float], None]


def numbers_of(case: Case, spec: Any) -> list[Number]:
    """Armature, damping, friction, gain and bias of each drive; payload; centre and inertia of each link."""
    found = []
    file = case.known["file_numbers"]
    coupled = case.known["joints"] != list(case.drives)
    for k, i in enumerate(np.flatnonzero(case.driven)):
        drive = case.drives[i]
        rub = max(file["friction"][i], 0.05 * case.kd[i])
        for key, effect, name in (
            ("armature", "reflected_inertia", "inertia"),
            ("damping", "viscous_damping", "damping"),
            ("frictionloss", "coulomb_friction", "torque"),
        ):
            own = file["friction" if key == "frictionloss" else key][i]
            scale = rub if key == "frictionloss" else max(own, 0.05 * case.kd[i] * (key == "damping"))

            def put(s: Any, value: float, key: str = key, drive: str = drive) -> None:
                element = (s.tendon if coupled else s.joint)(drive)
                old = getattr(element, key)
                value_there = np.array([value, *np.ravel(old)[1:]]) if np.ndim(old) else value
                setattr(element, key, value_there)

            found.append(Number(effect, drive, name, own, scale, (1e-3 * scale, own + 6 * scale), put))

        def gain(s: Any, value: float, k: int = k) -> None:
            s.actuators[k].gainprm[0] = value

        def bias(s: Any, value: float, k: int = k) -> None:
            s.actuators[k].biastype = mujoco.mjtBias.mjBIAS_AFFINE
            s.actuators[k].biasprm[0] = value

        found.append(Number("torque_constant_error", drive, "gain", 1.0, 0.2, (0.4, 2.0), gain))
        found.append(Number("torque_bias", drive, "torque", 0.0, rub, (-6 * rub, 6 * rub), bias))
        body = spec.bodies[i + 1]
        if not coupled and i and not case.known["units"]["position"][i].startswith("m"):
            axis = np.array(spec.joints[i].axis)
            target = np.array(spec.bodies[i + 2].pos if i + 2 < len(spec.bodies) else spec.sites[0].pos)
            target = target - axis * (axis @ target)
            start, mass, own = np.array(body.ipos), float(body.mass), np.array(body.inertia)
            if np.linalg.norm(target) > 1e-6:
                towards = target / np.linalg.norm(target)

                def centre(
                    s: Any, value: float, i: int = i, start=start, towards=towards, mass: float = mass
                ) -> None:
                    s.bodies[i + 1].ipos = start + towards * value / mass

                size = mass * float(np.linalg.norm(target)) * 0.3
                found.append(
                    Number("first_moment_error", drive, "along", 0.0, size, (-2 * size, 2 * size), centre)
                )

            def rounder(s: Any, value: float, i: int = i, own=own, axis=axis) -> None:
                s.bodies[i + 1].inertia = own + np.abs(axis) * value

            size = 0.5 * float(own @ np.abs(axis))
            about = own @ np.abs(axis)
            others = own[np.abs(axis) < 0.5]
            bounds = (float(abs(others[0] - others[1]) - about) * 0.99, float(others.sum() - about) * 0.99)
            found.append(Number("link_inertia_error", drive, "inertia", 0.0, size, bounds, rounder))
    return found


def _load(spec: Any) -> Number:
    last = spec.bodies[-1]
    mass, place, tip = float(last.mass), np.array(last.ipos), np.array(spec.sites[0].pos)
    inertia = np.array(last.inertia)

    def put(s: Any, value: float) -> None:
        body = s.bodies[len(s.bodies) - 1]
        total = mass + value
        centre = (mass * place + value * tip) / total
        arms = [(mass, place - centre), (value, tip - centre)]
        body.mass, body.ipos = total, centre
        body.inertia = inertia + sum(part * (arm @ arm - arm**2) for part, arm in arms)

    return Number("payload_mass", None, "mass", 0.0, 0.3 * mass, (0.0, 3 * mass), put)


def solve(case: Case) -> Answer:
    """Fits everything, then lets free only what pays."""
    spec = mujoco.MjSpec.from_file(str(case.folder / "model.xml"))
    spec.option.timestep = _STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    logging.set_verbosity(logging.ERROR)  # its sensors are the state
    pool = [*numbers_of(case, spec)]
    if not any(number.effect == "first_moment_error" for number in pool):
        pool.append(_load(spec))  # else it is a centre and an inertia
    wanted = sysid.ParameterDict()
    for k, number in enumerate(pool):
        low, high = ((bound - number.nominal) / number.scale for bound in number.bounds)
        wanted.add(
            sysid.Parameter(
                f"p{k}", nominal=0.0, min_value=low, max_value=high,
                modifier=lambda s, p, n=number: n.put(s, n.nominal + n.scale * float(p.value[0])),
            )
        )  # fmt: skip
    model = spec.compile()
    windows = list(_windows(case))
    states = sysid.TimeSeries.compute_all_state_mappings(model)[0]

    def residual_of(quicker: np.ndarray) -> Any:
        return sysid.build_residual_fn(
            models_sequences=[
                sysid.ModelSequences(
                    "machine", spec, [f"w{k}" for k in range(len(windows))],
                    [sysid.create_initial_state(model, q[0], w + quicker) for _, _, q, w in windows],
                    [sysid.TimeSeries(t, u) for t, u, _, _ in windows],
                    [sysid.TimeSeries(t, q, states) for t, _, q, _ in windows],
                    allow_missing_sensors=True,
                )
            ]
        )  # fmt: skip

    residual = residual_of(np.zeros(len(case.drives)))
    with redirect_stdout(StringIO()):
        fitted, result = sysid.optimize(wanted, residual, verbose=False)
    x = np.asarray(fitted.as_vector())

    def parts(function: Any) -> list[np.ndarray]:
        return [np.ravel(r) for r in function(x, fitted)[0]]

    own, jac = parts(residual), np.asarray(result.jac)
    # a window that begins at a wrong speed is wrong throughout: what such speeds can make is taken out
    starts = [parts(residual_of(1e-3 * one)) for one in np.eye(len(case.drives))]
    left, rows = np.concatenate(own), 0
    for k, each in enumerate(own):
        here = slice(rows, rows + len(each))
        rows = here.stop
        basis = np.linalg.qr(np.column_stack([shifted[k] - each for shifted in starts]))[0]
        left[here] -= basis @ (basis.T @ left[here])
        jac[here] -= basis @ (basis.T @ jac[here])
    return Answer(*_structure(pool, x, jac, left, len(left) / _ALIKE))


def _structure(
    pool: list[Number], x: np.ndarray, jac: np.ndarray, left: np.ndarray, count: float
) -> tuple[str, tuple[Named, ...]]:
    """Forward selection by BIC in the quadratic about the fit, of `count` independent rows."""
    gram, slope = jac.T @ jac + 1e-12 * np.eye(len(x)), jac.T @ left

    def squares(free: list[int]) -> tuple[float, np.ndarray]:
        """Least squares with all others at the file's numbers."""
        fixed = [k for k in range(len(x)) if k not in free]
        moved = np.zeros(len(x))
        moved[fixed] = -x[fixed]
        if free:
            push = slope[free] + gram[np.ix_(free, fixed)] @ moved[fixed]
            moved[free] = -np.linalg.lstsq(gram[np.ix_(free, free)], push, rcond=1e-10)[0]
        return float(left @ left + 2.0 * slope @ moved + moved @ gram @ moved), x + moved

    def bic(free: list[int]) -> float:
        return count * float(np.log(squares(free)[0])) + len(free) * float(np.log(count))

    kept: list[int] = []
    best = bic(kept)
    while len(kept) < len(pool):
        value, add = min((bic([*kept, a]), a) for a in range(len(pool)) if a not in kept)
        if value >= best or squares([*kept, add])[0] > (1.0 - _LEAST) * squares(kept)[0]:
            break
        best, kept = value, [*kept, add]
    least, values = squares(kept)
    named = []
    if kept:
        covariance = np.linalg.pinv(gram[np.ix_(kept, kept)]) * least / count
        for row, k in enumerate(kept):
            half = _SPAN * float(np.sqrt(covariance[row, row])) * pool[k].scale
            value = (pool[k].nominal if pool[k].value == "gain" else 0.0) + float(values[k]) * pool[k].scale
            if abs(values[k]) > max(_MATTERS, half / pool[k].scale):
                named.append(
                    Named(pool[k].effect, pool[k].place, {pool[k].value: (value, value - half, value + half)})
                )
    return ("missing_effect" if named else "consistent"), tuple(named)


def _windows(case: Case):
    """Time [s], torques of motors, joint positions and first joint speeds of each window."""
    turn = np.linalg.inv(case.couple)
    driven = np.flatnonzero(case.driven)
    for r in case.recordings:
        t = np.arange(r.time[0], r.time[-1], _STEP)
        place = r.signals["position"]
        period = float(np.median(np.diff(r.time)))
        rows = 2 * round(0.02 / period) + 1  # of a window's first speed, on which all of it hangs
        speed = savgol_filter(place, rows, 3, deriv=1, delta=period, axis=0) if rows > 3 else speed_of(r)
        signals = (torque_of(case, r, held=True), place, speed)
        u, q, w = (
            np.column_stack([np.interp(t, r.time, x[:, i]) for i in range(x.shape[1])]) for x in signals
        )
        q, w = q @ turn.T, w @ turn.T
        for start in range(0, len(t) - round(_WINDOW / _STEP), round(_EVERY / _STEP)):
            rows = slice(start, start + round(_WINDOW / _STEP))
            early = 0.5 * _STEP * (w[rows] - w[start])  # Euler's steps show angles half a step early
            yield t[rows] - t[start], u[rows][:, driven], q[rows] + early, w[start]
