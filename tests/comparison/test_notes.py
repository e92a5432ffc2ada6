"""What was done to recordings is said with every result on them, once for all of which it is true."""

from __future__ import annotations

from dataclasses import replace

from tests.simulation.make import leg_experiment
from workbench.comparison.compare import notes_of
from workbench.diagnosis import diagnose
from workbench.effects import load_model

from .make import measured

LEG = load_model("leg")


def test_a_note_names_all_recordings_of_which_it_is_true() -> None:
    one, two = (
        replace(r, name=n) for r, n in zip(measured(LEG, leg_experiment(0.3), range(2)), "ab", strict=True)
    )
    both, alone = "Clock jitter of 2 % (rms) resampled.", "2 rows are masked."
    said = notes_of([replace(one, notes=(both, alone)), replace(two, notes=(both,))])
    assert said == (f"a, b: {both}", f"a: {alone}")


def test_a_diagnosis_says_it_too() -> None:
    logs = [replace(r, notes=("moved",)) for r in measured(LEG, leg_experiment(1.5), range(2))]
    assert f"{logs[0].name}, {logs[1].name}: moved" in diagnose(LEG, logs).notes
