"""Prediction of an excitation by a model: posture, limits, and simulated run."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import lcm

import numpy as np

from workbench.core import Controller, InputError, Recording
from workbench.core.text import counted
from workbench.effects import axis_units
from workbench.frf import Design, Limit
from workbench.models import Model
from workbench.models.spec import load_tree
from workbench.s3n import drive_map

from .posture_run import PosturePlant, run_posture
from .run import Run, simulate

#: What to do about a model that states no loop.
LOOP_REMEDY = "give one that a recording states, --loop REC, or a [controller] in the model's .toml"


def held_posture(model: Model, asked: Mapping[str, float]) -> tuple[float, ...]:
    """Return the position reference in the coordinates of the loop; empty if no loop holds a posture.

    Raises:
        InputError: a name that the loop does not have.
    """
    if not holds(model):
        if asked:
            raise without_loop(model, "holds a posture", "--posture")
        return ()
    joint = model.controller.coordinates == "joint"
    names = model.joints if joint else model.axes
    unknown = [name for name in asked if name not in names]
    if unknown:
        problem = f"the loop of model '{model.name}' has no '{unknown[0]}'"
        raise InputError(problem, column="--posture", remedy=f"name {', '.join(names)}")
    middle = np.array([0.5 * (low + high) if low > -np.inf else 0.0 for low, high in joint_limits(model)])
    middle = middle if joint else _drives(model, middle)
    return tuple(float(asked.get(n, m)) for n, m in zip(names, middle, strict=True))


def holds(model: Model) -> bool:
    """Return whether the loop of the model follows a position reference and so holds a posture."""
    return model.controller.kind in ("pd", "cascade_pv")


def without_loop(model: Model, what: str, asked_by: str | None = None) -> InputError:
    """Return the error for a request that needs a loop; a plain MJCF or URDF cannot state one."""
    return InputError(f"{_called(model)} has no loop that {what}", column=asked_by, remedy=LOOP_REMEDY)


def _called(model: Model) -> str:
    return f"model '{model.source.name if model.source else model.name}'"


def joint_limits(model: Model) -> list[tuple[float, float]]:
    """Return every joint's range [rad or m]: the mechanism's, else the serial tree's, else none."""
    if model.closed_chain is not None and model.closed_chain.limits:
        return list(model.closed_chain.limits)
    tree = load_tree(model.serial).compile()
    joints = [tree.joint(name) for name in model.joints]
    return [tuple(float(x) for x in j.range) if tree.jnt_limited[j.id] else (-np.inf, np.inf) for j in joints]  # type: ignore[return-value]


def limits_of(model: Model, speed: Sequence[float] | None) -> list[Limit]:
    """Return the limits of joint positions, of drive speeds if there are any, and of drive torques.

    Raises:
        InputError: a number of speeds that is neither one nor one per axis, or one that is not positive.
    """
    units = axis_units(model)
    found = [
        Limit("position", joint, low, high, unit)
        for joint, (low, high), unit in zip(model.joints, joint_limits(model), units, strict=True)
    ]
    if speed:
        if len(speed) not in (1, model.size) or min(speed) <= 0:
            problem = f"{counted(len(speed), 'speed limit')} for {model.size} axes"
            raise InputError(
                problem, column="--speed-limit", remedy="give one positive number, or one per axis"
            )
        each = list(speed) * model.size if len(speed) == 1 else speed
        found += [Limit("speed", a, -s, s, f"{u}/s") for a, s, u in zip(model.axes, each, units, strict=True)]
    found += [
        Limit("torque", axis, -limit, limit, "N" if unit == "m" else "N m")
        for axis, limit, unit in zip(model.axes, model.actuators.torque_limit, units, strict=True)
    ]
    return [limit for limit in found if np.isfinite(limit.low) or np.isfinite(limit.high)]


def predictor(model: Model, limits: Sequence[Limit]) -> Callable[[Design], Mapping[str, np.ndarray]]:
    """Return the function that `scale_to_limits` needs: joint positions, drive speeds, commanded torques.

    `limits` are those that will be asked about; columns of others are left out.
    """
    own = drive_map(model)
    plant = PosturePlant(model) if own else None
    back = np.linalg.inv(model.transmission)

    def played(recordings: Sequence[Recording]) -> list[Recording]:
        if plant is None:
            return simulate([Run(model, r) for r in recordings])
        return [run_posture(plant, r, [None])[0] for r in recordings]

    def predict(design: Design) -> dict[str, np.ndarray]:
        # one period after one in which it settles says it all
        short = replace(design, periods=1, transient_periods=min(design.transient_periods, 1))
        runs = played([as_recording(model, short, e) for e in range(len(short.trials))])
        moved = np.concatenate([runs[0].position[:1], *(r.position for r in runs)])
        rest = np.zeros((1, model.size))  # before the first row plays: the posture, and nothing asked
        every = {
            "position": (model.joints, moved @ back.T if own is None else own.joints(moved)),
            "speed": (model.axes, np.concatenate([rest, *(r.velocity for r in runs)])),
            # before the drive clips it
            "torque": (model.axes, np.concatenate([rest, *(r.signals["torque_command"] for r in runs)])),
        }
        return {
            quantity: columns[:, [names.index(x.name) for x in limits if x.quantity == quantity]]
            for quantity, (names, columns) in every.items()
        }

    return predict


def as_recording(model: Model, design: Design, experiment: int) -> Recording:
    """Return a design's experiment as a recording to simulate: at rest in its posture, nothing measured.

    Raises:
        InputError: the design drives a reference, and the model has no loop that follows it.
    """
    time, signals = design.play(experiment)
    hold = np.array(design.hold) if design.hold else np.zeros(model.size)
    actuator = _drives(model, hold) if model.controller.coordinates == "joint" else hold
    rest = np.tile(actuator, (len(time), 1))
    held = holds(model)
    if not held:
        if "torque_feedforward" not in signals:
            raise without_loop(model, "follows a position reference", "--drive")
        signals = {"torque_command": signals["torque_feedforward"]}
    return Recording(
        name=design.trials[experiment].name,
        axes=model.axes,
        coordinates="actuator",
        time=time,
        signals={"position": rest, "velocity": np.zeros_like(rest), **signals},
        units=tuple(axis_units(model)),
        controller=model.controller if held else Controller("none"),
        excitation=design.excitation(experiment),
    )


def _drives(model: Model, joints: np.ndarray) -> np.ndarray:
    """Positions of the drives (n,) at joint positions (n,)."""
    own = drive_map(model)
    return model.transmission @ joints if own is None else own.drives(joints)


def whole_period(model: Model, period_s: float, rate_hz: float) -> float:
    """Return the nearest period [s] that is a whole number of rows and of controller ticks.

    A loop samples its feedforward at its ticks: only so does it play the same in every period.
    """
    if not (np.isfinite(period_s) and np.isfinite(rate_hz) and period_s > 0 and rate_hz > 0):
        problem = f"a period of {period_s:g} s at {rate_hz:g} Hz"
        raise InputError(problem, column="--period", remedy="give positive numbers")
    tick = (model.controller.period_s or 0.0) * rate_hz
    rows = max(1, round(tick))
    # ticks between rows: as many of them as make whole rows, to a hundredth of a row
    unit = rows if abs(tick - rows) < 1e-6 * rows or tick == 0 else lcm(round(100 * tick), 100) // 100
    count = max(1, round(period_s * rate_hz / unit))
    return count * unit / rate_hz
