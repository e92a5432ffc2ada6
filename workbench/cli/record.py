"""``workbench record``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from typer import Argument, Option

from workbench.core import InputError
from workbench.core.files import together

from . import complete, options
from .common import check_outputs, echo, write_result, wrote
from .hidden import HideOption, SetOption, hidden_effects

if TYPE_CHECKING:
    from workbench.frf import Design
    from workbench.rigs import Experiment, HiddenEffect

_RATE = 1000.0  # rows per second, of both rigs


def record(
    rig: Annotated[
        str,
        Argument(
            metavar="RIG",
            help="'leg', the virtual parallel leg; 'leg_on_plate', the same over a force plate; "
            "'actuator', its drive alone; a CAN file (.toml); or, with --virtual, a model of your own.",
            autocompletion=complete.rigs,
        ),
    ],
    experiments: Annotated[
        list[str] | None,
        Argument(
            metavar="EXPERIMENT...",
            help="Designs from 'excite' (.toml), or the leg's experiments; the demo's six if none is named.",
            autocompletion=complete.experiments,
        ),
    ] = None,
    output: Annotated[
        str,
        options.written(
            "--output", "-o", folder=True, metavar="FOLDER", help="Folder for the recordings.  [required]"
        ),
    ] = "",
    hide: HideOption = None,
    set_: SetOption = None,
    seed: Annotated[int, Option(min=0, help="Seed of the sensors' noise.")] = 0,
    virtual: Annotated[
        bool,
        Option(
            "--virtual",
            help="Virtual hardware made of the model; of a CAN file, virtual motors on modelled buses.",
        ),
    ] = False,
    yes: Annotated[bool, Option("--yes", help="Over CAN: move without asking.")] = False,
    from_logs: Annotated[
        bool, Option("--from-logs", help="Over CAN: rebuild recordings from interrupted logs in the folder.")
    ] = False,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Run experiments on a rig and write the recordings.

    Example: workbench record leg slow validation -o data --hide coulomb_friction@knee --set torque=0.25

    Example: workbench record robot.toml chirp.toml -o data --virtual

    Example: workbench record my_leg.toml chirp.toml -o data --virtual --hide backlash@knee --set gap=0.02
    """
    from .record_own import is_model, record_own

    if rig not in ("leg", "leg_on_plate", "actuator") and is_model(rig):
        if not virtual:
            raise InputError(
                f"'{rig}' is a model, not a machine",
                remedy="add --virtual for hardware that is made of it, or give a CAN file",
            )  # fmt: skip
        check_outputs(json, force=force)
        files = record_own(rig, experiments or [], output, (hide, set_), seed, force, quiet or json == "-")
        _tell(rig, experiments, output, files, seed, json, force, quiet)
        return
    over_can = rig.endswith(".toml")
    if rig not in ("leg", "leg_on_plate", "actuator") and not over_can:
        raise InputError(
            f"no rig is called '{rig}'",
            remedy="the built-in rigs are 'leg', 'leg_on_plate' and 'actuator'; or give a CAN configuration "
            "(.toml)",
        )
    if not output:
        raise InputError("no output folder", remedy="say where the recordings go: -o FOLDER")
    check_outputs(json, force=force)
    if over_can:
        from .record_can import record_logs, record_over_can

        if from_logs:
            files = record_logs(rig, experiments or [], Path(output), force)
        else:
            say = (lambda text: None) if quiet or json == "-" else echo
            files = record_over_can(
                rig, experiments or [], Path(output), (hide, set_), seed, (virtual, yes, force), say
            )
    elif rig == "actuator":
        if hide:
            raise InputError("the actuator's bench cannot hide an effect", remedy="hide it in the leg")
        files = _on_the_bench(experiments or [], Path(output), seed, force)
    else:
        hidden = hidden_effects(hide, set_)
        files = _with_the_leg(rig == "leg_on_plate", experiments, Path(output), hidden, seed, force)
    _tell(rig, experiments, output, files, seed, json, force, quiet)


def _tell(
    rig: str, experiments: Sequence[str] | None, output: str, files: Sequence[Path], seed: int,
    json: str | None, force: bool, quiet: bool,
) -> None:  # fmt: skip
    if json:
        designs = [Path(name) for name in [rig, *(experiments or [])] if name.endswith((".toml", ".xml"))]
        content = {"format": 1, "rig": rig, "recordings": [_recorded(file) for file in files]}
        write_result(content, json, files=designs, seeds={"noise": seed}, force=force)
    if not quiet and json != "-":
        wrote(f"Wrote {len(files)} recording{'s' * (len(files) != 1)} to {output}.")


