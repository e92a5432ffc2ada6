"""Machines whose logs are measured: what each model is, which recordings are fitted and which judge.

`real_machines.py` runs them all. A log that comes alone is cut: one part is fitted, the other judges.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import bam
import emps
import numpy as np
import pandas as pd
import tomli_w
import two_mass
from scipy.signal import decimate
from two_mass_fit import fit_two_mass

from workbench import load_model, load_recording, load_recordings
from workbench.core import Recording
from workbench.core.files import write_whole
from workbench.effects import inertials_into_file
from workbench.frf import estimate, find_resonances
from workbench.identification import identify_links
from workbench.models import Model


@dataclass(frozen=True)
class Case:
    """A machine's model and recordings.

    Attributes:
        model: as its owner would have it.
        training: recordings to fit.
        judging: recordings that judge and are not fitted.
        unseen: recordings that take part in nothing; where there are some, the errors are of these.
        read: numbers that are read off the data without a diagnosis: name to value, deviation and unit.
    """

    model: Model
    training: tuple[Recording, ...]
    judging: tuple[Recording, ...]
    unseen: tuple[Recording, ...] = ()
    read: dict[str, Any] | None = None


def rows(recording: Recording, first: int, last: int | None, name: str) -> Recording:
    """Rows of a recording as one of its own that begins in motion."""
    return replace(
        recording.rows(slice(first, last)),
        name=name,
        timing=replace(recording.timing, initial_at_rest=recording.timing.initial_at_rest and first == 0),
    )


def emps_case(data: Path, folder: Path) -> Case:
    """A bare mass; the first two thirds of the log are fitted, the last one judges."""
    write_whole(folder / "emps.toml", emps.description(data / "emps" / "DATA_EMPS.mat"), force=True)
    whole = load_recording(folder / "emps.toml")
    cut = len(whole) * 2 // 3
    return Case(load_model("emps"), (rows(whole, 0, cut, "first"),), (rows(whole, cut, None, "last"),))


def _two_mass_case(letter: str) -> Callable[[Path, Path], Case]:
    def case(data: Path, folder: Path) -> Case:
        """Both inertias as one rigid shaft; five periods are fitted, five others judge."""
        table = data / "two_mass" / f"MultisineType{letter}.mat"
        write_whole(folder / "two_mass.toml", two_mass.description(table), force=True)
        whole = load_recording(folder / "two_mass.toml")
        response = estimate([whole], input="current", output=("position", "link_position"))
        motor = response.select(["position_motor"], ["motor"])
        fitted = fit_two_mass(motor)
        seen = {f"{r.kind}_hz": r.frequency for r in find_resonances(motor) if 40 < r.frequency.value < 100}
        of_motor, of_load = (fitted.parameters[f"inertia_{side}"].value for side in ("motor", "load"))
        return Case(
            two_mass.rigid(of_motor, of_load, folder),
            (two_mass.half(whole, 0),),
            (two_mass.half(whole, 1),),
            read={**seen, "stiffness_by_response": fitted.parameters["stiffness"]},
        )

    return case


def ur10e_case(data: Path, folder: Path) -> Case:
    """Masses and lengths by its maker; two motions are fitted, a third judges, a fourth is seen by nobody."""
    names = ("19_14harm50sec", "19_15harm50sec", "12-50sec_12harm")
    logs = [data / "ur10e" / f"ur-20_02_{n}.toml" for n in names]
    gap = with_gap(data / "ur10e" / "ur-20_01_31-unload.toml", folder)
    *training, held_out, unseen = load_recordings([*logs, gap])
    return Case(load_model("ur10e"), tuple(training), (held_out,), (unseen,))


def with_gap(recording: Path, folder: Path) -> Path:
    """A copy of a recording whose log misses rows: with a column that says which rows were measured."""
    table = tomllib.loads(recording.read_text(encoding="utf-8"))
    pd.read_csv(recording.parent / table["table"]).assign(valid=1).to_csv(folder / "gap.csv", index=False)
    table |= {"table": "gap.csv", "columns": {**table["columns"], "valid": "valid"}}
    return write_whole(folder / "gap.toml", tomli_w.dumps(table), force=True)


def kuka_case(data: Path, folder: Path) -> Case:
    """Link masses by the data's authors; run A is fitted, run B judges."""
    a, b = load_recordings([data / "kuka_arm" / f"kuka_{run}.toml" for run in "AB"])
    return Case(load_model(str(data / "kuka_arm" / "kr300.xml")), (a,), (b,))


_GEARS = np.array([32.0, 32.0, 45.0, -48.0, 45.0, 32.0])
_NO_INERTIA = (
    'ixx="0.000" ixy="0.000" ixz="0.000" iyy="0.000" iyz="0.000" izz="0.000"',
    'ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"',
)
_TX40_KEPT = 10  # of 5 kHz, so that 500 Hz stay


