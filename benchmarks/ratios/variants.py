"""Steps of S3N's variants over steps of the plain serial tree and of the loop closed by constraints."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from side_by_side import times_as_long

from workbench.effects import load_model
from workbench.models import Model
from workbench.s3n import ConstraintSettings, normalise, run_variant
from workbench.s3n.loop import loop_spec

from .row import Part, Row

_PERIOD, _STEP = 0.003, 0.001  # s
_STEPS = (0.003, 0.0015, 0.001, 0.0005, 0.00025)
_HOLD = np.array([-0.55, np.pi / 3])  # joint coordinates [rad]


def _stiff(step: float) -> ConstraintSettings:
    """The stiffest loop that MuJoCo advises at this step."""
    return ConstraintSettings(solref=(2 * step, 1.0), solimp=(0.99, 0.999, 0.001, 0.5, 2.0))


def measure(quick: bool) -> list[Row]:
    """Steps of the same length, then what the same error costs."""
    model, repeats = load_model("leg"), 9 if quick else 41
    loops = {"closed by constraints": ConstraintSettings(), "the same, stiff": _stiff(_STEP)}
    plain = {"S3N-Act": "s3n_act", "S3N-Full": "s3n_full", "exact": "exact"}
    step = {"Kin-Only": _stepping(normalise(model, "kin_only").mujoco)}
    step |= {name: _stepping(normalise(model, own).mujoco) for name, own in plain.items()}
    step |= {name: _stepping(_loop(model, settings)) for name, settings in loops.items()}
    rows = [
        Row(f"a step, {name}", "a step, Kin-Only", str(times_as_long(work, step["Kin-Only"], repeats)))
        for name, work in step.items()
        if name != "Kin-Only"
    ]
    return rows + [
        _equal_error(model, name, step[name], step["exact"], repeats, stiff=name != "closed by constraints")
        for name in loops
    ]


def _stepping(m: mujoco.MjModel) -> Callable[[], None]:
    data = mujoco.MjData(m)

    def steps() -> None:
        mujoco.mj_resetData(m, data)
        mujoco.mj_step(m, data, 1000)

    return steps


def _loop(model: Model, settings: ConstraintSettings) -> mujoco.MjModel:
    spec = loop_spec(model, settings)
    spec.option.timestep, spec.option.integrator = _STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    return spec.compile()


def _equal_error(
    model: Model,
    name: str,
    work: Callable[[], None],
    than: Callable[[], None],
    repeats: int,
    *,
    stiff: bool,
) -> Row:
    """A simulated second with the longest step that errs no more than the exact variant at 3 ms, over its."""
    truth = _motion(model, "exact", 1e-4)
    allowed = 1.02 * _error(_motion(model, "exact", _STEPS[0]), truth)
    fits = [
        h
        for h in _STEPS
        if _error(_motion(model, "constraint", h, _stiff(h) if stiff else None), truth) <= allowed
    ]
    what = f"a simulated second at no larger error, {name}"
    over = f"a second, exact, steps of {1e3 * _STEPS[0]:g} ms"
    if not fits:
        return Row(what, over, f"never so good, down to steps of {1e3 * _STEPS[-1]:g} ms")
    dearer = _STEPS[0] / fits[0]
    each = times_as_long(work, than, repeats)
    figure = f"{dearer * each.median:.3g} ({dearer * each.least:.3g} to {dearer * each.most:.3g})"
    return Row(what, over, f"{figure}, steps of {1e3 * fits[0]:g} ms")


def _motion(
    model: Model, variant: str, step: float, settings: ConstraintSettings | None = None
) -> np.ndarray:
    """Positions (N, 2) [rad] under the leg's own joint loop along a chirp of 0.5 to 6 Hz."""
    t = np.arange(round(3.0 / _PERIOD)) * _PERIOD
    swing = 0.2 * np.sin(2 * np.pi * (0.5 * t + 5.5 / 6.0 * t**2)) * np.clip(t / 0.3, 0, 1)
    reference = _HOLD + np.stack([swing, -1.5 * swing], axis=1)
    kp, kd = np.array(model.controller.kp), np.array(model.controller.kd)
    back = np.linalg.inv(model.transmission).T
    return run_variant(
        model, variant, lambda row, q, v: back @ (kp * (reference[row] - q) - kd * v), rows=len(t),
        period=_PERIOD, step=step, start=(_HOLD, np.zeros(2)), constraint=settings, strict=False,
    ).position  # fmt: skip


def _error(position: np.ndarray, truth: np.ndarray) -> float:
    return float(np.sqrt(np.mean((position - truth) ** 2)))


PART = Part(
    "variants",
    "S3N against the serial tree and against constraints",
    "Steps of 1 ms in C, of the files that `workbench normalize` writes and of the mechanism closed by "
    "`connect`; then a simulated second at equal error of position, along a chirp in closed loop.",
    measure,
    "python analyses/variants_speed_accuracy.py",
)
