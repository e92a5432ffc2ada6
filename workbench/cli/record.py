"""``workbench record``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from workbench.core import InputError
from workbench.core.files import check_free

from .app import app
from .common import ForceOption, QuietOption, echo
from .hidden import HideOption, SetOption, hidden_effects

if TYPE_CHECKING:
    from workbench.frf import Design
    from workbench.rigs import Experiment, HiddenEffect

_RATE = 1000.0  # rows a second, of both rigs


@app.command()
def record(
    rig: Annotated[
        str,
        typer.Argument(
            metavar="RIG",
            help="'leg', the virtual parallel leg; 'leg_on_plate', the same over a force plate; "
            "'actuator', its drive alone; or a CAN file (.toml).",
        ),
    ],
    experiments: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="EXPERIMENT...",
            help="Designs from 'excite' (.toml), or the leg's experiments; the demo's six if none is named.",
        ),
    ] = None,
    output: Annotated[
        str, typer.Option("--output", "-o", metavar="FOLDER", help="Folder for the recordings.")
    ] = "",
    hide: HideOption = None,
    set_: SetOption = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the sensors' noise.")] = 0,
    virtual: Annotated[
        bool, typer.Option("--virtual", help="Over CAN: virtual motors on modelled buses, in simulated time.")
    ] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Over CAN: move without asking.")] = False,
    from_logs: Annotated[
        bool,
        typer.Option("--from-logs", help="Over CAN: of the folder's logs that broke off."),
    ] = False,
    force: ForceOption = False,
    quiet: QuietOption = False,
) -> None:
    """Run experiments on a rig and write the recordings.

    Example: workbench record leg slow validation -o data --hide coulomb_friction@knee --set torque=0.25

    Example: workbench record robot.toml chirp.toml -o data --virtual
    """
    from workbench.rigs import Plate, VirtualLeg

    over_can = rig.endswith(".toml")
    if rig not in ("leg", "leg_on_plate", "actuator") and not over_can:
        raise InputError(
            f"no rig is called '{rig}'",
            remedy="the built-in rigs are 'leg', 'leg_on_plate' and 'actuator'; or give a CAN configuration "
            "(.toml)",
        )
    if not output:
        raise InputError("no output folder", remedy="say where the recordings go: -o FOLDER")
    hidden = hidden_effects(hide, set_)
    if over_can:
        if from_logs:
            count = _from_logs(rig, experiments or [], Path(output), force)
        else:
            count = _over_can(rig, experiments or [], Path(output), hidden, seed, (virtual, yes, force))
    elif rig == "actuator":
        if hide:
            raise InputError("the actuator's bench hides nothing", remedy="hide it in the leg")
        count = _on_the_bench(experiments or [], Path(output), seed, force)
    else:
        on_plate = rig == "leg_on_plate"
        chosen = _on_the_plate(experiments, seed) if on_plate else _of_the_leg(experiments, seed)
        leg = VirtualLeg(hidden, seed=seed, plate=Plate() if on_plate else None)
        count = len(leg.record_to(output, chosen, force=force))
    if not quiet:
        echo(f"Wrote {count} recordings to {output}.")


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


def _on_the_bench(names: Sequence[str], folder: Path, seed: int, force: bool) -> int:
    """Plays designs on the actuator's bench; returns how many recordings were written."""
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
    folder.mkdir(parents=True, exist_ok=True)
    for recording in recordings:
        save_recording(recording, folder / f"{recording.name}.toml", compress=True, force=force)
    return len(recordings)


def _over_can(
    rig: str, names: Sequence[str], folder: Path, hidden: Sequence[HiddenEffect], seed: int,
    options: tuple[bool, bool, bool],
) -> int:  # fmt: skip
    """Plays designs over CAN; returns how many recordings were written.

    Raises:
        InputError: nothing to play, or for other axes.
    """
    from workbench.can import load_config
    from workbench.deployment import SimulatedNetwork
    from workbench.deployment.record import keep, record_live, record_simulated
    from workbench.rigs import MotorBank

    virtual, yes, force = options
    config = load_config(rig)
    designs = _for_axes(config.axes, names)
    if hidden and not virtual:
        raise InputError("only virtual motors hide effects", remedy="add --virtual")
    folder.mkdir(parents=True, exist_ok=True)
    count = 0
    for design in designs:
        for k, trial in enumerate(design.trials):
            log = folder / f"{trial.name}.log"
            for file in (log, log.with_suffix(".clock"), log.with_suffix(".begun")):
                check_free(file, force=force)
                file.unlink(missing_ok=True)
            if virtual:
                bank = MotorBank(config, hidden, seed=seed + count)
                result = record_simulated(config, design, k, log, SimulatedNetwork(config, bank))
            else:
                if not yes:
                    typer.confirm(
                        f"'{trial.name}' moves {', '.join(config.axes)}. Is everybody clear?", abort=True
                    )
                result = record_live(config, design, k, log)
            keep(result, folder, log, force)
            count += 1
    return count


def _from_logs(rig: str, names: Sequence[str], folder: Path, force: bool) -> int:
    """Recordings of the logs in a folder that belong to these designs; returns how many.

    Raises:
        InputError: no log of these designs is there, or nothing was played in one.
    """
    from workbench.can import load_config
    from workbench.deployment.record import from_log, keep

    config, count = load_config(rig), 0
    for design in _for_axes(config.axes, names):
        for k, trial in enumerate(design.trials):
            log = folder / f"{trial.name}.log"
            if log.is_file():
                keep(from_log(config, design, k, log), folder, log, force)
                count += 1
    if not count:
        raise InputError("no log of these experiments", file=folder, remedy="name the folder of the logs: -o")
    return count


def _for_axes(axes: tuple[str, ...], names: Sequence[str]) -> list[Design]:
    """Designs that play exactly these axes.

    Raises:
        InputError: none is named, or one is for other axes.
    """
    from workbench.frf import load_design

    if not names:
        raise InputError("nothing to play", remedy="give a design: workbench excite MODEL -o design.toml")
    designs = []
    for name in names:
        designs.append(load_design(Path(name)))
        if designs[-1].axes != axes:
            raise InputError(
                f"plays {', '.join(designs[-1].axes)}; the configuration has {', '.join(axes)}", file=name,
                remedy="design it for a model of these axes",
            )  # fmt: skip
    return designs


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
