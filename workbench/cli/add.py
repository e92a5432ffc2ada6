"""``workbench add``."""

from __future__ import annotations

import json as json_format
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from workbench.core import FORMAT, InputError, apart
from workbench.core.files import check_format

from . import complete, options
from .common import check_model_output, check_outputs, files_of, write_result, wrote
from .into import Into, IntoOption, check_into
from .values import parse_lists, parse_place, with_values

_AS_IN_MJCF = "friction_as_in_mjcf"  # no effect, but how the friction that the model has sets in


def add(
    model: options.Model,
    effect: Annotated[
        str | None,
        Argument(
            metavar="EFFECT[@AXIS]",
            help="The effect, e.g. coulomb_friction@knee; coulomb_friction@knee(joint): at the joint.",
            autocompletion=complete.effects,
        ),
    ] = None,
    values: Annotated[
        list[str] | None,
        Argument(metavar="name=value...", help="Parameters, SI.", autocompletion=complete.values),
    ] = None,
    output: Annotated[
        str, options.written("--output", "-o", metavar="NEW", help="The new model file.  [required]")
    ] = "",
    into: IntoOption = None,
    diagnosis: Annotated[
        str | None,
        Option(
            "--from",
            metavar="DIAGNOSIS",
            help="Take its parameters, or all findings, from the JSON of a diagnosis.",
        ),
    ] = None,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Write a new model file with an effect in it.

    Example: workbench add leg coulomb_friction@knee torque=0.25 -o leg_with_friction.toml

    Into your own file: workbench add arm.xml --from found.json --into arm.xml -o arm_fixed.xml
    """
    from workbench.effects import effect_named, load_model
    from workbench.models import write_model
    from workbench.report import effect_dict
    from workbench.report.wording import any_of, effect_phrases

    if not output:
        raise InputError("no output file", remedy="say where the new model goes: -o NEW")
    if effect is None and diagnosis is None:
        raise InputError("no effect", remedy="name one, e.g. coulomb_friction@knee, or give --from DIAGNOSIS")
    if into is None:
        check_model_output(output, force=force)
    check_outputs(json, force=force)
    loaded = load_model(model)
    if into is not None:
        check_into(loaded, into, output, force=force)
    if effect == _AS_IN_MJCF:
        if into is not None:
            raise InputError(f"{_AS_IN_MJCF} is not a number in a file", remedy="omit --into")
        added, new = [], soft(loaded, values, diagnosis)
        what = "dry friction as soft as its MJCF states it"
    else:
        added, new = with_effects(loaded, effect, values, diagnosis)
        # keys of a file or of the command line do not say at which site
        keys = [replace(a.key, site=effect_named(a.key.effect).site(loaded)) for a in added]
        what = any_of(effect_phrases(keys), "and")
    new = replace(new, name=Path(output).stem)
    written = Into.of(loaded, new, into, output) if into is not None else None
    if written is None:
        write_model(new, output, force=force)
    else:
        written.write(force=force)
    if json:
        content = {
            "format": FORMAT,
            "model": new.name,
            "from": loaded.name,
            "file": output,
            **(written.as_dict if written else {}),
            "effects": [effect_dict(a.key, a.parameters) for a in added],
        }
        read = [*files_of(loaded), *([Path(diagnosis)] if diagnosis else [])]
        write_result(content, json, files=read, force=force)
    if quiet or json == "-":
        return
    if written is not None:
        wrote("\n".join([*written.lines, *(f"Note: {note}." for note in written.notes)]))
        return
    wrote(f"Wrote {output}: {loaded.name} with {what}.")


def with_effects(
    model: Any, effect: str | None, values: list[str] | None, diagnosis: str | None
) -> tuple[list[Any], Any]:
    """Return the named effect, or all that a diagnosis found, and the model with them.

    Raises:
        InputError: an effect, a place or a value that is none, or a diagnosis without it.
    """
    from workbench.effects import Structural, check_effect, effect_named
    from workbench.models import AppliedEffect, structural_effect

    found = read_findings(diagnosis) if diagnosis else []
    if effect:
        wanted = parse_place(effect)
        match = [f for f in found if f.key.same_place(wanted)]
        base = match[0] if match else AppliedEffect(wanted, {})
        if diagnosis and not match:
            raise InputError(f"the diagnosis has no finding {wanted}", file=diagnosis)
        structural = isinstance(known := effect_named(wanted.effect), Structural) and known.parameters
        if not base.parameters and not values and structural:
            base = structural_effect(wanted.effect, model.linkage)
        found = [AppliedEffect(f.key, dict(f.parameters)) for f in match or [base]]
        if values:
            found = with_values(found, parse_lists(values))
    new = settled(model, diagnosis, found) if diagnosis else model
    added = []
    for applied in found:
        added.append(check_effect(new, applied))
        new = new.with_effect(added[-1])
    return added, new


def soft(model: Any, values: list[str] | None, diagnosis: str | None) -> Any:
    """Return the model whose dry friction is as soft as MuJoCo's constraint of its MJCF.

    Raises:
        InputError: something was given beside it, or the MJCF states no dry friction.
    """
    from workbench.models import own_friction

    if values or diagnosis:
        raise InputError(f"{_AS_IN_MJCF} has no parameters", remedy="leave out the parameters given with it")
    if not own_friction(model):
        raise InputError(
            f"model '{model.name}' has no dry friction of its own", file=model.source,
            remedy="state frictionloss in its MJCF, or add coulomb_friction",
        )  # fmt: skip
    return replace(model, friction_as_in_mjcf=True)


def settled(model: Any, path: str, found: Sequence[Any]) -> Any:
    """Return the model with the model settings that a diagnosis fitted together with the added findings.

    Raises:
        InputError: the JSON says something else there than a diagnosis does.
    """
    from workbench.effects import with_settled

    try:
        own = json_format.loads(Path(path).read_text()).get("settled", {})
        return with_settled(model, own, [f.key for f in found])
    except (ValueError, TypeError, AttributeError) as error:
        raise InputError(
            "'settled' is not as a diagnosis writes it", file=path, remedy="make it with 'diagnose --json'"
        ) from error


def read_findings(path: str) -> list[Any]:
    """Return findings of a diagnosis' JSON as effects.

    Raises:
        InputError: no such file, not a diagnosis, or one without findings.
    """
    from workbench.models import AppliedEffect

    try:
        content = json_format.loads(Path(path).read_text())
        check_format(content, FORMAT, path)
        if "steps" in content and "findings" not in content:
            raise InputError(
                "the JSON of an improvement", file=path,
                remedy="the model that improve writes (-o, --into) has its effects; or give diagnose's JSON",
            )  # fmt: skip
        rows = content["findings"]
        found = [AppliedEffect(key, values) for row in rows for key, values in apart(row)]
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=path) from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(
            "not the JSON of a diagnosis", file=path, remedy="make it with 'diagnose --json'"
        ) from error
    if not found:
        raise InputError("the diagnosis has no findings", file=path, remedy="there is nothing to add")
    return found
