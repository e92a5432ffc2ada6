"""Why a run became unstable: the effect without which it is stable, or the gains of its loop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from workbench.core import Controller, Recording, SimulationError
from workbench.core.units import unit_text
from workbench.effects import compile_plant
from workbench.models import AppliedEffect, Model

from .experiment import prepare
from .motion import mass_matrix
from .trajectory import Track


def raise_where_unstable(
    model: Model,
    recording: Recording,
    controller: Controller,
    made: Recording,
    again: Callable[[Model], Recording],
) -> None:
    """Raise an error that names the run whose state is not finite, the time, and the cause.

    Args:
        model, recording: what was run.
        controller: the loop that it ran in.
        made: the simulation.
        again: runs another model the same way.

    Raises:
        SimulationError: the simulation is unstable.
    """
    lost = _lost(made)
    if lost is None:
        return
    blamed = [effect for effect in model.effects if _stable(again, model, effect)]
    if len(blamed) == 1:
        why = f"check {_stated(blamed[0])}: without that effect it is stable"
    elif blamed:
        why = f"check {', '.join(map(_stated, blamed))}: it is stable without any one of them"
    else:
        why = f"check gains, delay and inertias: no single effect causes this, and {_loop(controller)}"
        why += _too_light(model, recording, controller)
    axis, speed, unit = _fastest(made, lost)
    raise SimulationError(
        f"model '{model.name}' becomes unstable on recording '{recording.name}' at t = "
        f"{lost * recording.period:.3f} s; {why} ({axis} was last at {speed:.3g} {unit}/s)"
    )


def _lost(made: Recording) -> int | None:
    """The first row that is not finite."""
    bad = ~np.isfinite(made.position).all(axis=1)
    return int(np.argmax(bad)) if bad.any() else None


def _stable(again: Callable[[Model], Recording], model: Model, effect: AppliedEffect) -> bool:
    rest = tuple(each for each in model.effects if each is not effect)
    try:
        return _lost(again(replace(model, effects=rest))) is None
    except SimulationError:  # without it there is nothing to run
        return False


def _fastest(made: Recording, lost: int) -> tuple[str, float, str]:
    """The axis, its speed, and the unit of its position, which not all axes share."""
    last = np.abs(np.nan_to_num(made.velocity[max(lost - 1, 0)]))
    k = int(last.argmax())
    return made.axes[k], float(last[k]), made.units[k]


def _stated(effect: AppliedEffect) -> str:
    values = ", ".join(f"{n} = {e.value:g} {unit_text(e.unit)}".strip() for n, e in effect.parameters.items())
    return f"{effect.key} ({values})" if values else str(effect.key)


def _too_light(model: Model, recording: Recording, controller: Controller) -> str:
    """Where a loop's damping, held for a period, is more than an inertia stands.

    Under it a speed w becomes (1 - kd period / inertia) w by the next tick: above kd period / 2 it falls.
    """
    if controller.kind != "pd" or controller.period_s is None:
        return ""
    back = model.transmission if controller.coordinates == "joint" else np.eye(model.size)
    start = recording.position[[0, 0]] @ prepare(recording, model).to_actuator.T
    mass = back.T @ mass_matrix(compile_plant(model), Track(start, 0.0 * start, 0.0 * start))[0] @ back
    own = 1.0 / np.diag(np.linalg.inv(mass))
    least = 0.5 * controller.period_s * np.array(controller.kd)
    worst = int(np.argmax(least / own))
    if least[worst] <= own[worst]:
        return ""
    unit = "kg m^2" if recording.units[worst] == "rad" else "kg"
    asked = f"its damping gain of {recording.axes[worst]} needs at least {least[worst]:.2g} {unit}"
    return (
        f"; with a period of {1e3 * controller.period_s:.3g} ms {asked}, and the model has {own[worst]:.2g}: "
        "a rotor's inertia may be missing"
    )


def _loop(controller: Controller) -> str:
    gains = [
        f"{name} {', '.join(f'{x:g}' for x in getattr(controller, name))}"
        for name in ("kp", "kd", "kv", "gain")
        if getattr(controller, name)
    ]
    return f"its loop has {'; '.join(gains)}" if gains else "it runs without a loop"
