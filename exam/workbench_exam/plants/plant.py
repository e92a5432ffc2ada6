"""A machine with effects in it, each put where the simulator has it, and what its loop then sees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from .chain import Link, Machine, loaded
from .drives import plain
from .march import CUBIC, FOLLOWER, PATCH, STEP, TONE, run
from .motions import reference

#: A number of a drive that an effect adds to, and the value's name.
JOINT = {
    "viscous_damping": ("damping", "damping"),
    "coulomb_friction": ("friction", "torque"),
    "reflected_inertia": ("armature", "inertia"),
}
#: Effects that are numbers of a drive: value -> array of `Drives`.
_SET = {
    "torque_constant_error": {"gain": "gain"},
    "torque_bias": {"torque": "bias"},
    "torque_saturation": {"limit": "limit"},
    "parallel_spring": {"stiffness": "spring", "rest": "rest"},
    "quadratic_drag": {"drag": "drag"},
    "cogging": {"torque": "ripple", "order": "order", "phase": "phase"},
    "joint_compliance": {"stiffness": "stiffness", "damping": "series"},
    "backlash": {"gap": "gap", "stiffness": "stiffness"},
    "encoder_offset": {"angle": "offset"},
    "current_loop_lag": {"time_constant": "lag"},
    "command_delay": {"time": "delay"},
}
SETTLE = 1.5  # s


@dataclass(frozen=True)
class Plant:
    """A machine, arrays of `Drives` that are not as a plain drive's, and rows of strangers."""

    machine: Machine
    drives: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    strangers: tuple[tuple[float, ...], ...] = ()


def along(machine: Machine, i: int) -> tuple[float, float, float] | None:
    """Unit vector of link `i` towards the next joint, or the tip, in its frame, square to its axis.

    None where these lie on the axis.
    """
    link = machine.links[i]
    target = machine.links[i + 1].offset if i + 1 < len(machine.links) else machine.tip
    onto = sum(a * b for a, b in zip(link.axis, target, strict=True))
    x, y, z = (b - onto * a for a, b in zip(link.axis, target, strict=True))
    length = (x * x + y * y + z * z) ** 0.5
    return (x / length, y / length, z / length) if length > 1e-6 else None


def with_effect(plant: Plant, effect: str, place: str | None, values: Mapping[str, float]) -> Plant:
    """The plant with one effect more.

    Raises:
        ValueError: the machine has no such place, or cannot have the effect there.
    """
    machine = plant.machine
    if effect == "payload_mass":
        last = loaded(machine.links[-1], values["mass"], machine.tip)
        return replace(plant, machine=replace(machine, links=(*machine.links[:-1], last)))
    everywhere = range(len(machine.axes))
    if place is not None and place not in machine.axes:
        raise ValueError(f"no drive '{place}'")
    where = everywhere if effect == "command_delay" else [machine.axes.index(place or "")]
    if effect in JOINT or effect in ("first_moment_error", "link_inertia_error"):
        links = list(machine.links)
        links[where[0]] = _changed(machine, where[0], effect, values)
        return replace(plant, machine=replace(machine, links=tuple(links)))
    drives = dict(plant.drives)
    if effect == "stribeck_friction":
        more = {"static": values["static"] - values["coulomb"], "slow": values["speed"]}
        plant = with_effect(plant, "coulomb_friction", place, {"torque": values["coulomb"]})
        machine = plant.machine
    elif effect in _SET:
        more = {_SET[effect][name]: value for name, value in values.items()}
    else:
        raise ValueError(f"no effect '{effect}'")
    if "stiffness" in more and (machine.couple or machine.links[where[0]].slides):
        raise ValueError(f"no soft coupling on '{place}'")
    own = plain(machine)[1]._asdict()
    for name, value in more.items():
        column = list(drives[name] if name in drives else own[name])
        for i in where:
            column[i] = value
        drives[name] = tuple(map(float, column))
    return replace(plant, machine=machine, drives=drives)


def _changed(machine: Machine, i: int, effect: str, values: Mapping[str, float]) -> Link:
    link = machine.links[i]
    if effect in JOINT:
        key, size = JOINT[effect]
        return replace(link, **{key: max(getattr(link, key) + values[size], 0.0)})
    if effect == "link_inertia_error":
        x, y, z = (a + abs(b) * values["inertia"] for a, b in zip(link.inertia, link.axis, strict=True))
        return replace(link, inertia=(x, y, z))
    way = along(machine, i)
    if way is None or link.slides:
        raise ValueError(f"no lever on '{link.name}'")
    x, y, z = (a + b * values["along"] / link.mass for a, b in zip(link.centre, way, strict=True))
    return replace(link, centre=(x, y, z))


def stranger(plant: Plant, name: str, place: str, values: Mapping[str, float]) -> Plant:
    """The plant with something that the vocabulary does not have."""
    p, own = values, plant.machine.axes.index(place)
    row = {
        "rough_patch": lambda: (PATCH, own, p["torque"], p["angle"], p["width"], 0),
        "follower": lambda: (FOLLOWER, own, p["torque"], p["phase"], 0, p["other"]),
        "tone": lambda: (TONE, own, p["torque"], p["frequency"], p["phase"], 0),
        "cubic_spring": lambda: (CUBIC, own, p["stiffness"], p["rest"], 0, 0),
    }[name]()
    return replace(plant, strangers=(*plant.strangers, tuple(map(float, row))))


@dataclass(frozen=True)
class Ticks:
    """What the loop saw, (N, n) each, of drives; `torque` is without noise, `sensed` the same as measured."""

    time: np.ndarray
    angle: np.ndarray
    speed: np.ndarray
    torque: np.ndarray
    command: np.ndarray
    asked: np.ndarray
    sensed: np.ndarray


def play(
    plant: Plant, seed: int, number: int, duration: float, tick: float, held: int = 1, noisy: bool = True,
    encoder: float | None = None,
) -> Ticks:  # fmt: skip
    """One motion of `motions.KINDS` in closed loop.

    Args:
        plant: what moves.
        seed, number: of the motion and of its noise.
        duration: [s]. tick: period of the loop [s].
        held: ticks for which the reference stands still.
        noisy: whether speeds have noise and angles steps.
        encoder: step [rad], the machine's own if None.

    Raises:
        ArithmeticError: the machine ran away.
    """
    machine = plant.machine
    asked = reference(machine, seed, number, duration, tick)
    if held > 1:
        asked = np.repeat(asked[::held], held, axis=0)[: len(asked)]
    m, d = plain(machine)
    d = d._replace(**{name: np.array(column) for name, column in plant.drives.items()})
    n = len(machine.axes)
    speed, grain, own = machine.noise
    draw = np.random.default_rng([seed, number, 419])
    noise = (speed if noisy else 0.0) * draw.standard_normal(asked.shape)
    steps = np.full(n, (own if encoder is None else encoder) if noisy else 0.0)
    shown = run(
        asked, round(tick / STEP), tick, np.array(machine.kp), np.array(machine.kd), noise, steps, m, d,
        np.array(plant.strangers, float).reshape(-1, 6), round(SETTLE / tick),
    )  # fmt: skip
    if not np.isfinite(shown).all():
        raise ArithmeticError(f"{machine.name} ran away")
    angle, speeds, torque, command = np.split(shown[:, : 4 * n], 4, axis=1)
    sensed = torque + (grain if noisy else 0.0) * draw.standard_normal(asked.shape) * d.driven
    return Ticks(np.arange(len(asked)) * tick, angle, speeds, torque, command, asked, sensed)
