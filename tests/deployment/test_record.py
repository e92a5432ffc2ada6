"""Experiments over CAN: the recording is what a direct one would be, gaps are masked, other logs survive."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.can.make import config, motor, table, written
from tests.deployment.robot import LIMITS, RANGES
from workbench.can import CanConfig, load_config
from workbench.can.candump import Logged, read_candump
from workbench.cli.app import app
from workbench.core import InputError
from workbench.deployment import Host, SimulatedNetwork, joints_of
from workbench.deployment.from_log import Played, recording
from workbench.deployment.player import Player
from workbench.deployment.processes import virtual_hardware
from workbench.deployment.record import from_log, keep, play, record_simulated
from workbench.frf import Design, estimate, multisine, save_design
from workbench.identification import fit_actuator
from workbench.recordings import load_recording
from workbench.rigs.bench import VirtualBench

FREE = {"position": [-12.0, 12.0], "velocity": 44.0, "torque": 24.0}
PERIOD = 0.999  # s, whole rows and ticks


def actuator(folder: Path, **loop: object) -> CanConfig:
    loop = {"soft_start_s": 0.1, "kp": 0.0, "kd": 0.0, "polls": 3, **loop}
    return config(folder, [motor("motor", 1, limits=FREE, ranges=RANGES)], loop=loop)


def leg(folder: Path, **loop: object) -> CanConfig:
    motors = [motor(axis, k + 1, limits=LIMITS, ranges=RANGES) for k, axis in enumerate(("hip", "knee"))]
    return config(folder, motors, mechanism=[{"model": "leg", "axes": ["hip", "knee"]}],
                  loop={"soft_start_s": 0.1, **loop})  # fmt: skip


def design(axes: tuple[str, ...] = ("motor",), hold: tuple[float, ...] = (), rms: float = 3.0) -> Design:
    return multisine(
        axes, f_min_hz=1.0, f_max_hz=60.0, rate_hz=1000.0, hold=hold, name="m", period_s=PERIOD, rms=rms,
        periods=4, transient_periods=1, driven="torque_feedforward", seed=0,
        mixing="single" if len(axes) == 1 else "orthogonal",
    )  # fmt: skip


def test_over_can_the_actuator_is_the_same_as_on_its_bench(tmp_path: Path) -> None:
    played = design()
    over_can = record_simulated(actuator(tmp_path), played, 0, tmp_path / "m.log")
    _, signals = played.play(0)
    [direct] = VirtualBench(0).run({"m": signals["torque_feedforward"][:, 0]}, played.excitation(0))
    fits = [fit_actuator(estimate([each])) for each in (over_can, direct)]
    for name, tight in (("inertia", 2e-5), ("damping", 2e-4), ("delay", 2e-5)):
        ours, theirs = (fit.parameters[name] for fit in fits)
        spread = np.hypot(ours.std, theirs.std)
        assert abs(ours.value - theirs.value) < max(4 * spread, tight * 0.1), (name, ours, theirs)
        assert ours.std < 1.5 * theirs.std, name
    assert fits[0].parameters["delay"].value == pytest.approx(0.003, abs=2e-5), "one period, made by the loop"


def test_a_leg_over_can_is_read_back(tmp_path: Path) -> None:
    played = design(("hip", "knee"), (-0.55, 1.0472), 0.6)
    log = tmp_path / "leg.log"
    result = record_simulated(leg(tmp_path), played, 0, log)
    assert result.valid.all() and result.period == pytest.approx(0.003)
    assert result.controller.kind == "pd" and result.controller.coordinates == "joint"
    # what was commanded is the PD of what was measured, plus what was injected, to the steps of the frames
    q, w, f = result.position, result.velocity, result.signals["torque_feedforward"]
    joints, speed = (
        np.column_stack([q[:, 0], q[:, 1] - q[:, 0]]),
        np.column_stack([w[:, 0], w[:, 1] - w[:, 0]]),
    )
    pd = 50.0 * (result.signals["position_reference"] - joints) - 1.5 * speed
    wanted = np.column_stack([pd[:, 0] - pd[:, 1], pd[:, 1]]) + f
    assert np.abs(wanted - result.signals["torque_command"])[5:-5].std() < 0.08
    # and the drive's torque is that of the tick before
    late = result.signals["torque_command"][:-1] - result.signals["torque_measured"][1:]
    assert late.std() < 0.05
    path = keep(result, tmp_path, log, force=False)
    back = load_recording(path)
    assert np.allclose(back.position, result.position) and path.with_suffix(".blf").stat().st_size > 10_000


def played_by(
    config: CanConfig, played: Design, held_up: Callable[[SimulatedNetwork, Player], None] | None = None
) -> tuple[list[Logged], Played]:
    """Frames of an experiment in simulated time, and what was played; `held_up` may keep the loop away."""
    network, player = SimulatedNetwork(config), Player(played, 0, config.loop.period_s)
    frames: list[Logged] = []
    network.wires["can0"].attach("logger", lambda stamp, frame: frames.append(Logged(stamp, "can0", frame)))
    if held_up:
        held_up(network, player)
    play(Host(config, network, player, joints_of(config)), player)
    assert player.begun is not None
    return frames, Played("m", player.begun, player.reference, player.feedforward, played.excitation(0))


def test_what_is_missing_is_masked_and_not_held(tmp_path: Path) -> None:
    loaded = actuator(tmp_path, polls=1)
    frames, spec = played_by(loaded, design())
    generator = np.random.default_rng(5)
    kept = [f for f in frames if f.frame.id != 0x11 or generator.random() > 0.05]
    whole, gappy = recording(loaded, frames, spec), recording(loaded, kept, spec)
    assert whole.valid.all() and 0.03 < 1.0 - gappy.valid.mean() < 0.07
    first = int(np.argmin(np.abs(whole.position[:50, 0] - gappy.position[0, 0])))
    error = np.abs(gappy.position[:, 0] - whole.position[first : first + len(gappy), 0])
    assert error[gappy.valid].max() < 2e-3, "what was measured stays, to microseconds of the spline's clock"
    held = np.abs(np.diff(gappy.position[:, 0]))[~gappy.valid[1:]]
    assert np.median(held) > 0.0, "a gap is bridged, not held"


@pytest.mark.parametrize(
    "make, late", [(actuator, 0.0028), (actuator, 0.005), (actuator, 0.012), (leg, 0.0028)]
)
def test_what_a_loop_sent_that_was_held_up_is_masked(
    tmp_path: Path, make: Callable[..., CanConfig], late: float
) -> None:
    loaded = make(tmp_path, polls=1)
    played = design() if make is actuator else design(("hip", "knee"), (-0.55, 1.0472), 0.6)

    def held_up(network: SimulatedNetwork, player: Player) -> None:
        sleep, done = network.sleep_until, set[int]()

        def sleep_late(time: float) -> None:
            tenth = int(10 * (time - player.begun)) if player.begun is not None else 0
            if tenth not in done and tenth % 3 == 1:
                done.add(tenth)
                time += late
            sleep(time)

        network.sleep_until = sleep_late

    frames, spec = played_by(loaded, played, held_up)
    result = recording(loaded, frames, spec)
    assert 0.9 < result.valid.mean() < 0.999, "some is masked, most is not"
    q, w, f = result.position, result.velocity, result.signals["torque_feedforward"]
    if make is leg:
        joints, speed = (np.column_stack([x[:, 0], x[:, 1] - x[:, 0]]) for x in (q, w))
        pd = 50.0 * (result.signals["position_reference"] - joints) - 1.5 * speed
        f = f + np.column_stack([pd[:, 0] - pd[:, 1], pd[:, 1]])
    off = np.abs(result.signals["torque_command"] - f)[result.valid]
    assert off.max() < (0.02 if make is actuator else 0.6), "what was sent is what was to be played"


def test_what_broke_off_in_its_first_period_has_none(tmp_path: Path) -> None:
    played, loaded = design(), actuator(tmp_path, polls=1)
    frames, spec = played_by(loaded, played)
    whole = recording(loaded, frames, spec)
    cut = recording(loaded, [f for f in frames if f.stamp < spec.begun + 0.4], spec)
    log = tmp_path / "m.log"
    log.write_text("")
    short = load_recording(keep(cut, tmp_path, log, force=False))
    assert short.excitation == replace(whole.excitation, period_s=None)
    assert 0.1 < len(short) * short.period < PERIOD


def test_a_design_off_the_ticks_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="whole number of rows"):
        Player(replace(design(), rate_hz=500.0), 0, 0.003)


def test_a_log_without_the_axis_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text("")
    played = Played("m", 0.0, np.zeros((100, 1)), np.zeros((100, 1)), design().excitation(0))
    with pytest.raises(InputError, match="no feedback of 'motor'"):
        recording(actuator(tmp_path), read_candump(path), played)


def test_a_live_experiment_is_recorded_and_a_killed_one_kept(tmp_path: Path) -> None:
    content = table([motor("motor", 1, limits=FREE, ranges=RANGES)], bench={"time_scale": 8.0},
                    loop={"soft_start_s": 0.1, "kp": 0.0, "kd": 0.0})  # fmt: skip
    content["bus"][0]["channel"] = str(tmp_path / "can0")
    path, data = written(tmp_path, content), tmp_path / "data"
    played = multisine(
        ("motor",), f_min_hz=2.0, f_max_hz=60.0, rate_hz=1000.0, name="m", period_s=0.501, rms=3.0, periods=2,
        transient_periods=0, driven="torque_feedforward", seed=0, mixing="single",
    )  # fmt: skip
    save_design(played, tmp_path / "m.toml")
    words = ["record", str(path), str(tmp_path / "m.toml"), "--yes", "-o"]
    log = tmp_path / "killed" / f"{played.trials[0].name}.log"
    with virtual_hardware(path):
        for _ in range(4):  # asked for anew where a busy machine held feedback up
            done = CliRunner().invoke(app, [*words, str(data), "--force"])
            if done.exit_code == 0 or "no feedback" not in str(done.exception):
                break
        assert done.exit_code == 0, (done.output, done.exception)
        whole = load_recording(data / f"{played.trials[0].name}.toml")
        killed = subprocess.Popen([sys.executable, "-m", "workbench.cli", *words, str(log.parent)])
        while not log.with_suffix(".begun").exists():
            assert killed.poll() is None
            time.sleep(0.05)
        time.sleep(load_config(path).clock.machine(0.5))
        killed.kill()
        killed.wait()
        time.sleep(4.0)  # its logger ends by itself
        size = log.stat().st_size
        time.sleep(0.5)
        assert log.stat().st_size == size
    assert CliRunner().invoke(app, [*words, str(log.parent), "--from-logs"]).exit_code == 0
    rest = load_recording(log.with_suffix(".toml"))
    assert 0.1 < len(rest) * rest.period < 0.95 < len(whole) * whole.period
    for each in (whole, rest):
        assert each.valid.mean() > 0.9
        played_again = each.signals["torque_command"] - each.signals["torque_feedforward"]
        assert np.abs(played_again[each.valid]).max() < 0.02, "what was sent is what was to be played"


def test_a_log_in_which_nothing_was_played_is_refused(tmp_path: Path) -> None:
    (tmp_path / "m.log").write_text("")
    with pytest.raises(InputError, match="nothing was played"):
        from_log(actuator(tmp_path), design(), 0, tmp_path / "m.log")
