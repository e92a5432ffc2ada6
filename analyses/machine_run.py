"""What the workbench says of one measured machine, as JSON on the standard output.

    python analyses/machine_run.py data emps --folder out/machines/emps

`real_machines.py` runs it in a process of its own, so that a machine that takes too long can be stopped.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from machine_cases import CASES

from workbench import compare, improve, report
from workbench.core import Comparison, Improvement, Recording
from workbench.diagnosis import with_mended_gains
from workbench.models import Model, write_model


def answer(name: str, data: Path, folder: Path) -> dict[str, Any]:
    """What `improve` makes of a machine.

    Returns:
        ``machine``; ``verdict`` of the diagnosis and its ``sentence``; ``findings``, effects that are named;
        ``nearest``, effects that come nearest where nothing is; ``judged``, errors on data that were not
        fitted; ``unexplained``, share of the excess that stays on those that were, and its ``evidence``;
        ``read``, numbers that are read off without a diagnosis; ``notes``; ``seconds``. Where the search ends
        in an error, that stands under ``failed``, and beside it only how far the model as given is off.
    """
    folder.mkdir(parents=True, exist_ok=True)
    case = CASES[name](data, folder)
    begin = time.perf_counter()
    try:
        result, better = improve(case.model, case.training, case.judging, nearest=True)
    except Exception as error:  # any that ends it: having no answer is what this machine's row has to say
        off = _errors(compare(case.model, case.unseen or case.judging))
        failed = f"{type(error).__name__}: {error}"
        return {"machine": name, "failed": failed, "judged": {"before": off, "after": off}}
    seconds = time.perf_counter() - begin
    write_model(better, folder / "improved.toml", force=True)
    said = result.diagnosis
    assert said is not None  # `improve` always gives it
    read = {k: {"value": v.value, "std": v.std, "unit": v.unit} for k, v in (case.read or {}).items()}
    return {
        "machine": name,
        "verdict": said.verdict,
        "sentence": report.sentence(said),
        "findings": [
            {**report.effect_dict(f.key, f.parameters), "probability": f.probability} for f in said.findings
        ],
        "nearest": [report.effect_dict(s.key, s.parameters) for s in result.steps if result.nearest],
        "judged": judged(result, case.model, better, case.unseen),
        "unexplained": said.unexplained_fraction,
        "evidence": list(said.evidence),
        "read": read,
        "notes": list(result.notes),
        "seconds": round(seconds, 1),
    }


def judged(result: Improvement, model: Model, better: Model, unseen: Sequence[Recording]) -> dict[str, Any]:
    """Errors before and after, each with its noise floor, on recordings that were not fitted."""
    assert result.diagnosis is not None  # `improve` always gives it
    mended = with_mended_gains(unseen, result.diagnosis)
    pair = (compare(model, unseen), compare(better, mended)) if unseen else result.held_out
    assert pair is not None  # every machine has recordings that judge
    before, after = pair
    if result.nearest and not unseen:  # the errors of what comes nearest are the improvement's
        after = compare(better, [r.recording for r in before.recordings])
    names = [r.recording.name for r in before.recordings]
    return {"recordings": names, "before": _errors(before), "after": _errors(after)}


def _errors(c: Comparison) -> dict[str, float | bool | None]:
    force = c.inverse_dynamics
    return {
        "error": c.error,
        "noise": c.noise_error,
        "consistent": c.consistent,
        "force_error": force.relative_error if force else None,
    }


def main() -> None:
    """Prints one machine's answer."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, help="folder of the measured data")
    parser.add_argument("machine", choices=CASES)
    parser.add_argument("--folder", type=Path, default=Path("out/machine"), help="for the files it makes")
    arguments = parser.parse_args()
    report.write_json(answer(arguments.machine, arguments.data, arguments.folder), "-")


if __name__ == "__main__":
    main()
