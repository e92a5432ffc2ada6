"""What a worker does: one robot's recordings read, its model improved, the result kept."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from workbench.core import FORMAT, InputError, Recording, WorkbenchError
from workbench.diagnosis import improve
from workbench.effects import load_model
from workbench.models import write_model
from workbench.recordings import Log, excerpts, open_recording
from workbench.report.json import diagnosis_dict, improvement_dict
from workbench.simulation import use_cores

from .robots import Robot
from .store import keep, result_file


def diagnose_robot(robot: Robot, folder: Path, seed: int, inputs: str, cores: int) -> str | None:
    """Improve one robot's model and keep what was found.

    Args:
        robot: which.
        folder: of the results, which the worker can write.
        seed: of the noise simulations.
        inputs: `fingerprint` that the result is kept under.
        cores: that this worker may use.

    Returns:
        One line that says why it failed; None where it did not. Others' work goes on whatever happens here.
    """
    use_cores(cores)
    try:
        _diagnose(robot, folder, seed, inputs)
    except WorkbenchError as error:
        return str(error)
    except MemoryError:
        return "out of memory; give it fewer recordings, or the fleet fewer workers (--jobs)"
    except Exception as error:  # a fault of ours in one robot is no reason to lose the others
        return f"failed inside: {type(error).__name__}: {' '.join(str(error).split())}"
    return None


def _diagnose(robot: Robot, folder: Path, seed: int, inputs: str) -> None:
    model = load_model(robot.model)
    left_out: list[dict[str, str]] = []
    training = _readable(robot.training, left_out)
    held_out = _readable(robot.held_out, left_out)
    if not training:
        raise InputError(f"no recording can be used: {left_out[0]['problem']}")
    data = excerpts(training, held_out)
    found, better = improve(model, data.training, data.held_out, seed=seed)
    assert found.diagnosis is not None
    said = {"used": data.share, "notes": (*found.notes, *data.notes)}
    diagnosis, found = replace(found.diagnosis, **said), replace(found, **said)
    file, improved = result_file(folder, robot.name), None
    if found.added:
        improved = file.with_suffix(".toml")
        write_model(better, improved, force=True)
    told = diagnosis_dict(diagnosis)
    content: dict[str, Any] = {
        "format": FORMAT,
        "rig": robot.name,
        "inputs": inputs,
        "model": model.name,
        "recordings": [r.name for r in training],
        "held_out": [r.name for r in held_out],
        "left_out": left_out,
        "failed": None,
        "verdict": told["verdict"],
        "improved": improved.name if improved else None,
        "diagnosis": told,
        "improvement": improvement_dict(found),
    }
    keep(folder, content)


def _readable(files: tuple[Path, ...], left_out: list[dict[str, str]]) -> list[Recording | Log]:
    """Recordings that can be read; what is wrong with the others is put down."""
    good = []
    for file in files:
        try:
            source = open_recording(file)
            if isinstance(source, Log):
                _ = source.clock  # what is wrong with it comes out while it can still be left out
            good.append(source)
        except InputError as error:
            left_out.append({"recording": file.stem, "problem": str(error)})
    return good
