"""The state of the workbench: a model, recordings, and all changes so far. Independent of the page."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from workbench import report
from workbench.comparison import as_compared, evaluate, replay_of, score_runs
from workbench.core import (
    Comparison,
    Diagnosis,
    EffectKey,
    Estimate,
    Finding,
    InputError,
    Recording,
    RecordingError,
    SimulationError,
)
from workbench.effects import check_effect, with_settled
from workbench.models import AppliedEffect, Model, write_model
from workbench.recordings import source_files
from workbench.report.wording import effect_phrase, parameter_name

from .chosen import Chosen
from .history import History
from .new_file import new_file
from .shelf import Shelf

_CHANGED = "CHANGED.toml"  # a model that no file holds yet


@dataclass
class Bench:
    """Selection, changes and results; everything is computed when it is asked for.

    Attributes:
        shelf: what may be chosen.
        folder: where models and reports are saved.
        seed: of the noise simulations.
        chosen, history: None until something is chosen.
        diagnosis: of the model as it was when it was asked for.
        diagnosed: that model.
    """

    shelf: Shelf
    folder: Path
    seed: int = 0
    chosen: Chosen | None = None
    history: History | None = None
    diagnosis: Diagnosis | None = None
    diagnosed: Model | None = None
    _grown: list[tuple[Diagnosis, Model]] = field(default_factory=list, repr=False)

    def read(self, model: str, recordings: Sequence[str], held_out: str | None = None) -> Chosen:
        """Return what was selected, without using it yet; slow with large files.

        Raises:
            InputError: not on the shelf, unreadable, or not made for each other.
        """
        loaded = self.shelf.model(model)
        data = as_compared(loaded, [self.shelf.recording(name) for name in recordings])
        names = [r.name for r in data]
        twice = next((n for n in names if names.count(n) > 1), None)
        if twice is not None:
            raise InputError(
                f"two of the recordings are named '{twice}'", column="name", remedy="give each its own name"
            )
        replay = replay_of(loaded, data)
        if held_out not in recordings or len(recordings) < 2:
            held_out = None
        return Chosen(model, tuple(recordings), held_out, loaded, replay.recordings, replay)

    def choose(self, chosen: Chosen) -> None:
        """Use the selection; changes are kept if the model is the same."""
        same = self.chosen is not None and self.chosen.model_label == chosen.model_label
        self.chosen = chosen
        if not same or self.history is None:
            self.history = History(chosen.model)
        self.diagnosis = self.diagnosed = None
        self._grown.clear()

    @property
    def model(self) -> Model:
        """Return the present model."""
        return self._history.current

    @property
    def _history(self) -> History:
        if self.history is None:
            raise InputError("no model is chosen", remedy="choose one, and a recording")
        return self.history

    def add(self, applied: AppliedEffect) -> None:
        """Add an effect.

        Raises:
            InputError: it does not belong in this model.
        """
        checked = check_effect(self.model, applied)
        self._history.change(f"adding {effect_phrase(applied.key)}", self.model.with_effect(checked))

    def add_finding(self, finding: Finding) -> None:
        """Add a finding, with the settings of the model that the diagnosis changed for it.

        Raises:
            InputError: it does not belong in this model any more.
        """
        model, applied = self.model, AppliedEffect(finding.key, finding.parameters)
        told = self.told()
        if self.diagnosis is not None:
            model = with_settled(model, self.diagnosis.settled, [finding.key])
        self.take(f"adding {effect_phrase(finding.key)}", model.with_effect(check_effect(model, applied)))
        if told is not None and finding in told.findings:
            self._grown.append((told, self.model))

    def told(self) -> Diagnosis | None:
        """Return the diagnosis if it is of this model, or of it without its findings."""
        found, model = self.diagnosis, self.model
        of_it = model is self.diagnosed or any(d is found and m is model for d, m in self._grown)
        return found if of_it else None

    def take(self, what: str, model: Model) -> None:
        """Use a model that was made from the present one elsewhere."""
        self._history.change(what, model)

    def remove(self, index: int) -> None:
        """Remove the effect at this place in the list of the model."""
        effects = self.model.effects
        kept = (*effects[:index], *effects[index + 1 :])
        what = f"removing {effect_phrase(effects[index].key)}"
        self._history.change(what, replace(self.model, effects=kept))

    def set_value(self, index: int, name: str, value: float) -> None:
        """Set a parameter of the effect at this place, within its physical bounds.

        Raises:
            InputError: a body cannot have it.
        """
        model, applied = self.model, self.model.effects[index]
        old = applied.parameters[name]
        # what was estimated is no longer what the number is
        parameters = {**applied.parameters, name: Estimate(float(value), 0.0, old.unit)}
        others = replace(model, effects=(*model.effects[:index], *model.effects[index + 1 :]))
        changed = check_effect(others, AppliedEffect(applied.key, parameters))
        effects = (*model.effects[:index], changed, *model.effects[index + 1 :])
        what = f"{parameter_name(name)} of {effect_phrase(applied.key)}"
        self._history.change(what, replace(model, effects=effects), (index, applied.key, name))

    def has(self, key: EffectKey) -> bool:
        """Return whether an effect was added to the model as given."""
        count = sum(e.key == key for e in self.model.effects)
        return count > sum(e.key == key for e in self._history.given.effects)

    def simulate(self, model: Model, chosen: Chosen, indices: Sequence[int]) -> tuple[Recording, ...]:
        """Return runs of a model, without noise, for some of the recordings.

        Raises:
            SimulationError: it is unstable there.
        """
        runs = chosen.replay.only(indices).run([model])[0]
        for index, run in zip(indices, runs, strict=True):
            if not np.isfinite(run.position).all():
                raise SimulationError(
                    f"with these parameters the model becomes unstable on '{chosen.recordings[index].name}'"
                )
        return runs

    def error(self, chosen: Chosen, runs: Sequence[Recording]) -> float:
        """Return the error of runs of all recordings."""
        return score_runs(chosen.recordings, runs)[0]

    def entries(
        self, chosen: Chosen, runs: Sequence[Recording], like: Comparison | None
    ) -> tuple[RecordingError, ...]:
        """Return runs with the recordings, and the noise from a comparison of nearly the same model."""
        _, rmse = score_runs(chosen.recordings, runs)
        unknown = np.full(len(chosen.model.axes), np.nan)
        return tuple(
            RecordingError(
                recording=r,
                simulated=run,
                position_rmse=rmse[i][0],
                torque_rmse=rmse[i][1],
                position_noise=like.recordings[i].position_noise if like else unknown,
                torque_noise=like.recordings[i].torque_noise if like else unknown,
                error=float("nan"),
                noise_error=like.recordings[i].noise_error if like else float("nan"),
            )
            for i, (r, run) in enumerate(zip(chosen.recordings, runs, strict=True))
        )

    def compare(self, model: Model, chosen: Chosen) -> Comparison:
        """Return the complete comparison, with the noise floor.

        Raises:
            SimulationError: the model is unstable.
        """
        return evaluate(model, chosen.replay.with_noise(model, self.seed))

    def save_model(self, name: str, *, force: bool = False) -> Path:
        """Write the present model into the folder.

        Raises:
            InputError: not a plain file name, or the file exists and `force` is not set.
        """
        target = new_file(self.folder, name, ".toml", force=force)
        write_model(replace(self.model, name=target.stem), target, force=force)
        return target

    def save_report(self, name: str, result: Comparison | Diagnosis, *, force: bool = False) -> Path:
        """Write the report page of a comparison or diagnosis into the folder.

        Raises:
            InputError: as `save_model`, or a file that was read cannot be read any more.
        """
        target = new_file(self.folder, name, ".html", force=force)
        chosen = self.chosen
        assert chosen is not None
        read = [f for label in chosen.labels for f in source_files(self.shelf.recordings[label])]
        files, command, seeds = [*chosen.model.files, *read], self.command(result), {"noise": self.seed}
        report.write_page(result, target, command=command, seeds=seeds, inputs=files, force=force)
        return target

    def command(self, result: Comparison | Diagnosis) -> str:
        """Return the command line with the same result; for a changed model, after it was saved."""
        assert self.chosen is not None
        chosen, shelf = self.chosen, self.shelf
        model, note = shelf.typed[shelf.models[chosen.model_label]], ""
        made_of = self.diagnosed if isinstance(result, Diagnosis) else self.model
        if made_of is not self._history.given:
            note = f"  # save the model first: this result is of {model} with changes"
            model = _CHANGED
        typed = {label: shelf.typed[shelf.recordings[label]] for label in chosen.labels}
        names = list(typed.values())
        if isinstance(result, Comparison):
            return shlex.join(["workbench", "compare", model, *names]) + note
        held = ["--holdout", typed[chosen.held_out]] if chosen.held_out else []
        fitted = [n for n in names if n not in held]
        return shlex.join(["workbench", "diagnose", model, *fitted, *held]) + note
