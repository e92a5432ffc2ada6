"""``workbench excite``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from typer import Option

from workbench.core import InputError
from workbench.core.text import counted

from . import options
from .common import check_outputs, files_of, write_result, wrote
from .progress import progress
from .values import parse_values

if TYPE_CHECKING:
    from workbench.frf import Scaled

#: Options that draw or shape a multisine, and say nothing of a sweep.
_OF_MULTISINES = "grid", "per_decade", "phases", "realisations", "seed"


def excite(
    ctx: typer.Context,
    model: options.Model,
    output: Annotated[
        str,
        options.written(
            "--output",
            "-o",
            ending=".toml",
            metavar="DESIGN",
            help="The TOML file of the design; its tables go into the same folder.  [required]",
        ),
    ] = "",
    kind: Annotated[Literal["multisine", "chirp"], Option(help="Kind of excitation.")] = "multisine",
    drive: Annotated[
        Literal["torque", "position"], Option(help="Add torque to the feedback, or move its reference.")
    ] = "torque",
    amplitude: Annotated[
        list[float] | None,
        Option(
            help="RMS of a multisine or amplitude of a chirp [N m or rad]; one, or one per axis. Scaled down "
            "to the limits."
        ),
    ] = None,
    f_min: Annotated[float, Option(help="Lowest frequency [Hz].")] = 0.2,
    f_max: Annotated[float, Option(help="Highest frequency [Hz].")] = 60.0,
    period: Annotated[float, Option(help="Period, or length of a sweep [s].")] = 5.0,
    periods: Annotated[int, Option(help="Periods that are evaluated; default for a chirp: 1.")] = 4,
    transient: Annotated[int, Option(help="Periods before these, to settle; default for a chirp: 0.")] = 1,
    rate: Annotated[float, Option(help="Rows per second.")] = 1000.0,
    grid: Annotated[
        Literal["full", "odd", "odd_random"],
        Option(help="Which lines; odd_random leaves some unexcited, to detect nonlinearity."),
    ] = "full",
    per_decade: Annotated[
        int | None, Option(help="Lines per decade, nearly even in log frequency; default: all lines.")
    ] = None,
    phases: Annotated[
        Literal["schroeder", "low_crest", "random"], Option(help="Phases of the lines.")
    ] = "schroeder",
    realisations: Annotated[
        int, Option(help="Number of sets of experiments, each with new random phases.")
    ] = 1,
    mixing: Annotated[
        Literal["orthogonal", "single"],
        Option(help="All axes in every experiment, or one at a time (the default for a chirp)."),
    ] = "orthogonal",
    posture: Annotated[
        list[str] | None,
        Option(
            metavar="name=value",
            help="Position reference to hold, per joint or axis of the loop [rad or m]; "
            "default: the middle of its range.",
        ),
    ] = None,
    loop: Annotated[
        str | None,
        Option(metavar="REC", help="Recording whose [controller] is used in place of the model's own."),
    ] = None,
    speed_limit: Annotated[
        list[float] | None, Option(help="Largest speed [rad/s or m/s]; one, or one per axis.")
    ] = None,
    seed: Annotated[int, Option(min=0, help="Seed of phases and unexcited lines.")] = 0,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Design an excitation for every axis of a model, small enough for its limits.

    Example: workbench excite leg -o leg_multisine.toml --amplitude 0.9 --amplitude 0.54 --speed-limit 40
    """
    from workbench import frf
    from workbench.effects import load_model
    from workbench.simulation import (
        check_held,
        held_posture,
        limits_of,
        predictor,
        whole_period,
        with_loop_of,
    )

    if not output:
        raise InputError("no output file", remedy="say where the design goes: -o DESIGN.toml")
    given = {name for name in ctx.params if _given(ctx, name)}
    if kind == "chirp" and (idle := [name for name in _OF_MULTISINES if name in given]):
        said = ", ".join(f"--{name.replace('_', '-')}" for name in idle)
        raise InputError(f"a chirp has no {said}", remedy="leave it out, or use --kind multisine")
    check_outputs(output, json, force=force)
    loaded = load_model(model).on_its_stand("an excitation of its drives")
    loaded = with_loop_of(loaded, loop) if loop else loaded
    asked = {name: value.value for name, value in parse_values(posture or []).items()}
    hold = held_posture(loaded, asked)
    size = amplitude or [1.0 if drive == "torque" else 0.1]
    name, driven = Path(output).stem, "torque_feedforward" if drive == "torque" else "position_reference"
    length = whole_period(loaded, period, rate)
    # a longer period has its first line a little lower
    common = {
        "f_min_hz": f_min * min(1.0, period / length),
        "f_max_hz": f_max,
        "rate_hz": rate,
        "hold": hold,
        "name": name,
    }
    if kind == "multisine":
        design = frf.multisine(
            loaded.axes,
            **common,
            period_s=length,
            rms=size if len(size) > 1 else size[0],
            grid=grid,
            per_decade=per_decade,
            phases=phases,
            mixing=mixing,
            realisations=realisations,
            periods=periods,
            transient_periods=transient,
            driven=driven,
            fade_s=min(0.5, 0.5 * length) if transient and drive == "position" else 0.0,
            seed=seed,
        )
    else:
        design = frf.chirp(
            loaded.axes,
            **common,
            duration_s=length,
            amplitude=size if len(size) > 1 else size[0],
            mixing=mixing if "mixing" in given else "single",
            periods=periods if "periods" in given else 1,
            transient_periods=transient if "transient" in given else 0,
            driven=driven,
        )
    with progress(quiet) as say:
        say("simulating the design and scaling it to the limits")
        limits = limits_of(loaded, speed_limit)
        check_held(loaded, design, limits)
        scaled = frf.scale_to_limits(design, predictor(loaded, limits), limits)
    files = frf.save_design(scaled.design, output, force=force)
    if json:
        read = [*files_of(loaded), *([Path(loop)] if loop else [])]
        write_result(_summary(scaled, files), json, files=read, seeds={"phases": seed}, force=force)
    if quiet or json == "-":
        return
    d = scaled.design
    seconds = d.rows / d.rate_hz
    wrote(
        f"Wrote {output}: {counted(len(d.trials), 'experiment')} of {seconds:.4g} s, {len(d.lines)} lines "
        f"from {d.frequency[0]:.4g} to {d.frequency[-1]:.4g} Hz, "
        f"crest factor up to {d.crest_factors.max():.3g}."
    )
    if length != period:
        wrote(f"The period is {length:.9g} s: a whole number of rows and of the controller's ticks.")
    if scaled.binding is None:
        wrote("The model states no limits: nothing was scaled.")
    else:
        kept = f"Scaled to {scaled.factor:.3g} of" if scaled.factor < 1 else "Left at"
        share = 100 * scaled.usage[scaled.binding]
        wrote(
            f"{kept} the requested amplitude: the tightest limit is {scaled.binding}, of which "
            f"{share:.3g} % is used."
        )


def _given(ctx: typer.Context, name: str) -> bool:
    """Whether an option was given, be it with the value that it has anyway."""
    source = ctx.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _summary(scaled: Scaled, files: Sequence[Path]) -> dict[str, Any]:
    """The result for programs."""
    d = scaled.design
    return {
        "format": 1,
        "files": [str(f) for f in files],
        "factor": scaled.factor,
        "binding": None
        if scaled.binding is None
        else {"quantity": scaled.binding.quantity, "name": scaled.binding.name},
        "usage": [
            {"quantity": limit.quantity, "name": limit.name, "share": share}
            for limit, share in scaled.usage.items()
        ],
        "period_s": d.period_s,
        "lines": len(d.lines),
        "crest_factors": d.crest_factors.tolist(),
        "rms": [float(x) ** 0.5 for x in (d.experiments**2).mean(axis=1).max(axis=0)],
    }
