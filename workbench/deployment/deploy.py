"""Runs a controller on hardware, or on virtual motors, and reports the punctuality of the loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.bundle import Policy, PolicyBundle
from workbench.can import CanConfig, bus_load
from workbench.can.realtime import realtime
from workbench.core import InputError

from .alone import opened
from .budget import budget
from .command import Command
from .controller import Controller
from .host import Host
from .joints import Joints, joints_of
from .kept import Kept, logged
from .network import Network
from .permitted import permitted
from .policies import PolicyController, Tracker, check_bundle, reach_between
from .processors import Crowd
from .stopping import brought_down, on_hardware
from .teleop import teleoperated
from .trained import trained_of

if TYPE_CHECKING:
    from .simulated import SimulatedNetwork


def controller_of(
    bundle: PolicyBundle | None, config: CanConfig, joints: Joints, seed: int,
    command: Command | None = None,
) -> Controller:  # fmt: skip
    """Return the policy of the bundle, or a tracker without a bundle.

    Raises:
        InputError: the bundle is not for this robot and loop.
    """
    loop = config.loop
    if bundle is None:
        low, high = _finite(joints, config)
        return Tracker(reach_between(low, high, 0.5 * (low + high), seed))
    check_bundle(bundle, config, joints)
    own = bundle.control
    low, high = own.joint_limits.T
    policy = Policy(bundle)
    goal = reach_between(low, high, own.posture, seed)
    made = PolicyController(bundle, policy, goal, loop.policy_every, loop.period_s, loop.hold_s, command)
    made.rehearse()  # the first call is the slowest: not in the loop
    return made


def deploy(
    config: CanConfig,
    bundle: PolicyBundle | None,
    seconds: float,
    *,
    seed: int = 0,
    twist: Sequence[float] = (0.0, 0.0, 0.0),
    unapproved: bool = False,
    watchdogs_tested: bool = False,
    teleop: str = "",
    network: SimulatedNetwork | Callable[[], SimulatedNetwork] | None = None,
    confirm: Callable[[], object] = lambda: None,
    log: Path | None = None,
    cpu: int | None = None,
    say: Callable[[str], None] = lambda line: None,
) -> dict[str, Any]:
    """Verify, arm, run for some time, damp, and disable.

    Args:
        config: the robot.
        bundle: its policy; None for a trajectory tracker.
        seconds: how long it runs once it is armed.
        seed: of the trajectory.
        twist: forward, sideward and turning speed that a policy is to reach and keep [m/s, m/s, rad/s].
        unapproved: a person takes it upon themselves that the policy was not approved.
        watchdogs_tested: a person has seen every drive stop by itself.
        teleop: how to ask for other speeds while it runs: ``keys``, ``udp:PORT`` or nothing.
        network: virtual motors of a dry run, or what makes them: no bus is touched.
        confirm: is called when all is in order that can be checked without a bus; asks a person.
        log: where its frames go, and beside them what was asked for; `record.from_run` makes a recording.
        cpu: processor to stay on.
        say: gets a status line now and then.

    Returns:
        What happened: ``fault`` (None for none), ``fault_axes`` (whose), ``stopped`` and ``stopped_by``,
        punctuality, ``notes`` (what the run was held to), ``lacks`` (which budgets of time).

    Raises:
        InputError: a bus that can get too full, a bundle that does not fit or is not approved, or a dry run
            that is to be steered.
        VerifyError: a drive is not what the configuration says.
        RunError: something that nobody foresaw; the drives were damped and disabled.
    """
    if teleop and network is not None:
        raise InputError(
            "a dry run uses simulated time and cannot be steered", column="--teleop",
            remedy="leave it out, or give --velocity",
        )  # fmt: skip
    for load in bus_load(config):
        if not load.fits:
            raise InputError(
                f"bus '{load.bus}' can get {100 * load.share:.0f} % full", file=config.source,
                remedy="use more buses or a longer period",
            )  # fmt: skip
    joints = joints_of(config)
    command = Command(np.array(twist, float))
    controller = controller_of(bundle, config, joints, seed, command)
    limits, notes = permitted(
        config, bundle, dry=network is not None, unapproved=unapproved, tested=watchdogs_tested
    )
    bounds = None if bundle is None else trained_of(bundle)
    if bounds is not None:
        command.asked, clipped = bounds.clipped(command.asked)
        notes += [clipped] if clipped else []

    def clip(asked: np.ndarray) -> np.ndarray:
        return np.zeros(3) if bounds is None else bounds.clipped(asked)[0]

    for note in notes:
        say(note)
    confirm()
    if callable(network):
        network = network()
    lacks: list[str] = []
    driver, frames = controller, None
    with ExitStack() as stack:
        if log is not None:
            driver = Kept(controller, joints, config.loop.period_s, seconds)
            wires = None if network is None else network.wires
            frames = stack.enter_context(logged(config, log, driver, wires))
        if network is not None:
            result = run_host(Host(config, network, driver, joints, limits), network, seconds, say)
            return {**result, "notes": notes, "lacks": lacks}
        with opened(config) as ports, realtime(cpu) as refused:
            host = Host(config, ports, driver, joints, limits)
            if frames:
                frames.watch(host)
            with on_hardware(host, config), teleoperated(teleop, command, clip, ports.now) as watches:
                host.operator.watches += watches

                def rehearse(host: Host) -> None:
                    lacks.extend(budget(host, config, controller, say, refused, Crowd()))

                result = run_host(host, ports, seconds, say, rehearse)
    return {**result, "notes": notes, "lacks": lacks}


def run_host(
    host: Host, network: Network, seconds: float, say: Callable[[str], None] = lambda line: None,
    before: Callable[[Host], object] = lambda host: None,
) -> dict[str, Any]:  # fmt: skip
    """Verify, arm, run, and end one loop; see `deploy`.

    Args:
        host: the loop.
        network: its own.
        seconds: how long it runs once it is armed.
        say: gets lines.
        before: is called when every drive was verified, and none is enabled.
    """
    said = network.now()

    def each(host: Host, tick: int) -> bool:
        nonlocal said
        if network.now() >= said + 1.0:
            said = network.now()
            say(status(host))
        return host.over

    with brought_down(host):
        for told in host.verify():
            say(told.line)
        before(host)
        host.operator.arm = True
        host.run(seconds, each)
        words = [host.feedback.fault[k] for k in host.state.axes]
        fault, axes, armed = host.state.fault, host.state.axes, host.state.phase != "off"
    operator = host.operator
    if operator.stop:
        fault, axes = "emergency stop", ()
    elif not armed and fault is None:
        fault = "it was never armed"
    return {
        "fault": fault, "fault_axes": [host.axes[k] for k in axes],
        "fault_words": words if fault == "a drive reports a fault" else [],
        "stopped": operator.stop, "stopped_by": operator.pressed_by or None, **host.punctuality.summary(),
    }  # fmt: skip


def status(host: Host) -> str:
    """Return one line: phase, punctuality, temperature."""
    p, hottest = host.punctuality, np.nanmax(np.append(host.feedback.temperature, -273.0))
    fault = f" ({host.state.fault})" if host.state.fault else ""
    return (
        f"{host.state.phase}{fault}  ticks {p.ticks}  missed {100 * p.missed:.2f} %  "
        f"round trip {1e3 * p.percentile(50):.2f}/{1e3 * p.percentile(99):.2f} ms  hottest {hottest:.0f} degC"
    )


def _finite(joints: Joints, config: CanConfig) -> tuple[np.ndarray, np.ndarray]:
    """Limits (n,) of the joints, by those of the axes where a joint states none [rad]."""
    axes = np.array([motor.limits.position for motor in config.motor])
    low = np.where(np.isfinite(joints.low), joints.low, axes[:, 0])
    return low, np.where(np.isfinite(joints.high), joints.high, axes[:, 1])
