"""Runs an experiment over CAN: plays it, logs it, and makes a recording of the log."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from workbench.can import CanConfig
from workbench.can.candump import packed, read_candump
from workbench.can.realtime import realtime
from workbench.core import Excitation, InputError, Recording
from workbench.core.files import check_free
from workbench.frf import Design
from workbench.recordings import save_recording

from .alone import opened
from .frame_log import ProcessLog, WireLog
from .from_log import Played, recording
from .host import Host
from .joints import joints_of
from .kept import PLAYED
from .permitted import refuse_untested
from .player import Player
from .simulated import SimulatedNetwork
from .stopping import RunError, brought_down, on_hardware

_BEGUN = ".begun"
_GRACE = 5.0  # s for arming, soft start and settling


def play(host: Host, player: Player, begun: Callable[[float], None] = lambda time: None) -> None:
    """Arm, play to the end, damp and disable.

    Args:
        host: the loop, with the player as its controller.
        player: one experiment.
        begun: is told once when the first row is played [s].

    Raises:
        RunError: everything damped before the end.
    """
    said = False

    def each(host: Host, tick: int) -> bool:
        nonlocal said
        if player.begun is not None and not said:
            said = True
            begun(player.begun)
        return host.over or player.done(host.time)

    with brought_down(host):
        host.verify()
        host.operator.arm = True
        host.run(player.seconds + _GRACE, each)
        fault, done = host.state.fault, player.done(host.time)
    if not done:
        fault = f"stopped by {host.operator.pressed_by}" if host.operator.pressed_by else fault
        raise RunError(f"the experiment ended early: {fault or 'it never began'}")


def record_simulated(
    config: CanConfig, design: Design, experiment: int, log: Path, network: SimulatedNetwork | None = None
) -> Recording:
    """Play on virtual motors in simulated time.

    Args:
        config: buses and motors.
        design: what to play.
        experiment: which of its experiments.
        log: where the frames go; its stamps are simulated time.
        network: with motors of one's own.

    Raises:
        RunError: everything damped before the end.
    """
    network = network or SimulatedNetwork(config)
    frames = WireLog(network.wires, log)
    player = Player(design, experiment, config.loop.period_s)
    play(Host(config, network, player, joints_of(config)), player)
    frames.close()
    assert player.begun is not None
    return recording(config, read_candump(log), _played(design, experiment, player, player.begun))


def record_live(config: CanConfig, design: Design, experiment: int, log: Path) -> Recording:
    """Play on hardware; a separate process logs the frames and survives this one.

    Beside the log stands ``.begun``, the time of the first row: whatever happens from then on, `from_log`
    makes a recording of what was played.

    Raises:
        RunError: everything damped before the end; the log is there.
        VerifyError: a drive is not what the configuration says.
        InputError: a drive that may not stop by itself, or a bus that no other process hears.
    """
    refuse_untested(config)
    frames = ProcessLog(config, log)
    player = Player(design, experiment, config.loop.period_s)
    try:
        with opened(config) as network, realtime():
            host = Host(config, network, player, joints_of(config))
            frames.watch(host)
            with on_hardware(host, config):
                play(host, player, lambda at: _note(log, at + frames.shift))
    finally:
        frames.close()
    return from_log(config, design, experiment, log)


def from_log(config: CanConfig, design: Design, experiment: int, log: Path) -> Recording:
    """Return an interrupted experiment's recording, up to there, from its log and ``.begun`` file.

    Raises:
        InputError: it broke off before anything was played.
    """
    try:
        begun = float(log.with_suffix(_BEGUN).read_text())
    except (OSError, ValueError) as error:
        raise InputError("nothing was played in this log", file=log, remedy="record it again") from error
    player = Player(design, experiment, config.loop.period_s)
    try:
        return recording(config, read_candump(log), _played(design, experiment, player, begun))
    except InputError as error:
        raise InputError(error.problem, file=log, row=error.row, remedy=error.remedy) from error


def from_run(config: CanConfig, log: Path) -> Recording:
    """Return the recording of a run of `deploy`, from its log and the commands beside it.

    Raises:
        InputError: it never ran, or its base is free: where that was, no drive tells.
    """
    if config.imu:
        raise InputError(
            "the pose of its base is not known, so nothing can be compared", file=log,
            remedy="hold the base, and take [imu] out of the configuration",
        )  # fmt: skip
    try:
        with np.load(log.with_suffix(PLAYED)) as kept:
            rows = float(kept["begun"]), kept["reference"], kept["feedforward"]
    except (OSError, ValueError, KeyError) as error:
        raise InputError(
            "the robot never ran in this log",
            file=log,
            remedy="deploy for longer than the soft start: --seconds",
        ) from error
    try:
        return recording(config, read_candump(log), Played(log.stem, *rows, Excitation("policy")))
    except InputError as error:
        raise InputError(error.problem, file=log, row=error.row, remedy=error.remedy) from error


def keep(result: Recording, folder: Path, log: Path, force: bool) -> Path:
    """Write the recording, and its log as BLF beside it, all or nothing; return the TOML file."""
    path = folder / f"{result.name}.toml"
    for file in (path, path.with_suffix(".blf")):
        check_free(file, force=force)
    save_recording(result, path, force=force, beside={path.with_suffix(".blf"): packed(log)[1]})
    return path


def _played(design: Design, experiment: int, player: Player, begun: float) -> Played:
    name, excitation = design.trials[experiment].name, design.excitation(experiment)
    return Played(name, begun, player.reference, player.feedforward, excitation)


def _note(log: Path, begun: float) -> None:
    """When the first row was played, by the stamps of the log [s]."""
    log.with_suffix(_BEGUN).write_text(f"{begun:.6f}\n")
