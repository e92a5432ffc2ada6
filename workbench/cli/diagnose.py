"""``workbench diagnose``."""

from __future__ import annotations

from .app import app
from .common import (
    ForceOption,
    HoldoutOption,
    HtmlOption,
    JsonOption,
    ModelArgument,
    QuietOption,
    RecordingsArgument,
    SeedOption,
    check_outputs,
    deliver,
    progress,
    read_pair,
    staged,
)


@app.command()
def diagnose(
    model: ModelArgument,
    recordings: RecordingsArgument,
    holdout: HoldoutOption = None,
    json: JsonOption = None,
    html: HtmlOption = None,
    seed: SeedOption = 0,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Say which physical effect is missing, how sure, what else it could be, and what to measure next.

    Example: workbench diagnose leg chirp_hip.toml slow.toml --holdout validation.toml --json finding.json
    """
    from workbench.diagnosis import diagnose as run
    from workbench.effects import load_model

    check_outputs(json, html, force=force)
    loaded = load_model(model)
    training, held_out = read_pair(recordings, holdout)
    with progress(quiet) as tell:
        result = run(loaded, training, held_out, seed=seed, progress=staged(tell))
    inputs = [model, *recordings, *(holdout or [])]
    deliver(result, json=json, html=html, force=force, quiet=quiet, inputs=inputs, seeds={"noise": seed})
