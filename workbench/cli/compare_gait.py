"""``workbench compare --gait``: two recordings of a robot that walks, measured by what its gait shows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import typer

from workbench.core import InputError

from .common import check_outputs, echo, files_of, read_recordings, write_result

if TYPE_CHECKING:
    from workbench.gait import Limbs
    from workbench.models import Model


def compare_gait(
    model: str, recordings: Sequence[str], simulator: str, again: str | None, command: str | None,
    start: float, json: str | None, force: bool, quiet: bool,
) -> None:  # fmt: skip
    """Make every measure that the recordings allow, print them; exit 2 where one could not be made."""
    from workbench.effects import load_model
    from workbench.gait import compare_gaits
    from workbench.report import gait_dict, gait_table, print_table

    if len(recordings) != 1:
        raise InputError(
            "--gait compares one hardware recording", column="--gait",
            remedy="name it after the model, and another run of the hardware with --again",
        )  # fmt: skip
    check_outputs(json, force=force)
    loaded = load_model(model)
    data = read_recordings([*recordings, simulator, *([again] if again else [])])
    limbs, reason = _limbs(loaded)
    result = compare_gaits(*data, limbs=limbs, command=_pair(command), start_s=start)
    if not quiet and json != "-":
        print_table(gait_table(result))
    if json:
        write_result(gait_dict(result, reason), json, files=files_of(loaded, data), force=force)
    lacking = [*result.lacking, *([reason] if reason else [])]
    if lacking:
        echo(f"not computed: {' | '.join(lacking)}", err=True)
        raise typer.Exit(2)


def _limbs(model: Model) -> tuple[Limbs | None, str | None]:
    """Legs of the model for the swing leg's prediction, or why it has none."""
    from workbench.gait import limbs_of
    from workbench.models import load_mjcf

    feet = model.ground.feet if model.ground else ()
    try:
        if not feet:
            raise InputError(
                "the swing leg's prediction needs the feet", file=model.source, column="ground.feet",
                remedy="name the feet's geoms in [ground]",
            )  # fmt: skip
        n, compiled = len(model.driven), load_mjcf(model.serial).compile()
        names = {compiled.geom(k).name for k in range(compiled.ngeom)}
        if unknown := [foot for foot in feet if foot not in names]:
            raise InputError(
                f"foot {unknown[0]} is not a geom of the model", file=model.source, column="ground.feet",
                remedy="give the feet's geoms a name",
            )  # fmt: skip
        return limbs_of(compiled, model.joints[:n], model.transmission[:n, :n], feet), None
    except InputError as error:
        return None, str(error)


def _pair(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        forward, yaw = (float(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(
            f"'{text}' is not two numbers", column="--command",
            remedy="e.g. --command 0.8,0.8 in m/s and rad/s",
        ) from error  # fmt: skip
    return forward, yaw
