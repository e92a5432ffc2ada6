"""``workbench record MODEL --virtual``: virtual hardware that is made of a user's own model."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.core import InputError
from workbench.core.files import check_free, together

from .common import echo
from .hidden import hidden_in

if TYPE_CHECKING:
    from workbench.frf import Design
    from workbench.models import Model
    from workbench.rigs import OwnExperiment


def is_model(name: str) -> bool:
    """Whether a model is meant, and no CAN configuration: MJCF, URDF, TOML with a serial tree, or a name.

    Names are those of shipped models and of robots of other packages; a rig's own name is for whoever asks.
    """
    from workbench.models import is_named_model
    from workbench.recordings import is_model_file

    return is_named_model(name) or is_model_file(Path(name))


def record_own(
    name: str, designs: Sequence[str], output: str, hidden: tuple[str | None, Sequence[str] | None],
    seed: int, force: bool, quiet: bool,
) -> list[Path]:  # fmt: skip
    """Plays designs on virtual hardware of a model; returns the recordings' files.

    Raises:
        InputError: nothing to play, nowhere to write to, a design for other axes, or hardware that cannot be.
    """
    from workbench.importing import described, own_rig
    from workbench.models import read_model
    from workbench.recordings import save_recording

    if not output:
        raise InputError("no output folder", remedy="say where the recordings go: -o FOLDER")
    if not designs:
        raise InputError("nothing to play", remedy=f"give a design: workbench excite {name} -o design.toml")
    model, folder = read_model(name), Path(output)
    chosen = [each for text in designs for each in experiments_of(Path(text), model)]
    files = [folder / f"{each.name}.toml" for each in chosen]
    for file in files:
        check_free(file, force=force)
    rig = own_rig(model, hidden_in(*hidden), seed)
    if not quiet:
        echo(described(model))
    recordings = [rig.run(experiment, number) for number, experiment in enumerate(chosen)]
    with together():
        for recording, file in zip(recordings, files, strict=True):
            save_recording(recording, file, compress=True, force=force)
    return files


def experiments_of(file: Path, model: Model) -> list[OwnExperiment]:
    """A design's experiments.

    Raises:
        InputError: it plays other axes, or torque alone on a machine whose loop has to hold it.
    """
    from workbench.frf import load_design

    design: Design = load_design(file)
    if design.axes != model.axes:
        raise InputError(
            f"plays {', '.join(design.axes)}; the model has {', '.join(model.axes)}", file=file,
            remedy="design it for this model: workbench excite",
        )  # fmt: skip
    return played(design, model)


def played(design: Design, model: Model) -> list[OwnExperiment]:
    """The experiments of a design for this model's axes.

    Raises:
        InputError: it holds a posture, and the model has no loop.
    """
    import numpy as np

    from workbench.rigs import OwnExperiment

    out = []
    for k, trial in enumerate(design.trials):
        _, signals = design.play(k)
        reference = signals.get("position_reference")
        if reference is not None and model.controller.kind not in ("pd", "cascade_pv"):
            raise InputError(
                "the design holds a posture, and the model has no loop", file=model.source,
                column="controller", remedy="give the model a [controller], as docs/models.md shows",
            )  # fmt: skip
        rows = design.rows
        push = signals.get("torque_feedforward", np.zeros((rows, len(model.axes))))
        out.append(OwnExperiment(trial.name, reference, push, design.excitation(k), 1.0 / design.rate_hz))
    return out
