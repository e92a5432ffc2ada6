"""What to measure next: the excitation for which two explanations differ most."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.comparison import scored_signals
from workbench.core import Comparison, EffectKey, Finding, InputError, SimulationError, Verdict
from workbench.effects import effect_named
from workbench.frf import Design
from workbench.models import Model
from workbench.report.wording import capital, effect_phrase
from workbench.simulation import Run, as_recording, simulate

from ..data import Data
from ..hypothesis import applied_effect
from ..naming import equivalents_of
from ..policy import POLICY
from ..search_result import SearchResult
from .experiment_design import Option, designed, in_a_loop
from .follow_up import follow_up

_OPTIONS = (
    Option("chirp", "position", 0.1, 1.0, 1.0),
    Option("chirp", "position", 0.2, 8.0, 0.5),
    Option("multisine", "torque", 0.2, 5.0, 1.5),
    Option("multisine", "torque", 0.5, 60.0, 1.0),
    Option("multisine", "torque", 0.5, 60.0, 1.0, posture=0.25),
    Option("multisine", "torque", 0.5, 60.0, 1.0, posture=0.75),
)


def next_experiment(
    verdict: Verdict, findings: Sequence[Finding], found: SearchResult, after: Comparison
) -> str | None:
    """Return one or two sentences on the motion that would settle an open question; None if there is none."""
    for finding in findings:
        step = next(s for s in found.steps if s.added == finding.key)
        rivals = finding.indistinguishable_from
        if not rivals and (finding.probability >= POLICY.doubtful or found.adequacy):
            continue  # where drives leave a rest, that is what to look at
        models = {key: model for key, model in step.others if key in rivals or not rivals}
        if not found.final_data.replay.machine_alone and (models or rivals):
            rival = next(iter(models), None) or rivals[0]
            return f"{_to_tell(finding.key, rival)} on the ground: {_ways(finding.key, rival)}."
        if models:
            rival = next(iter(models))
            return tell_apart(step.fit.hypothesis.model, models[rival], finding.key, rival, found.final_data)
        if rivals:
            return _alike(finding.key, rivals[0], found)
    if verdict == "unexplained" or (verdict != "consistent" and not found.consistent_after):
        model = found.final.hypothesis.model if findings else found.model
        return follow_up(model, after.where, found.start_data.recordings)
    return None


def _alike(key: EffectKey, rival: EffectKey, found: SearchResult) -> str:
    """What to measure where no model has the rival: no motion tells twins apart, and one may tell others."""
    if rival not in equivalents_of(found.model, key, found.start_data.recordings):
        told = f"{effect_phrase(key)} from {effect_phrase(rival)}"
        return f"These recordings cannot tell {told}. A motion that may: {_ways(key, rival)}."
    return (
        f"{capital(effect_phrase(key))} and {effect_phrase(rival)} have the same effect on this machine: no "
        f"motion can distinguish them. To measure the size best: {effect_named(key.effect).words.reveal}."
    )


def _to_tell(key: EffectKey, rival: EffectKey) -> str:
    """The beginning of a sentence that says how two effects can be distinguished."""
    return f"To tell {effect_phrase(key)} from {effect_phrase(rival)}"


def _ways(key: EffectKey, rival: EffectKey) -> str:
    """Experiments in which two effects are visible; an experiment contained in the other is given once."""
    one, other = (effect_named(k.effect).words.reveal for k in (key, rival))
    return max(one, other, key=len) if one in other or other in one else f"{one}; {other}"


def tell_apart(ours: Model, theirs: Model, key: EffectKey, rival: EffectKey, data: Data) -> str:
    """Return the experiment for which two fitted models differ most, as a command.

    Args:
        ours, theirs: models with the effect `key`, and with `rival` in its place.
        key, rival: the effects.
        data: what was recorded, and the noise floor.
    """
    tried = []
    ours, _ = in_a_loop(ours, data.recordings)
    for option in _OPTIONS:
        try:
            design, command = designed(ours, option, data.recordings)
            tried.append((separation(ours, theirs, design, data), command))
        except (InputError, SimulationError):
            continue  # not on this machine: no loop that holds a posture, a limit that rest breaks already
    ways = _ways(key, rival)
    if not tried:
        return f"{_to_tell(key, rival)}: {ways}."
    ratio, command = max(tried)
    if ratio < POLICY.told_apart:
        return (
            f"No standard excitation distinguishes {effect_phrase(key)} from {effect_phrase(rival)}. If one "
            f"is true, the other still fits with an error of {ratio:.2f} times the noise floor ({command}). "
            f"Try: {ways}."
        )
    return (
        f"{_to_tell(key, rival)}: {command}. If one is true, the other then has an error of "
        f"{ratio:.2g} times the noise floor there."
    )


def separation(ours: Model, theirs: Model, design: Design, data: Data) -> float:
    """Return the error over the noise floor that `theirs` would have in an experiment if `ours` is true.

    Its free parameters may follow, at the price that their deviations set: a weighted least-squares step on
    derivatives by simulation.

    Raises:
        SimulationError: a model is unstable in the experiment.
    """
    recordings = [as_recording(ours, design, e) for e in range(len(design.trials))]
    moved = _moved(theirs)
    runs = simulate([Run(m, r) for m in (ours, theirs, *moved) for r in recordings])
    names, floor = scored_signals(data.recordings[0]), np.sqrt(data.pool(data.floor))
    weight = np.where(floor > 0, 1.0 / np.where(floor > 0, floor, 1.0), 0.0)

    def signals(index: int) -> np.ndarray:
        part = runs[index * len(recordings) : (index + 1) * len(recordings)]
        stacked = np.concatenate([np.stack([r.signals[name] for name in names], axis=1) for r in part])
        return (stacked * weight[: len(names)]).ravel()

    base = signals(1)
    difference = signals(0) - base
    # columns in deviations, so that the prior is one
    columns = np.stack([signals(2 + k) - base for k in range(len(moved))], axis=1) if moved else None
    if columns is not None:
        gram = columns.T @ columns + np.eye(len(moved))
        change = np.linalg.solve(gram, columns.T @ difference)
        # what earlier recordings say against such a change counts too
        difference = np.concatenate([difference - columns @ change, change])
    rows = sum(len(r) for r in recordings)
    counted = rows * np.count_nonzero(weight[: len(names)])
    return float(np.sqrt(1.0 + np.sum(difference**2) / max(counted, 1.0)))


def _moved(model: Model) -> list[Model]:
    """Return the model with each estimated parameter of its last effect moved by one deviation."""
    if not model.effects:
        return []
    last = model.effects[-1]
    out = []
    for name, estimate in last.parameters.items():
        if not (np.isfinite(estimate.std) and estimate.std > 0):
            continue
        changed = applied_effect(model, last, {**last.values, name: estimate.value + estimate.std})
        effects = (
            *model.effects[:-1],
            replace(changed, parameters={**last.parameters, **changed.parameters}),
        )
        out.append(replace(model, effects=effects))
    return out
