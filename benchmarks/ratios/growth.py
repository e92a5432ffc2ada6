"""How memory and time grow with axes, length of the log, and places where effects are looked for."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np
from long_logs import write_log, write_model
from memory import measure as of_command
from side_by_side import Ratio, spread

from workbench.comparison import replay_of
from workbench.diagnosis.data import gather
from workbench.diagnosis.problem import starting_fit
from workbench.diagnosis.screening import sensitivity
from workbench.diagnosis.screening.screen import entries_of, screen
from workbench.effects import load_model
from workbench.rigs import VirtualLeg, chirp

from .row import Part, Row


def measure(quick: bool) -> list[Row]:
    """Each pair of runs side by side, a process a run."""
    minutes, legs = (0.25, 1.0) if quick else (5.0, 60.0), (1, 4)
    repeats = 2 if quick else 3
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = []
        for command in ("compare", "diagnose"):
            short, long = (_case(folder, 1, m) for m in minutes)
            memory, cpu = _pair(command, long, short, repeats)
            over = f"{minutes[0]:g} min"
            rows += [
                Row(f"memory of {command}, log of {minutes[1]:g} min, 3 axes", over, str(memory)),
                Row(f"CPU time of {command}, log of {minutes[1]:g} min, 3 axes", over, str(cpu)),
            ]
        small, large = (_case(folder, count, minutes[0]) for count in legs)
        for command in ("compare",) if quick else ("compare", "diagnose"):
            memory, cpu = _pair(command, large, small, repeats)
            rows += [
                Row(
                    f"memory of {command}, {3 * legs[1]} axes, {minutes[0]:g} min",
                    f"{3 * legs[0]} axes",
                    str(memory),
                ),
                Row(
                    f"CPU time of {command}, {3 * legs[1]} axes, {minutes[0]:g} min",
                    f"{3 * legs[0]} axes",
                    str(cpu),
                ),
            ]
    return [*rows, _catalogue(3 if quick else 9)]


def _case(folder: Path, legs: int, minutes: float) -> tuple[Path, Path]:
    """Model and log, made once."""
    own = folder / f"{legs}"
    own.mkdir(exist_ok=True)
    name = f"log_{minutes:g}"
    log = own / f"{name}.toml"
    if not log.exists():
        write_log(own, name, 60.0 * minutes, legs=legs)
    return write_model(own, legs), log


def _pair(
    command: str, one: tuple[Path, Path], other: tuple[Path, Path], repeats: int
) -> tuple[Ratio, Ratio]:
    """Peak memory and CPU time of a command on one log over those on the other."""
    found = np.array([[of_command(command, *case)[:2] for case in (one, other)] for _ in range(repeats)])
    ratios = found[:, 0] / found[:, 1]
    return spread(ratios[:, 0]), spread(ratios[:, 1])


def _catalogue(repeats: int) -> Row:
    """The screening of all places, over so many simulations of the same recordings as there are places."""
    model, recordings = load_model("leg"), VirtualLeg(seed=1).run([chirp("knee", duration=2.0)])
    data, simulated = gather(model, recordings, (), 0)
    start = starting_fit(model, data, simulated.clean)
    linearisation = sensitivity.Linearisation.of(model, data, start.simulated, len(recordings))
    places = len({entry.key for entry in entries_of(linearisation)[1]})
    replay = replay_of(model, recordings)
    found = []
    for _ in range(repeats + 1):
        begun = time.process_time()
        fresh = sensitivity.Linearisation.of(model, data, start.simulated, len(recordings))
        screen(fresh, data)
        screened = time.process_time()
        replay.run([model] * places)
        found.append((screened - begun) / (time.process_time() - screened))
    return Row(f"CPU time of screening {places} places", "a simulation a place", str(spread(found[1:])))


PART = Part(
    "growth",
    "Growth",
    "Memory and CPU time of commands, a process each, with the length of a log and with the number of axes; "
    "and the screening of the catalogue against simulating every place.",
    measure,
    "python benchmarks/memory.py --minutes 1 5 15 60 --folder logs",
)
