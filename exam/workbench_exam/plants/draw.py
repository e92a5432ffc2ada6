"""What a case hides, drawn from a seed: which effects, where, how large, and how it is recorded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench_exam.vocabulary import INCREMENTS, WHOLE

from .chain import Machine
from .drawn import Drawn, Item, apart, judged, true_plant
from .machines import MACHINES, draw_machine
from .plant import JOINT, Plant, along
from .sizes import few_digits, stranger_of, values_of

KINDS = {
    "number": 10,
    "single": 12,
    "pair": 8,
    "triple": 4,
    "clean": 8,
    "stranger": 6,
    "beside": 6,
    "disagree": 6,
}
WAYS = ("usual", "jitter", "usual", "coarse", "no_velocity", "units", "usual", "no_torque")
STRANGERS = ("rough_patch", "follower", "tone", "cubic_spring")
#: What motion without torque can tell apart.
_MOTION = (*INCREMENTS, "payload_mass", "parallel_spring", "quadratic_drag", "cogging")
_SINGLE = (
    "payload_mass", "torque_constant_error", "joint_compliance", "torque_bias", "cogging", "current_loop_lag",
    "parallel_spring", "stribeck_friction", "command_delay", "backlash", "quadratic_drag", "encoder_offset",
    "torque_saturation",
)  # fmt: skip
#: An effect on one drive that is much the same as another there.
_ALIKE = (
    {"viscous_damping", "quadratic_drag"},
    {"coulomb_friction", "stribeck_friction"},
    {"reflected_inertia", "link_inertia_error", "payload_mass", "first_moment_error"},
    {"joint_compliance", "backlash", "reflected_inertia"},
    {"torque_bias", "encoder_offset", "parallel_spring"},
    {"current_loop_lag", "command_delay"},
    {"torque_constant_error", "torque_saturation"},
)
VISIBLE, TRIES = 2.0, 12


def plan(count: int) -> list[tuple[str, int]]:
    """Kind and number of each case, so that every beginning is a fair sample of kinds."""
    scale = max(1.0, count / sum(KINDS.values()))
    groups = [[(kind, i) for i in range(round(size * scale))] for kind, size in KINDS.items()]
    placed = [((i + 0.5) / len(g), k, item) for k, g in enumerate(groups) for i, item in enumerate(g)]
    return [item for _, _, item in sorted(placed)][:count]


def draw(seed: int, kind: str, number: int) -> Drawn:
    """One case; what is hidden is drawn again until each of it shows, `TRIES` times at most."""
    turn = number + 3 * list(KINDS).index(kind) + seed % 7
    family = tuple(MACHINES)[turn % len(MACHINES)]
    own = own_seed(seed, kind, number)
    best: Drawn | None = None
    for attempt in range(TRIES):
        rng = np.random.default_rng([own, attempt, 433])
        drawn = _draw(kind, family, number + seed, own, rng)
        try:
            drawn = _shown(drawn)
        except ArithmeticError:
            continue
        least = min((each.shows for each in (*drawn.hidden, *drawn.strangers)), default=VISIBLE)
        if best is None or least > _least(best):
            best = drawn
        if least >= VISIBLE:
            break
    if best is None:
        raise ArithmeticError(f"no machine of {family} with seed {own} stays on its path")
    return best


def own_seed(seed: int, kind: str, number: int) -> int:
    """The seed of one case, which its truth states."""
    return (seed * 1009 + list(KINDS).index(kind)) * 1009 + number


def _least(drawn: Drawn) -> float:
    return min((each.shows for each in (*drawn.hidden, *drawn.strangers)), default=VISIBLE)


def _draw(kind: str, family: str, number: int, own: int, rng: np.random.Generator) -> Drawn:
    way = WAYS[int(np.random.default_rng([own, 439]).integers(len(WAYS)))]
    way = "positions_alone" if family == "quadruped" else "usual" if kind == "disagree" else way
    tick, every = (1e-3, int(rng.choice([5, 10]))) if way == "positions_alone" else (2e-3, 1)
    drawn = Drawn(kind, family, way, own, Plant(draw_machine(family, own)), tick=tick, every=every)
    few = way in ("positions_alone", "no_torque")
    if kind == "disagree":
        load = few_digits(0.5 * drawn.file.machine.links[-1].mass * rng.uniform(0.8, 1.6))
        unit = 1.0 if few or number % 3 == 0 else float(rng.choice([0.7376, 8.8507, 10.197, 0.10197, 1.6]))
        return replace(drawn, odd=(int(rng.integers(2)), unit, load if unit == 1.0 else 0.0))
    if kind == "clean":
        return drawn
    names: list[str] = []
    if kind == "number":
        choice = [name for name in INCREMENTS if _room(drawn.file.machine, name)]
        names = [choice[number % len(choice)]]
    elif kind == "single":
        choice = _MOTION[len(INCREMENTS) :] if few else _SINGLE
        choice = [name for name in choice if _room(drawn.file.machine, name)]
        names = [choice[number % len(choice)]]
    elif kind in ("pair", "triple", "beside"):
        count = {"pair": 2, "triple": 3, "beside": 1 + number % 2}[kind]
        pool = [
            name for name in (_MOTION if few else (*INCREMENTS, *_SINGLE)) if _room(drawn.file.machine, name)
        ]
        names = [str(name) for name in rng.permutation(pool)[:count]]
    taken: list[Item] = []
    for name in names:
        drawn, item = _placed(drawn, name, taken, rng)
        taken += [item] if item else []
    strangers = [stranger_of(draw_machine(family, own), STRANGERS[number % len(STRANGERS)], rng)] * (
        kind in ("stranger", "beside")
    )
    return replace(drawn, hidden=tuple(taken), strangers=tuple(strangers))


def _placed(
    drawn: Drawn, name: str, taken: list[Item], rng: np.random.Generator
) -> tuple[Drawn, Item | None]:
    """An effect at a drive that has room for it, and where nothing much like it sits already."""
    machine = drawn.file.machine
    for i in rng.permutation(_room(machine, name)):
        place = None if name in WHOLE else machine.axes[i]
        if any(_clash(name, place, other) for other in taken):
            continue
        if name in JOINT and rng.integers(2) and name != "reflected_inertia":  # the file has none of it
            key, size = JOINT[name]
            own = getattr(machine.links[i], key)
            links = tuple(replace(x, **{key: 0.0}) if k == i else x for k, x in enumerate(machine.links))
            bare = replace(drawn, file=replace(drawn.file, machine=replace(machine, links=links)))
            return bare, Item(name, place, {size: few_digits(own * rng.uniform(0.7, 1.6))})
        return drawn, Item(name, place, values_of(drawn, name, int(i), rng))
    return drawn, None


def _room(machine: Machine, name: str) -> list[int]:
    """Drives where an effect can be, and is told from all others."""
    where = [i for i, link in enumerate(machine.links) if link.driven]
    turning = [i for i in where if not machine.couple and not machine.links[i].slides]
    if name in ("joint_compliance", "backlash"):
        return turning
    if name in ("first_moment_error", "link_inertia_error"):
        # about its first joint a link and its rotor are one
        return [i for i in turning if i and along(machine, i)]
    return where


def _clash(name: str, place: str | None, other: Item) -> bool:
    if name == other.effect:
        return True
    same = place == other.place or place is None or other.place is None
    return same and any(name in group and other.effect in group for group in _ALIKE)


def _shown(drawn: Drawn) -> Drawn:
    """How far the absence of each effect and stranger shows, over what noise makes."""
    whole = true_plant(drawn)
    truth = judged(whole, drawn)
    noise = apart(truth, judged(whole, drawn, noisy=True))
    if drawn.kind in ("clean", "disagree"):
        return drawn

    def shows(less: Drawn) -> float:
        return round(apart(truth, judged(true_plant(less), drawn)) / noise, 2)

    hidden = tuple(
        replace(h, shows=shows(replace(drawn, hidden=_without(drawn.hidden, h)))) for h in drawn.hidden
    )
    odd = tuple(replace(s, shows=shows(replace(drawn, strangers=()))) for s in drawn.strangers)
    return replace(drawn, hidden=hidden, strangers=odd)


def _without(items: tuple[Item, ...], one: Item) -> tuple[Item, ...]:
    return tuple(item for item in items if item is not one)
