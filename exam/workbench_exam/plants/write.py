"""A drawn case as a folder: two model files, tables, a description, and the sealed truth."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from workbench_exam.cases import SIGNALS, UNITS
from workbench_exam.seal import seal
from workbench_exam.vocabulary import EFFECTS, MEANING, VERDICTS

from .chain import loaded
from .draw import draw, plan
from .drawn import Drawn, Item, true_plant
from .files import mjcf, urdf
from .machines import draw_machine
from .motions import KINDS
from .plant import Plant, Ticks, play

DURATION = 12.0  # s
_DIGITS = {"rad": 6, "m": 6, "deg": 4, "rad/s": 5, "m/s": 5, "rpm": 4, "N m": 5, "N": 5, "N mm": 2}
_ABOUT = (
    "A model file may lack effects of the vocabulary, or have wrong numbers; the recordings are of the "
    "real machine in closed loop. Say what is missing, where, and how large. Signals and places are of "
    "drives; positions are those of encoders on the motors' side, referred to the output. The controller "
    "computes kp (reference - position) - kd velocity from what was logged, every period_s, and holds it; "
    "torque_command is that, torque_measured is from motor current and the nominal torque constant, in "
    "the row's instant just after a change. Where a log has fewer rows than the loop has ticks, the "
    "reference goes on smoothly between them, and the loop's velocity is its own sensor's. Each recording "
    "begins at rest."
)


def make(count: int, seed: int, number: int) -> Drawn:
    """Case `number` of a set."""
    kind, own = plan(count)[number]
    return draw(seed, kind, own)


def write(drawn: Drawn, folder: Path, key: str) -> None:
    """Writes a case into a new folder, whose name seals it.

    Raises:
        FileExistsError: the folder is there.
        ArithmeticError: the machine ran away.
    """
    machine = drawn.file.machine
    tables = [_table(drawn, number) for number in range(3)]
    folder.mkdir(parents=True)
    (folder / "model.xml").write_text(mjcf(machine), "utf-8")
    (folder / "model.urdf").write_text(urdf(machine), "utf-8")
    for number, text in enumerate(tables):
        (folder / f"{KINDS[number][0]}.csv").write_text(text, "utf-8")
    _json(folder / "case.json", described(drawn, folder.name))
    _json(folder / "sealed.json", seal(truth(drawn), folder.name, key))


def described(drawn: Drawn, name: str) -> dict[str, Any]:
    """What a solver may know."""
    machine = drawn.file.machine
    return {
        "format": 1,
        "case": name,
        "about": _ABOUT,
        "models": ["model.xml", "model.urdf"],
        "recordings": [f"{kind}.csv" for kind, *_ in KINDS[:3]],
        "drives": list(machine.axes),
        "joints": [link.name for link in machine.links],
        "driven": [link.driven for link in machine.links],
        "drive_angles_over_joint_angles": [list(row) for row in machine.couple]
        or [[float(i == j) for j in range(len(machine.links))] for i in range(len(machine.links))],
        "file_numbers": {
            key: [getattr(link, key) for link in machine.links] for key in ("armature", "damping", "friction")
        },
        "payload_site": "tip",
        "controller": {"kind": "pd", "kp": list(machine.kp), "kd": list(machine.kd), "period_s": drawn.tick},
        "units": {"time": "ms" if drawn.way == "units" else "s"}
        | {
            signal: [_unit(drawn, signal, link.slides) for link in machine.links] for signal in _logged(drawn)
        },
        "vocabulary": {name: {"values": dict(EFFECTS[name]), "meaning": MEANING[name]} for name in EFFECTS},
        "verdicts": dict(VERDICTS),
    }


def truth(drawn: Drawn) -> dict[str, Any]:
    """What the scorer is told."""

    def item(each: Item) -> dict[str, Any]:
        return {"effect": each.effect, "place": each.place, "values": dict(each.values), "shows": each.shows}

    return {
        "kind": drawn.kind,
        "family": drawn.family,
        "way": drawn.way,
        "seed": drawn.seed,
        "hidden": [item(h) for h in drawn.hidden],
        "strangers": [item(s) for s in drawn.strangers],
        "odd": list(drawn.odd) if drawn.odd else None,
        "tick": drawn.tick,
        "every": drawn.every,
        "file": {
            key: [getattr(link, key) for link in drawn.file.machine.links]
            for key in ("armature", "damping", "friction")
        },
    }


def drawn_of(told: dict[str, Any]) -> Drawn:
    """The case of a truth, without its recordings."""
    machine = draw_machine(told["family"], told["seed"])
    links = tuple(
        replace(link, **{key: told["file"][key][i] for key in told["file"]})
        for i, link in enumerate(machine.links)
    )
    hidden, strangers = (
        tuple(Item(h["effect"], h["place"], h["values"], h["shows"]) for h in told[key])
        for key in ("hidden", "strangers")
    )
    return Drawn(
        told["kind"], told["family"], told["way"], told["seed"], Plant(replace(machine, links=links)),
        hidden, strangers, tuple(told["odd"]) if told["odd"] else None, told["tick"], told["every"],
    )  # fmt: skip


def _logged(drawn: Drawn) -> tuple[str, ...]:
    gone = {
        "positions_alone": ("velocity", "torque_command", "torque_measured"),
        "no_velocity": ("velocity",),
        "no_torque": ("torque_measured",),
    }.get(drawn.way, ())
    return tuple(signal for signal in SIGNALS if signal not in gone)


def _unit(drawn: Drawn, signal: str, slides: bool) -> str:
    odd = drawn.way == "units" and not slides
    if signal.startswith("position"):
        return "m" if slides else "deg" if odd else "rad"
    if signal == "velocity":
        return "m/s" if slides else "rpm" if odd else "rad/s"
    return "N" if slides else "N mm" if odd else "N m"


def _table(drawn: Drawn, number: int) -> str:
    """One recording as text."""
    plant, unit = true_plant(drawn), 1.0
    if drawn.odd and drawn.odd[0] == number:
        unit = drawn.odd[1]
        if drawn.odd[2]:
            machine = plant.machine
            last = loaded(machine.links[-1], drawn.odd[2], machine.tip)
            plant = replace(plant, machine=replace(machine, links=(*machine.links[:-1], last)))
    encoder = 2 * np.pi / 2**12 if drawn.way == "coarse" else None
    ticks = play(plant, drawn.seed, number, DURATION, drawn.tick, encoder=encoder)
    values = _signals(ticks, unit)
    time = ticks.time
    if drawn.way == "jitter":
        late = np.random.default_rng([drawn.seed, number, 443]).uniform(-0.15, 0.15, len(time))
        time = time + np.where(np.arange(len(time)) > 0, late, 0.0) * drawn.tick
    machine = plant.machine
    names, columns, forms = ["time"], [time * (1e3 if drawn.way == "units" else 1.0)], ["%.6f"]
    for signal in _logged(drawn):
        for i, drive in enumerate(machine.axes):
            unit_name = _unit(drawn, signal, machine.links[i].slides)
            names.append(f"{signal}_{drive}")
            columns.append(values[signal][:, i] / UNITS[unit_name])
            forms.append(f"%.{_DIGITS[unit_name]}f")
    rows = np.column_stack(columns)[:: drawn.every]
    line = ",".join(forms)
    return "\n".join([",".join(names), *(line % tuple(row) for row in rows), ""])


def _signals(ticks: Ticks, unit: float) -> dict[str, np.ndarray]:
    return {
        "position": ticks.angle,
        "position_reference": ticks.asked,
        "velocity": ticks.speed,
        "torque_command": ticks.command,
        "torque_measured": unit * ticks.sensed,
    }


def _json(file: Path, data: dict[str, Any]) -> None:
    file.write_text(json.dumps(data, indent=1) + "\n", "utf-8")
