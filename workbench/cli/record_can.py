"""``workbench record`` over CAN."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from workbench.core import InputError
from workbench.core.files import check_free

from .heartbeat import waiting
from .hidden import hidden_effects, hidden_in

if TYPE_CHECKING:
    from workbench.can import CanConfig
    from workbench.frf import Design
    from workbench.rigs import MotorBank


def record_over_can(
    rig: str, names: Sequence[str], folder: Path, hidden: tuple[str | None, Sequence[str] | None], seed: int,
    options: tuple[bool, bool, bool], say: Callable[[str], object],
) -> list[Path]:  # fmt: skip
    """Plays designs over CAN; returns the recordings' files.

    Raises:
        InputError: nothing to play, or for other axes.
    """
    from workbench.can import load_config
    from workbench.deployment import SimulatedNetwork
    from workbench.deployment.record import keep, record_live, record_simulated

    virtual, yes, force = options
    config = load_config(rig)
    designs = _for_axes(config.axes, names)
    if any(hidden) and not virtual:
        raise InputError("only virtual motors hide effects", remedy="add --virtual")
    make = virtual_motors(config, hidden, say) if virtual else None
    folder.mkdir(parents=True, exist_ok=True)
    files: list[Path] = []
    for design in designs:
        for k, trial in enumerate(design.trials):
            log = folder / f"{trial.name}.log"
            for file in (log, log.with_suffix(".clock"), log.with_suffix(".begun")):
                check_free(file, force=force)
                file.unlink(missing_ok=True)
            if virtual:
                assert make is not None
                bank = make(seed + len(files), None)
                result = record_simulated(config, design, k, log, SimulatedNetwork(config, bank))
            else:
                if not yes:
                    moves = f"'{trial.name}' moves {', '.join(config.axes)}. Is everybody clear?"
                    with waiting():
                        typer.confirm(moves, abort=True, err=True)
                result = record_live(config, design, k, log)
            files.append(keep(result, folder, log, force))
    return files


def virtual_motors(
    config: CanConfig, hidden: tuple[str | None, Sequence[str] | None], say: Callable[[str], object]
) -> Callable[[int, float | None], MotorBank]:
    """Makes virtual motors, of a seed and a row [s], that turn what the configuration's models are.

    Args:
        config: the buses and drives.
        hidden: an effect and its parameters, as the command line has them.
        say: told what the hardware is.

    Raises:
        InputError: an effect that the hardware cannot hide, or hardware that cannot be made of a model.
    """
    from workbench.importing import described, is_reference_leg, own_plants
    from workbench.models import read_model
    from workbench.rigs import MotorBank

    unknown = next((each for each in config.mechanism if each.transmission), None)
    if unknown:
        raise InputError(
            f"of {', '.join(unknown.axes)} only the transmission is known", file=config.source,
            column="mechanism.model", remedy="name the model that the virtual motors drive",
        )  # fmt: skip
    models = [read_model(each.model) for each in config.mechanism]
    if config.bench.rig == "quadruped" or all(map(is_reference_leg, models)):
        what = "quadruped" if config.bench.rig == "quadruped" else "leg on its stand" if models else ""
        if what:
            say(f"Virtual hardware: the reference {what}.")
        effects = hidden_effects(*hidden)
        return lambda seed, row: MotorBank(config, effects, seed=seed, row=row)
    for model in models:
        say(described(model))
    make = own_plants(hidden_in(*hidden))
    return lambda seed, row: MotorBank(config, seed=seed, row=row, make=make)


def record_logs(rig: str, names: Sequence[str], folder: Path, force: bool) -> list[Path]:
    """Recordings of the logs in a folder that belong to these designs, and to runs of `deploy`; their files.

    Raises:
        InputError: no such log is there, or nothing was played in one.
    """
    from workbench.can import load_config
    from workbench.deployment.kept import PLAYED
    from workbench.deployment.record import from_log, from_run, keep

    config, files = load_config(rig), list[Path]()
    for played in sorted(folder.glob(f"*{PLAYED}")):
        log = folder / f"{played.name.removesuffix(PLAYED)}.log"
        files.append(keep(from_run(config, log), folder, log, force))
    for design in _for_axes(config.axes, names) if names or not files else []:
        for k, trial in enumerate(design.trials):
            log = folder / f"{trial.name}.log"
            if log.is_file():
                files.append(keep(from_log(config, design, k, log), folder, log, force))
    if not files:
        raise InputError("no log of these experiments", file=folder, remedy="name the folder of the logs: -o")
    return files


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
