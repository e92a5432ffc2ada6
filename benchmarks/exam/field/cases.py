"""The cases of a family, by seed; any beginning is a fair sample of kinds."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from workbench_exam.plants.chain import Machine
from workbench_exam.plants.machines import draw_machine

from ..cases import Case, interleaved
from ..second.hidden import Hidden
from .plant import JOINT, Field, Way, along, has, heavier

FAMILIES = ("arm", "quadruped", "six_axis", "cart")
KINDS = (
    "clean",
    "wrong_number",
    "positions_alone",
    "beside_stranger",
    "friction_everywhere",
    "two_units",
    "two_numbers",
)
STRANGERS = ("rough_patch", "follower", "tone")
_NUMBERS = (*JOINT, "first_moment_error", "link_inertia_error")
_COUNTS = {
    "clean": 3,
    "wrong_number": 8,
    "positions_alone": 6,
    "beside_stranger": 6,
    "friction_everywhere": 2,
    "two_units": 3,
    "two_numbers": 6,
}
#: What a torque may be in without anybody saying so, over N m: ft lbf, in lbf, kgf cm, kgf m; or amperes.
_UNITS = (0.7376, 8.8507, 10.197, 0.10197, 1.6)
_QUADRUPED = ("positions_alone",)  # such logs are made by policies, and hold no more
_Maker = Callable[[str, int, int, np.random.Generator], Field]


def field_cases(family: str, seed: int = 0) -> list[Case]:
    """Every case of a family, the same for the same seed."""
    groups = []
    for kind in KINDS:
        count = _COUNTS[kind] if family != "quadruped" or kind in (*_QUADRUPED, "clean") else 0
        groups.append([_case(family, kind, seed, number) for number in range(count)])
    return interleaved(groups)


def _case(family: str, kind: str, seed: int, number: int) -> Case:
    own = 10_000 * seed + 100 * KINDS.index(kind) + number
    draw = np.random.default_rng([own, 421])
    made = _MAKERS[kind](family, own, number, draw)
    if family == "quadruped" and not made.way.positions_alone:
        made = Field(family, own, made.hidden, made.strangers, _positions(draw))
    all_axes = len(made.hidden) > 1
    places = ["friction"] if all_axes else [_place(h) for h in made.hidden]
    places = "+".join([*places, *(_place(h) for h in made.strangers)]) or _recorded(made.way)
    name = f"{family}-s{seed}-{kind}-{number}-{places}"
    return Case(name, kind, own, made.hidden, recorded=_recorded(made.way), rig="field", field=made)


def _place(hidden: Hidden) -> str:
    wrong = ""
    if hidden.effect in _NUMBERS:
        wrong = "-too_much" if min(hidden.parameters.values()) < 0 else "-too_little"  # in the file
    return f"{hidden.effect}@{hidden.axis}{wrong}"


def _recorded(way: Way) -> str:
    if way.positions_alone:
        return f"positions_{1 / (way.tick * way.every):.0f}_Hz{'_held' if way.held else ''}"
    if way.odd is not None:
        return "other_load" if way.load else "other_unit"
    return "usual"


def _positions(draw: np.random.Generator) -> Way:
    return Way(
        tick=1e-3, every=int(draw.choice([5, 10, 20])), positions_alone=True, held=bool(draw.integers(2))
    )


def _clean(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    return Field(family, seed, way=_positions(draw) if number % 3 == 1 else Way())


def _wrong(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    return Field(family, seed, (_number(draw_machine(family, seed), number, _turn(seed), draw),))


def _positions_alone(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    return Field(
        family, seed, (_number(draw_machine(family, seed), number, _turn(seed), draw),), way=_positions(draw)
    )


def _beside(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    machine = draw_machine(family, seed)
    hidden = _frictions(machine) if number % 2 == 0 else (_number(machine, number // 2, _turn(seed), draw),)
    name = STRANGERS[(number + _turn(seed)) % len(STRANGERS)]
    return Field(family, seed, hidden, (_stranger(machine, name, draw),))


def _everywhere(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    return Field(family, seed, _frictions(draw_machine(family, seed)))


def _two_units(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    odd = int(draw.integers(2))  # never the one that judges
    if number % 3 == 1:
        load = 0.5 * draw_machine(family, seed).links[-1].mass * draw.uniform(0.8, 1.6)
        return Field(family, seed, way=Way(odd=odd, load=float(load)))
    return Field(family, seed, way=Way(odd=odd, unit=float(draw.choice(_UNITS))))


def _two_numbers(family: str, seed: int, number: int, draw: np.random.Generator) -> Field:
    """A link's mass by itself or beside a drive's number, or two of these."""
    machine = draw_machine(family, seed)
    turning = [
        link.name
        for link in machine.links[1:]
        if link.driven and not link.slides and along(machine, link.name) is not None
    ]
    drives = [
        Hidden(effect, link.name, "actuator", {JOINT[effect][1]: _lacking(draw) * getattr(link, key)})
        for link in machine.links
        if link.driven
        for effect, (key, _) in JOINT.items()
    ]
    first, second = (drives[i] for i in draw.choice(len(drives), 2, replace=False))
    if number % 3 == 2 or not turning:
        return Field(family, seed, (first, second))
    mass = heavier(machine, str(draw.choice(turning)), _lacking(draw))
    return Field(family, seed, (mass,) if number % 3 == 0 else (mass, first))


def _lacking(draw: np.random.Generator) -> float:
    """Share of a number that its file, which has 0.35 to 0.7 or 1.4 to 2.2 times it, lacks."""
    return 1.0 - float(draw.uniform(0.35, 0.7) if draw.integers(2) else draw.uniform(1.4, 2.2))


_MAKERS: dict[str, _Maker] = {
    "clean": _clean,
    "wrong_number": _wrong,
    "positions_alone": _positions_alone,
    "beside_stranger": _beside,
    "friction_everywhere": _everywhere,
    "two_units": _two_units,
    "two_numbers": _two_numbers,
}


def _number(machine: Machine, number: int, turn: int, draw: np.random.Generator) -> Hidden:
    """What the file lacks of one number of the machine; the file has 0.35 to 0.7 or 1.4 to 2.2 times it."""
    axes = [link.name for link in machine.links if link.driven]
    turning = [link.name for link in machine.links[1:] if link.driven and not link.slides]
    effect = _NUMBERS[(number + turn) % len(_NUMBERS)]
    if effect == "first_moment_error":
        turning = [axis for axis in turning if along(machine, axis) is not None]
    if effect not in JOINT and not turning:
        effect = "coulomb_friction"
    times = float(draw.uniform(0.35, 0.7) if draw.integers(2) else draw.uniform(1.4, 2.2))
    if effect in JOINT:
        axis = str(draw.choice(axes))
        return Hidden(
            effect, axis, "actuator", {JOINT[effect][1]: (1.0 - times) * has(machine, effect, axis)}
        )
    axis = str(draw.choice(turning))
    lacks = (1.0 - times) * has(machine, effect, axis)
    if effect == "link_inertia_error":
        lacks *= min(1.0, 0.6 / abs(1.0 - times))  # no body has more about one axis than about both others
        return Hidden(effect, axis, "actuator", {"inertia": lacks})
    return Hidden(effect, axis, "actuator", {"along": lacks, "across": 0.0})


def _turn(seed: int) -> int:
    """Where lists begin in the exam of a case, so that not every exam begins with the same."""
    return seed // 10_000


def _frictions(machine: Machine) -> tuple[Hidden, ...]:
    driven = [link for link in machine.links if link.driven]
    return tuple(
        Hidden(effect, link.name, "actuator", {JOINT[effect][1]: getattr(link, JOINT[effect][0])})
        for effect in ("coulomb_friction", "viscous_damping")
        for link in driven
    )


def _stranger(machine: Machine, name: str, draw: np.random.Generator) -> Hidden:
    """Something out of the catalogue, once to three times the friction of the axis it acts on."""
    places = [i for i, link in enumerate(machine.links) if link.driven]
    own = int(draw.choice(places))
    link = machine.links[own]
    torque = float(link.friction * draw.uniform(1.0, 3.0))
    if name == "rough_patch":
        at = machine.posture[own] + machine.reach[own] * draw.uniform(-0.3, 0.3)
        width = machine.reach[own] * draw.uniform(0.1, 0.25)
        return Hidden(
            name, link.name, "actuator", {"torque": torque, "angle": float(at), "width": float(width)}
        )
    if name == "follower":
        other = int(draw.choice([i for i in range(len(machine.links)) if i != own]))
        phase = float(machine.posture[other] + draw.uniform(-0.4, 0.4))
        return Hidden(name, link.name, "actuator", {"torque": torque, "phase": phase, "other": float(other)})
    tone = {
        "frequency": float(np.exp(draw.uniform(np.log(0.7), np.log(8.0)))),
        "phase": float(draw.uniform(0, 6)),
    }
    return Hidden(name, link.name, "actuator", {"torque": torque} | tone)
