"""``workbench identify``: a drive, a parallel leg, or the links of any robot."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer
from typer import Option

from workbench.core import InputError

from . import complete, options
from .common import (
    check_model_output,
    check_outputs,
    files_of,
    keep_inputs,
    open_pair,
    read_recordings,
    whole,
    write_result,
    wrote,
)
from .deliver import deliver_sheet
from .into import check_into
from .listing import Listing
from .progress import progress

identify = typer.Typer(
    name="identify",
    cls=Listing,
    help="A drive, a parallel leg, or all links of a robot, from recordings, with intervals.",
    no_args_is_help=True,
    rich_markup_mode=None,
)

_Base = Annotated[
    str,
    Option(
        "--model",
        metavar="MODEL",
        help="The model that gets the numbers: a serial tree.",
        autocompletion=complete.models,
    ),
]
_Output = Annotated[str, options.written("--output", "-o", metavar="NEW", help="The new model file (.toml).")]
_Figure = Annotated[
    str | None,
    options.written(
        "--figure", format_="figure", metavar="FILE", help="Picture of response and fit (.png, .svg, .pdf)."
    ),
]


@identify.command()
@whole
def actuator(
    recordings: options.Recordings,
    model: _Base = "leg_kin_only",
    output: _Output = "",
    json: options.Json = None,
    html: options.Html = None,
    figure: _Figure = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Inertia, damping and delay of a drive on its own, from open-loop torque excitation.

    Example: workbench identify actuator bench/multisine.toml --model leg_kin_only -o with_actuator.toml
    """
    from workbench import report
    from workbench.identification import actuator_figure, actuator_sheet, identify_actuator, with_actuator
    from workbench.models import read_model, write_model

    from .identify_output import actuator_dict, actuator_table

    check_model_output(output, force=force)
    check_outputs(json, html, figure, force=force)
    base = read_model(model) if output else None
    data = read_recordings(recordings)
    found = identify_actuator(data)
    if base is not None:
        write_model(replace(with_actuator(base, found), name=Path(output).stem), output, force=force)
    if json:
        write_result(actuator_dict(found), json, files=files_of(base, data), force=force)
    if html:
        deliver_sheet(actuator_sheet(found), html, files=files_of(base, data), force=force)
    if figure:
        report.save_figure(actuator_figure(found), Path(figure), force=force)
    if not quiet and json != "-":
        report.print_table(actuator_table(found))
        if output:
            wrote(f"Wrote {output}: {model} with these drives.")


@identify.command()
@whole
def leg(
    recordings: options.Recordings,
    model: _Base = "leg_kin_only",
    actuator: Annotated[
        list[str] | None,
        Option(metavar="REC", help="Recordings of the actuator alone; default: the model's own numbers."),
    ] = None,
    output: _Output = "",
    json: options.Json = None,
    html: options.Html = None,
    figure: _Figure = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Total inertia of a parallel leg; with the actuators' share subtracted once, the S3N-Full model.

    Example: workbench identify leg sum.toml difference.toml --model leg_kin_only -o s3n_full.toml
    """
    from workbench import report
    from workbench.identification import (
        fit_figure,
        identify_actuator,
        identify_leg,
        leg_sheet,
        with_actuator,
        with_leg,
    )
    from workbench.models import read_model, write_model

    from .identify_output import leg_dict, leg_table

    check_model_output(output, force=force)
    check_outputs(json, html, figure, force=force)
    base = read_model(model)
    alone = read_recordings(actuator) if actuator else []
    if alone:
        base = with_actuator(base, identify_actuator(alone))
    data = read_recordings(recordings)
    if data[0].axes != base.axes:
        raise InputError(
            f"axes are {', '.join(data[0].axes)}, and those of model '{base.name}' {', '.join(base.axes)}",
            file=data[0].source, column="axes", remedy="name the model that the recordings are of: --model",
        )  # fmt: skip
    files = files_of(base, [*data, *alone])
    found = identify_leg(data, base.transmission)
    built = with_leg(base, found)
    if output:
        write_model(replace(built, name=Path(output).stem), output, force=force)
    if json:
        write_result(leg_dict(found, built), json, files=files, force=force)
    if html:
        deliver_sheet(leg_sheet(found, built), html, files=files, force=force)
    if figure:
        report.save_figure(fit_figure(found.fit), Path(figure), force=force)
    if not quiet and json != "-":
        report.print_table(leg_table(found, built))
        if output:
            wrote(f"Wrote {output}: {model} as S3N-Full.")


@identify.command()
@whole
def links(
    model: options.Model,
    recordings: options.Recordings,
    holdout: options.Holdout = None,
    output: Annotated[
        str,
        options.written(
            "--output", "-o", metavar="NEW", help="A copy of the model's .xml or .urdf with them."
        ),
    ] = "",
    json: options.Json = None,
    html: options.Html = None,
    figure: Annotated[
        str | None,
        options.written(
            format_="figure",
            metavar="FILE",
            help="Picture of the torque before and after (.png, .svg, .pdf).",
        ),
    ] = None,
    whole: options.Whole = False,
    seed: options.Seed = 0,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Masses, centres of mass and inertias of all links together, where several of them are wrong.

    Example: workbench identify links arm.xml slow.toml fast.toml --holdout check.toml -o arm_fixed.xml
    """
    from workbench import report
    from workbench.core.files import write_whole
    from workbench.effects import inertials_into_file, load_model
    from workbench.identification import identify_links, links_figure, links_sheet

    from .identify_output import links_dict, links_table

    loaded = load_model(model)
    if output:
        check_into(loaded, str(loaded.serial), output, force=force)
    check_outputs(json, html, figure, force=force)
    data = open_pair(recordings, holdout, whole=whole)
    files = files_of(loaded, [*data.training, *data.held_out])
    keep_inputs([output, json, html, figure], files)
    with progress(quiet) as tell:
        found = identify_links(loaded, data.training, data.held_out, seed=seed, progress=tell)
    if found.share <= 0.0:
        output = ""
    if output:
        new = {link.joint: link.after for link in found.links}
        write_whole(output, inertials_into_file(loaded, loaded.serial, new).content, force=force)
    if json:
        content = links_dict(found, output or None)
        write_result(content, json, files=files, seeds={"noise": seed}, force=force)
    if html:
        deliver_sheet(links_sheet(found), html, files=files, seeds={"noise": seed}, force=force)
    if figure:
        report.save_figure(links_figure(found), Path(figure), force=force)
    if not quiet and json != "-":
        report.print_table(links_table(found))
        if output:
            wrote(
                f"Wrote {output}: {loaded.serial.name} with these numbers. Next, find what else is missing:"
            )
            if loaded.source and loaded.source.suffix == ".toml":
                wrote(f"  name it as serial in a copy of {loaded.source.name}, and diagnose that model")
            else:
                wrote(f"  workbench diagnose {output} {' '.join(recordings)}")
    if found.share <= 0.0:
        raise typer.Exit(1)
