"""``workbench improve``."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from typer import Option

from workbench.core import Improvement, WorkbenchError

from . import options
from .common import check_model_output, files_of, keep_inputs, open_pair, wrote
from .data_problems import data_problems
from .deliver import Outputs, deliver
from .into import Into, IntoOption, check_into
from .progress import progress, staged


def improve(
    model: options.Model,
    recordings: options.Recordings,
    output: Annotated[str, options.written("--output", "-o", metavar="NEW", help="The improved model file.")],
    into: IntoOption = None,
    holdout: options.Holdout = None,
    json: options.Json = None,
    html: options.Html = None,
    mcap: options.Mcap = None,
    rerun: options.Rerun = None,
    nearest: Annotated[
        bool, Option("--nearest", help="If no cause can be named, add the effects that come nearest.")
    ] = False,
    whole: options.Whole = False,
    seed: options.Seed = 0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Diagnose and add until the data are explained; show the error falling, step by step.

    Example: workbench improve leg_kin_only *.toml --holdout validation.toml -o better.toml

    Into your own file: workbench improve arm.xml run.toml --into arm.xml -o arm_fixed.xml
    """
    from workbench.core.files import together
    from workbench.diagnosis import improve as run
    from workbench.effects import load_model
    from workbench.models import write_model

    if into is None:
        check_model_output(output, force=force)
    to = Outputs(json, html, mcap, rerun, force, quiet)
    to.check()
    loaded = load_model(model)
    if into is not None:
        check_into(loaded, into, output, force=force)
    data = open_pair(recordings, holdout, whole=whole)
    measured = [*data.training, *data.held_out]
    to.keep(files_of(loaded, measured))
    keep_inputs([output], files_of(None, measured))
    with progress(quiet) as tell:
        result, better = run(
            loaded, data.training, data.held_out, seed=seed, nearest=nearest, progress=staged(tell)
        )
    problems = data_problems(loaded, measured) if result.steps else ()
    written, refused = None, None
    with together():
        try:
            if not result.added:
                pass  # the model as it is says it already
            elif into is None:
                write_model(better, output, force=force)
            else:
                written = Into.of(loaded, better, into, output)
                written.write(force=force)
        except WorkbenchError as error:  # what was found in minutes is still told
            refused = error
        notes = [*problems, *result.notes, *data.notes, *(written.notes if written else ())]
        result = replace(result, used=data.share, notes=tuple(notes))
        more = written.as_dict if written else None
        deliver(result, to, files=files_of(loaded, measured), seeds={"noise": seed}, more=more)
    if refused is not None:
        raise refused
    if to.printed:
        wrote(_told(result, written, output))


def _told(result: Improvement, written: Into | None, output: str) -> str:
    """What was written, or that nothing was."""
    mended = len(result.added) < len(result.kept)
    if not result.added:
        why = "The model is not what is wrong" if mended else "Nothing was added"
        return f"{why}, so {output} was not written."
    lines = written.lines if written else [f"Wrote {output}."]
    return "\n".join([*lines, *(["Its error is as above once the gains are corrected."] if mended else ())])