def _recorded(file: Path) -> dict[str, Any]:
    """What a reader of the file gets, for programs."""
    from workbench.recordings import load_recording

    recording = load_recording(file)
    return {
        "name": recording.name,
        "file": str(file),
        "axes": list(recording.axes),
        "rows": len(recording.time),
        "valid_rows": int(recording.valid.sum()),
        "rate_hz": 1.0 / recording.period,
        "signals": list(recording.signals),
    }


def _with_the_leg(
    on_plate: bool, names: Sequence[str] | None, folder: Path, hidden: Sequence[HiddenEffect], seed: int,
    force: bool,
) -> list[Path]:  # fmt: skip
    """Experiments of the virtual leg, all or none; returns the recordings' files."""
    from workbench.rigs import Plate, VirtualLeg

    chosen = _on_the_plate(names, seed) if on_plate else _of_the_leg(names, seed)
    check_outputs(*(str(folder / f"{each.name}.toml") for each in chosen), force=force)
    leg = VirtualLeg(hidden, seed=seed, plate=Plate() if on_plate else None)
    return leg.record_to(folder, chosen, force=force)


def _of_the_leg(names: Sequence[str] | None, seed: int) -> list[Experiment]:
    """The leg's own experiments and designs, in the order named."""
    import numpy as np

    from workbench.rigs import Experiment, demo_experiments, revealing_experiments

    demo = demo_experiments(seed)
    known = {e.name: e for e in (*demo, *revealing_experiments())}
    chosen: list[Experiment] = []
    for name in names or [e.name for e in demo]:
        if name in known:
            chosen.append(known[name])
            continue
        if not name.endswith(".toml"):
            raise InputError(
                f"no experiment is called '{name}'",
                remedy=f"choose from {', '.join(known)}, or give a design (.toml)",
            )
        design = _design(name, 2)
        if not design.hold:
            raise InputError(
                "the design holds no posture", file=name, column="hold",
                remedy="make it with 'excite' for a model whose loop has a controller",
            )  # fmt: skip
        for k, trial in enumerate(design.trials):
            _, signals = design.play(k)
            reference = signals["position_reference"]
            push = signals.get("torque_feedforward", np.zeros_like(reference))
            chosen.append(Experiment(trial.name, reference, push, design.excitation(k)))
    return chosen


def _on_the_plate(names: Sequence[str] | None, seed: int) -> list[Experiment]:
    """Experiments of the leg over its force plate, in the order named; all where none is."""
    from workbench.rigs import plate_experiments

    known = {e.name: e for e in plate_experiments(seed)}
    for name in names or ():
        if name not in known:
            raise InputError(
                f"no experiment on the plate is called '{name}'", remedy=f"choose from {', '.join(known)}"
            )
    return [known[name] for name in names or known]


def _on_the_bench(names: Sequence[str], folder: Path, seed: int, force: bool) -> list[Path]:
    """Plays designs on the actuator's bench; returns the recordings' files."""
    from workbench.recordings import save_recording
    from workbench.rigs.bench import VirtualBench

    if not names:
        raise InputError("nothing to play", remedy="give a design: workbench excite actuator -o design.toml")
    recordings = []
    for name in names:
        design = _design(name, 1)
        for k, trial in enumerate(design.trials):
            _, signals = design.play(k)
            if "torque_feedforward" not in signals:
                raise InputError(
                    "the design plays positions", file=name, remedy="the bench has no loop: --drive torque"
                )
            command = {trial.name: signals["torque_feedforward"][:, 0]}
            recordings += VirtualBench(seed + len(recordings)).run(command, design.excitation(k))
    files = [folder / f"{recording.name}.toml" for recording in recordings]
    with together():
        for recording, file in zip(recordings, files, strict=True):
            save_recording(recording, file, compress=True, force=force)
    return files


def _design(name: str, axes: int) -> Design:
    """A design that a rig with this many axes can play.

    Raises:
        InputError: another number of axes, or another rate than the rigs'.
    """
    from workbench.frf import load_design

    design = load_design(Path(name))
    if len(design.axes) != axes or abs(design.rate_hz - _RATE) > 1e-6:
        raise InputError(
            f"a design of {len(design.axes)} axes at {design.rate_hz:g} Hz; the rig has {axes} at {_RATE:g}",
            file=name, remedy="design it for this rig's model, with --rate 1000",
        )  # fmt: skip
    return design
