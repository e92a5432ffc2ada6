"""A case's machine as an instrument: its model file and its recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from workbench_exam.plants import plant as plants
from workbench_exam.plants.chain import Link, Machine, loaded
from workbench_exam.plants.files import mjcf
from workbench_exam.plants.machines import draw_machine
from workbench_exam.plants.motions import KINDS
from workbench_exam.plants.plant import JOINT, Plant, play

from workbench.core import Controller, Excitation, Recording, SimulationError
from workbench.effects import load_model
from workbench.models import Model

from ..second.hidden import Hidden

RECORDED = KINDS[:3]  # the last is to judge by


@dataclass(frozen=True)
class Way:
    """How a machine is recorded.

    Attributes:
        duration: of each recording [s].
        tick: period of the loop [s].
        every: ticks a row of the log.
        positions_alone: neither speed nor torque is logged.
        held: the reference stands still from row to row.
        odd: number of the recording that is unlike the others, None of none.
        unit: times its torque.
        load: mass at its tip [kg].
    """

    duration: float = 15.0
    tick: float = 2e-3
    every: int = 1
    positions_alone: bool = False
    held: bool = False
    odd: int | None = None
    unit: float = 1.0
    load: float = 0.0


@dataclass(frozen=True)
class Field:
    """A family, what its file lacks, what is strange, how it is recorded; all else is drawn from `seed`."""

    family: str
    seed: int
    hidden: tuple[Hidden, ...] = ()
    strangers: tuple[Hidden, ...] = ()
    way: Way = field(default_factory=Way)

    @property
    def machine(self) -> Machine:
        """The true one."""
        return draw_machine(self.family, self.seed)


def has(machine: Machine, effect: str, axis: str) -> float:
    """What the machine has of the number that an effect corrects (of a first moment along the link)."""
    link = machine.links[machine.index(axis)]
    if effect in JOINT:
        return getattr(link, JOINT[effect][0])
    if effect == "link_inertia_error":
        return float(np.array(link.inertia) @ np.abs(link.axis))
    way = along(machine, axis)
    if effect == "first_moment_error" and way is not None:
        return link.mass * float(np.array(link.centre) @ way)
    raise KeyError(effect)


def along(machine: Machine, axis: str) -> np.ndarray | None:
    """Unit vector from a link to the next joint or tip, in its frame; None where these lie on its axis."""
    way = plants.along(machine, machine.index(axis))
    return None if way is None else np.array(way)


def heavier(machine: Machine, axis: str, share: float) -> Hidden:
    """What the file lacks of a link that is heavier than in it, by a share of what it is."""
    link = machine.links[machine.index(axis)]
    way, mass = along(machine, axis), share * link.mass
    arm = np.array(link.centre)
    if way is None:
        raise KeyError(axis)
    across = np.cross(link.axis, way)
    values = {"along": mass * float(arm @ way), "across": mass * float(arm @ across), "mass": mass}
    return Hidden("first_moment_error", axis, "actuator", values)


def stated(machine: Machine, hidden: Sequence[Hidden]) -> Machine:
    """The machine as its file has it: without what is hidden.

    Raises:
        KeyError: something that no file states.
    """
    for each in hidden:
        assert each.axis is not None
        link = machine.links[machine.index(each.axis)]
        machine = machine.with_link(each.axis, **_without(link, each, machine))
    return machine


def _without(link: Link, each: Hidden, machine: Machine) -> dict[str, object]:
    p = each.parameters
    if each.effect in JOINT:
        key, size = JOINT[each.effect]
        return {key: max(getattr(link, key) - p[size], 0.0)}
    if each.effect == "link_inertia_error":
        return {"inertia": tuple(np.array(link.inertia) - p["inertia"] * np.abs(link.axis))}
    way = along(machine, link.name)
    if "mass" in p:
        return {"mass": link.mass - p["mass"]}
    if each.effect == "first_moment_error" and way is not None:
        return {"centre": tuple(np.array(link.centre) - way * p["along"] / link.mass)}
    raise KeyError(each.effect)


def recorded(case: Field, folder: Path) -> tuple[Model, list[Recording]]:
    """The model, whose file is put into `folder` and must stay there, and recordings, that to judge by last.

    Raises:
        SimulationError: the machine ran away.
    """
    machine = case.machine
    file = folder / f"{machine.name}.xml"
    file.write_text(mjcf(stated(machine, case.hidden)), "utf-8")
    return load_model(file), [_record(case, machine, number) for number in range(len(RECORDED))]


def told(case: Field, recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings with all that is true of the loop and that no log of positions alone shows."""
    if not case.way.positions_alone:
        return list(recordings)
    return [
        replace(
            r,
            controller=replace(r.controller, velocity="sensor"),
            timing=replace(r.timing, reference_held=case.way.held),
        )
        for r in recordings
    ]


def _record(case: Field, machine: Machine, number: int) -> Recording:
    way, name = case.way, RECORDED[number][0]
    if number == way.odd and way.load:
        last = loaded(machine.links[-1], way.load, machine.tip)
        machine = replace(machine, links=(*machine.links[:-1], last))
    if way.positions_alone:
        machine = replace(machine, noise=(0.0, *machine.noise[1:]))
    plant = Plant(machine)
    for each in case.strangers:
        plant = plants.stranger(plant, each.effect, each.axis or "", each.parameters)
    held = way.every if way.held else 1
    try:
        ticks = play(plant, case.seed, number, way.duration, way.tick, held)
    except ArithmeticError:
        raise SimulationError(f"the {case.family} ran away in '{name}'") from None
    rows = slice(None, None, way.every)
    signals = {"position": ticks.angle[rows], "position_reference": ticks.asked[rows]}
    if not way.positions_alone:
        unit = way.unit if number == way.odd else 1.0
        signals |= {
            "velocity": ticks.speed[rows],
            "torque_command": ticks.command[rows],
            "torque_measured": unit * ticks.sensed[rows],
        }
    return Recording(
        name=name,
        axes=machine.axes,
        coordinates="joint",
        time=ticks.time[rows],
        signals=signals,
        units=tuple("m" if link.slides else "rad" for link in machine.links),
        controller=Controller("pd", "joint", kp=machine.kp, kd=machine.kd, period_s=way.tick),
        excitation=Excitation("reference"),
        rig=machine.name,
    )
