"""``workbench import`` of an SDF or URDF: a model of a leg with a loop."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.core import InputError

from .common import echo, named_values, write_result, wrote
from .mechanism_options import MechanismOptions, frames_of, loop_of, number_of, one_each, range_of

if TYPE_CHECKING:
    from workbench.models import Model


def refuse_model(path: Path) -> None:
    """An MJCF without a loop needs no import.

    Raises:
        InputError: the file is one.
    """
    from workbench.importing import is_mjcf
    from workbench.models import load_with_loops

    if is_mjcf(path) and not any(equality.active for equality in load_with_loops(path).equalities):
        raise InputError(
            "it is an MJCF, which is a model already", file=path,
            remedy=f"use it as it is: workbench import LOG --model {path}, workbench compare {path} RUN.toml",
        )  # fmt: skip


def show_contents(path: Path, json: str | None, force: bool, quiet: bool) -> None:
    """Say which joints and frames a file has.

    Raises:
        InputError: it cannot be read.
    """
    from workbench.importing import contents_of

    found = contents_of(path)
    if json:
        content = {"format": 1, **vars(found), "couplings": [vars(each) for each in found.couplings]}
        write_result(content, json, files=[path], force=force)
    if not quiet and json != "-":
        echo(str(found))
        echo("Name drives and joints to make a model: --drive JOINT... --joint JOINT... -o MODEL.toml")


def import_mechanism(
    asked: MechanismOptions, output: str, axes: list[str] | None, json: str | None, force: bool, quiet: bool
) -> None:
    """Write a model of the mechanism, and say what it is.

    Raises:
        InputError: an option that is not of its form, or a mechanism that cannot be made of the file.
    """
    from workbench.core import Coupling, Mechanism
    from workbench.importing import Drives, assemblies, contents_of, import_model
    from workbench.mechanism import ClosedChain, constant_transmission
    from workbench.models import linkage_table

    path, serial = asked.file, tuple(asked.joints)
    contents = contents_of(path)
    if not output:
        raise InputError("no output file", remedy="say where the new model goes: -o MODEL.toml")
    own = {k: range_of(v) for k, v in named_values(asked.limits, "--limits", "knee=0.35:2.6").items()}
    stated, narrowed, begun = {**contents.limits, **own}, list[str](), list[str]()
    known = [name for name in serial if name in stated]
    if known and len(known) < len(serial):
        missing = next(name for name in serial if name not in stated)
        raise InputError(
            f"joint '{missing}' has no limits", file=path, remedy=f"give --limits {missing}=LOW:HIGH"
        )
    mechanism = Mechanism(
        file=path,
        drives=tuple(asked.drives),
        joints=serial,
        loops=tuple(frames_of(pair) for pair in asked.loops),
        foot=asked.foot,
        start=tuple((k, number_of(v)) for k, v in named_values(asked.start, "--start", "knee=1.2").items()),
        limits=tuple(stated[name] for name in serial) if known else (),
        couplings=tuple(
            Coupling(k, None, (number_of(v),))
            for k, v in named_values(asked.hold, "--hold", "shin=0").items()
        ),
    )
    names, count = asked.drives, len(asked.drives)
    gear = one_each(asked.gear, count, 1.0, "--gear")
    # of an MJCF a joint has at its output what motors have at the rotor
    inertia, damping = (
        [own.get(name, 0.0) / ratio**2 for name, ratio in zip(names, gear, strict=True)]
        for own in (contents.armature, contents.damping)
    )
    limits = {name: contents.torque_limit.get(name, float("inf")) for name in names}
    drives = Drives(
        gear,
        one_each(asked.rotor_inertia or inertia, count, 0.0, "--rotor-inertia"),
        one_each(asked.rotor_damping or damping, count, 0.0, "--rotor-damping"),
        one_each(asked.torque_limit or list(limits.values()), count, float("inf"), "--torque-limit"),
        asked.delay,
        tuple(contents.friction.get(name, 0.0) for name in names),
    )
    made = import_model(
        mechanism,
        drives,
        output,
        axes=axes,
        controller=loop_of(asked, count),
        hold_rest=asked.hold_rest,
        kept=tuple(own),
        tell=narrowed.append,
        tell_start=begun.append,
        force=force,
    )
    assert made.closed_chain is not None
    held = [c for c in made.closed_chain.couplings if c not in (*mechanism.couplings, *contents.couplings)]
    ways = assemblies(made.closed_chain)
    if json:
        content = {
            "format": 1,
            "model": made.name,
            "files": [output, *map(str, _beside(made, path, output))],
            "axes": list(made.axes),
            "joints": list(made.joints),
            "transmission": made.transmission.tolist(),
            "posture_dependent": made.posture_dependent,
            "linkage": None if made.linkage is None else linkage_table(made.linkage),
            "assemblies": vars(ways),
            "limits": [list(pair) for pair in made.closed_chain.limits],
            "limits_changed": narrowed,
            "start": begun,
        }
        write_result(content, json, files=[path], force=force)
    if quiet or json == "-":
        return
    kind = "changes with the posture" if made.posture_dependent else "is constant"
    if made.posture_dependent and constant_transmission(ClosedChain(made.closed_chain)).constant:
        kind = "is constant, but the links in the loops turn differently in each posture"
    beside = " and ".join(file.name for file in _beside(made, path, output))
    wrote(f"Wrote {output} and {beside}: the transmission {kind}: {made.transmission.tolist()}.")
    for line in (*contents.bonds, *begun):
        wrote(f"{line[0].upper()}{line[1:]}.")
    for line in narrowed:
        wrote(f"Limits: {line}. --limits JOINT=LOW:HIGH chooses others.")
    taken = {} if asked.torque_limit else {k: v for k, v in limits.items() if v < float("inf")}
    if taken:
        said = ", ".join(f"{name} {value:.4g}" for name, value in taken.items())
        wrote(f"Torque limits of the drives, from the file: {said}. --torque-limit states others.")
    if held:
        wrote(
            f"Held joints: {', '.join(f'{c.joint} = {round(c.polynomial[0], 9) + 0.0:.3g}' for c in held)}."
        )
    fixed = {c.joint for c in made.closed_chain.couplings if not c.follows}
    for what, unit in (("damping", "N m s/rad"), ("friction", "N m"), ("armature", "kg m²")):
        if lost := _without({*names, *fixed}, getattr(contents, what)):
            wrote(f"Not imported: the {what} of joints without a drive: {lost} {unit}.")
    if springs := set(contents.springs) - fixed:
        wrote(f"Not imported: springs at {', '.join(sorted(springs))}.")
    if made.linkage is not None:
        sizes = {k: v for k, v in vars(made.linkage).items() if k not in ("identified", "crank")}
        said = ", ".join(f"{k} = {v:.6g} {'kg m²' if k[0] == 'M' else 'N m'}" for k, v in sizes.items())
        wrote(f"The mechanism is a parallelogram; its linkage adds to the serial tree: {said}.")
    if str(ways) and made.linkage is None:  # a parallelogram's other way is its folded twin
        wrote(f"{ways}.")
    wrote(f"Next: workbench check {output}")


def _without(driven: Collection[str], values: Mapping[str, float]) -> str:
    """Joints that no motor drives and nothing holds, each with its value; empty where none has one."""
    return ", ".join(f"{name} {value:.3g}" for name, value in values.items() if value and name not in driven)


def _beside(made: Model, source: Path, output: str) -> list[Path]:
    """The files that came with a model file."""
    chain = made.closed_chain.file if made.closed_chain else source
    written = [made.serial, *([] if chain == source.resolve() else [chain])]
    return [Path(output).with_name(file.name) for file in written]