def _tx40_case(coupled: bool, *, links: bool = False) -> Callable[[Path, Path], Case]:
    def case(data: Path, folder: Path) -> Case:
        """Rough inertias, or what `identify links` makes of them; motor 6 turns with joints 5 and 6.

        As if uncoupled, it turns with joint 6 alone.
        """
        source = data / "tx40"
        turned, current = (
            decimate(pd.read_csv(source / f"{name}.csv.gz").to_numpy(), _TX40_KEPT, ftype="fir", axis=0)
            for name in ("pos_read_data", "curr_data")
        )
        # at the output of its gear: angle and torque of every drive, and what they are at the joints
        position, torque, at_drives = turned / _GEARS, current * _GEARS, np.eye(6)
        at_drives[5, 4] = 1.0
        if not coupled:
            position, torque = np.linalg.solve(at_drives, position.T).T, torque @ at_drives
        axes = [f"{'motor' if coupled else 'joint'}_{k}" for k in range(1, 7)]
        write_tx40(folder, source / "tx40.urdf", axes, at_drives if coupled else np.eye(6))
        frame = {"t": np.arange(len(position)) * 2e-4 * _TX40_KEPT}
        frame |= {f"q_{k}": position[:, k] for k in range(6)} | {f"i_{k}": torque[:, k] for k in range(6)}
        write_whole(folder / "tx40.csv", pd.DataFrame(frame).to_csv(index=False), force=True)
        whole = load_recording(folder / "tx40.toml")
        cut = len(whole) * 2 // 3
        first, last = rows(whole, 0, cut, "first"), rows(whole, cut, None, "last")
        model = load_model(str(folder / "tx40_model.toml"))
        if links:
            new = {link.joint: link.after for link in identify_links(model, [first]).links}
            fixed = inertials_into_file(model, model.serial, new).content
            write_whole(model.serial, fixed, force=True)
            model = load_model(str(folder / "tx40_model.toml"))
        return Case(model, (first,), (last,))

    return case


def write_tx40(folder: Path, urdf: Path, axes: list[str], matrix: np.ndarray) -> None:
    """The model with its transmission (q_drives = matrix @ q_joints), and the recording's TOML.

    The file rounds the inertia of its last link to 0.000, which no simulator takes: a tenth of the last digit
    stands there instead.
    """
    text = urdf.read_text(encoding="utf-8").replace(*_NO_INERTIA)
    write_whole(folder / "tx40.urdf", text, force=True)
    model = {
        "format": 1,
        "name": "tx40",
        "serial": "tx40.urdf",
        "axes": axes,
        "transmission": {"joints": [f"joint_{k}" for k in range(1, 7)], "matrix": matrix.tolist()},
    }
    recording = {
        "format": 1,
        "name": "tx40",
        "table": "tx40.csv",
        "coordinates": "actuator",
        "axes": axes,
        "columns": {
            "time": "t",
            "position": [f"q_{k}" for k in range(6)],
            "torque_measured": [f"i_{k}" for k in range(6)],
        },
        "controller": {"kind": "unknown"},
        "excitation": {"kind": "reference"},
    }
    write_whole(folder / "tx40_model.toml", tomli_w.dumps(model), force=True)
    write_whole(folder / "tx40.toml", tomli_w.dumps(recording), force=True)


def go2_case(data: Path, folder: Path) -> Case:
    """Its maker's model with guessed friction and rotors; rows 600 to 1800 are fitted, later ones judge."""
    source = data / "go2_position_log"
    whole = load_recording(source / "go2.toml")
    return Case(
        load_model(str(source / "go2.xml")),
        (rows(whole, 600, 1800, "fitted"),),
        (rows(whole, 1800, 3000, "later"),),
    )


def _odrive_case(model: str) -> Callable[[Path, Path], Case]:
    def case(data: Path, folder: Path) -> Case:
        """A bare rotor; one log is fitted, one judges."""
        source = data / "odrive"
        first, second = load_recordings([source / "nocomp_0.toml", source / "nocomp_1b.toml"])
        return Case(load_model(str(source / model)), (first,), (second,))

    return case


def bam_case(data: Path, folder: Path) -> Case:
    """The motor by its data sheet; runs at position gains 100 and 800 are fitted, those at 200 judge."""
    model = load_model(str(bam.write_bam_model(folder)))
    logs = sorted(p for p in (data / "bam_xl330").glob("kp*.json") if not p.stem.endswith("lift_and_drop"))
    runs = load_recordings([bam.write_bam_recording(p, folder) for p in logs])
    judging = tuple(r for r in runs if r.name.startswith("kp200_"))
    return Case(model, tuple(r for r in runs if r not in judging), judging)


def frictionloss_case(data: Path, folder: Path) -> Case:
    """A simulated arm whose MJCF is right, dry friction included."""
    source = data / "frictionloss_arm"
    slow, sweep, work = load_recordings([source / f"{n}.toml" for n in ("slow", "sweep", "work")])
    return Case(load_model(str(source / "arm.xml")), (slow, sweep), (work,))


CASES: dict[str, Callable[[Path, Path], Case]] = {
    "emps": emps_case,
    "two_mass_a": _two_mass_case("A"),
    "two_mass_b": _two_mass_case("B"),
    "ur10e": ur10e_case,
    "kuka_arm": kuka_case,
    "tx40": _tx40_case(coupled=True),
    "tx40_uncoupled": _tx40_case(coupled=False),
    "tx40_links": _tx40_case(coupled=True, links=True),
    "go2": go2_case,
    "odrive": _odrive_case("rotor.xml"),
    "odrive_heavy": _odrive_case("rotor_crashes.xml"),
    "bam": bam_case,
    "frictionloss_arm": frictionloss_case,
}
