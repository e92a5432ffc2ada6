"""What was done to recordings is said with every result on them, once for all of which it is true."""

from __future__ import annotations

from dataclasses import replace

from tests.simulation.make import leg_experiment
from workbench.comparison import compare
from workbench.comparison.notes import notes_of
from workbench.core import Controller
from workbench.diagnosis import diagnose
from workbench.effects import load_model
from workbench.report.comparison_words import loop_sentence

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


def test_only_loops_that_nobody_states_are_called_unknown() -> None:
    """One of them keeps all from being run; that is not to say that the others' loops are unknown too."""
    known, strange = (
        replace(r, name=n) for r, n in zip(measured(LEG, leg_experiment(1.5), range(2)), "ab", strict=True)
    )
    strange = replace(strange, controller=Controller())
    without = {name: x for name, x in strange.signals.items() if not name.endswith("reference")}
    blind = replace(LEG, controller=Controller())
    said = loop_sentence(compare(blind, [known, strange]))
    assert said.startswith("The controller of b is not known, so only the torque")
    assert "compared, in all recordings alike" in said
    by_model = replace(known, controller=Controller())
    said = loop_sentence(compare(LEG, [by_model, replace(strange, signals=without)]))
    assert said.startswith("The controller of b") and "alike" in said
    said = loop_sentence(compare(blind, [strange]))
    assert said.startswith("The controller of b") and "alike" not in said
