"""This project as a solver of the exam: its command line on a case's folder.

    workbench-exam run benchmarks/exam_solver.py cases -o answers/workbench

It gets what any solver gets: `model.xml` (with the tip as the payload's site) and the three recordings.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import tomli_w
from workbench_exam.answers import Answer, Named
from workbench_exam.cases import Case
from workbench_exam.vocabulary import EFFECTS, WHOLE

_SPAN = 1.959964


def solve(case: Case) -> Answer:
    """`workbench diagnose`, read into the exam's form.

    Raises:
        RuntimeError: it ended with an error; its one line.
    """
    with TemporaryDirectory() as name:
        folder = Path(name)
        model, recordings = written(case, folder)
        command = [
            sys.executable,
            "-m",
            "workbench",
            "diagnose",
            str(model),
            *map(str, recordings),
            "-q",
            "--json",
            "-",
        ]
        done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        said = done.stderr.strip()
        if "unit" in said or "disagree" in said:  # refused in one line, since recordings do not go together
            return Answer("recordings_disagree")
        raise RuntimeError(said)
    return answer_of(json.loads(done.stdout))


def answer_of(said: dict[str, Any]) -> Answer:
    """The command's JSON as an answer."""
    named, outside = [], []
    for finding in said["findings"]:
        effect, at_pin = finding["effect"], finding["location"] == "joint"
        if effect not in EFFECTS or at_pin:
            outside.append(f"{effect}@{finding['axis']}" + " joint" * at_pin)
            continue
        values = {key: _value(p) for key, p in finding["parameters"].items() if key in EFFECTS[effect]}
        also = tuple(
            (other["effect"], None if other["effect"] in WHOLE else other["axis"])
            for other in finding.get("indistinguishable_from", [])
            if other["effect"] in EFFECTS
        )
        place = None if effect in WHOLE else finding["axis"]
        named.append(Named(effect, place, values, finding["probability"], also))
    verdict = "recordings_disagree" if said.get("disagreeing") else said["verdict"]
    return Answer(verdict, tuple(named), tuple(outside))


def _value(parameter: dict[str, Any]) -> tuple[float, float, float]:
    value, std = parameter["value"], parameter["std"]
    value, std = (x[0] if isinstance(x, list) else x for x in (value, std))  # of several harmonics the first
    if std is None:
        return value, float("nan"), float("nan")
    return value, value - _SPAN * std, value + _SPAN * std


def written(case: Case, folder: Path) -> tuple[Path, list[Path]]:
    """The model's and the recordings' TOML files in a folder."""
    shutil.copy(case.folder / "model.xml", folder)
    model = folder / "model.toml"
    about = {
        "format": 1,
        "name": case.name,
        "serial": "model.xml",
        "variant": "kin_only",
        "payload": {"site": "tip"},
    }
    model.write_text(tomli_w.dumps(about), "utf-8")
    files = []
    for recording in case.recordings:
        known, drives = case.known, list(case.drives)
        columns = {signal: [f"{signal}_{drive}" for drive in drives] for signal in recording.signals}
        units: dict[str, Any] = {"time": known["units"]["time"]}
        for signal in recording.signals:
            units[signal.split("_")[0]] = [unit.replace(" ", "*") for unit in known["units"][signal]]
        shutil.copy(case.folder / f"{recording.name}.csv", folder)
        coupled = known["joints"] != drives
        controller = {"kind": "pd", "coordinates": "actuator" if coupled else "joint"}
        controller |= {"kp": case.kp.tolist(), "kd": case.kd.tolist(), "period_s": case.period}
        timing = {}
        if "velocity" not in recording.signals and "torque_command" not in recording.signals:
            controller["velocity"], timing = "sensor", {"timing": {"reference_held": False}}
        text = {
            "format": 1, "name": recording.name, "table": f"{recording.name}.csv", "axes": drives,
            "coordinates": "actuator" if coupled else "joint", "columns": {"time": "time", **columns},
            "units": units, "controller": controller, "excitation": {"kind": "reference"}, **timing,
        }  # fmt: skip
        files.append(folder / f"{recording.name}.toml")
        files[-1].write_text(tomli_w.dumps(text), "utf-8")
    return model, files
