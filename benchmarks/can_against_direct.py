"""Identifies drive and leg from a chirp recorded over CAN and from the same chirp recorded directly.

    python benchmarks/can_against_direct.py

Over CAN the loop, the buses and the drives' protocols stand between design and recording, in simulated time;
directly the virtual leg and the actuator's bench log themselves. Both are to give the same inertia, damping,
delay and inertia matrix M_p within their 95 % intervals, those over CAN no wider than 1.5 times the others.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path

import tomli_w

from workbench.can import load_config
from workbench.core import Estimate, Recording
from workbench.deployment.record import record_simulated
from workbench.deployment.simulated import SimulatedNetwork
from workbench.frf import Design, chirp
from workbench.identification.identify import identify_actuator, identify_leg
from workbench.rigs import Experiment, MotorBank, VirtualLeg
from workbench.rigs.bench import VirtualBench
from workbench.rigs.experiments import HOLD

WIDEST = 1.5
_RANGES = {"position": 12.5, "velocity": 45.0, "torque": 25.0, "source": "of the virtual drives"}


def main() -> None:
    """Prints a line a parameter; exit code 1 where one differs, or is less certain than it may be."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--periods", type=int, default=4)
    arguments = parser.parse_args()
    wrong = 0
    print("             over CAN                 direct                   apart      wider")
    for name, (ours, theirs) in compare(arguments.seed, arguments.periods).items():
        apart, wider = apart_and_wider(ours, theirs)
        wrong += apart > 1.0 or wider > WIDEST
        print(f"{name:10s}   {_text(ours):22s}   {_text(theirs):22s}   {apart:5.2f}      {wider:5.2f}")
    print(f"{wrong} of them differ, or are more than {WIDEST} times as wide")
    if wrong:
        raise SystemExit(1)


def compare(seed: int, periods: int) -> dict[str, tuple[Estimate, Estimate]]:
    """Each parameter over CAN and direct."""
    over, direct = _actuator(seed, periods)
    mine, theirs = identify_actuator(over), identify_actuator(direct)
    found = {
        "J": (mine.inertia, theirs.inertia), "B": (mine.damping, theirs.damping),
        "T_d": (mine.delay, theirs.delay),
    }  # fmt: skip
    over, direct = _leg(seed, periods)
    leg, other = identify_leg(over), identify_leg(direct)
    for key in ("M11", "M12", "M22"):
        found[key] = (getattr(leg, key), getattr(other, key))
    return {**found, "T_d leg": (leg.delay, other.delay)}


def apart_and_wider(ours: Estimate, theirs: Estimate) -> tuple[float, float]:
    """Difference over both half widths, below 1 where the 95 % intervals overlap; ratio of the widths."""
    reach = 1.96 * (ours.std + theirs.std)
    return float(abs(ours.value - theirs.value) / reach), float(ours.std / theirs.std)


def _actuator(seed: int, periods: int) -> tuple[list[Recording], list[Recording]]:
    design = chirp(
        ("motor",), f_min_hz=2.0, f_max_hz=60.0, duration_s=3.0, rate_hz=1000.0, amplitude=2.0,
        periods=periods, transient_periods=1, driven="torque_feedforward", name="actuator",
    )  # fmt: skip
    _, signals = design.play(0)
    command = {"actuator": signals["torque_feedforward"][:, 0]}
    direct = VirtualBench(seed).run(command, design.excitation(0))
    free = {"position": [-12.0, 12.0], "velocity": 44.0, "torque": 24.0}
    return _over_can(design, seed, {"motor": free}, {"kp": 0.0, "kd": 0.0}), direct


def _leg(seed: int, periods: int) -> tuple[list[Recording], list[Recording]]:
    design = chirp(
        ("hip", "knee"), f_min_hz=1.0, f_max_hz=60.0, duration_s=3.0, rate_hz=1000.0,
        # so small that the leg is linear to within its noise: intervals then hold noise, and nothing else
        amplitude=(0.6, 0.4), mixing="orthogonal", periods=periods, transient_periods=1,
        driven="torque_feedforward", hold=tuple(HOLD), name="leg",
    )  # fmt: skip
    trials = []
    for k, trial in enumerate(design.trials):
        _, signals = design.play(k)
        trials.append(
            Experiment(
                trial.name, signals["position_reference"], signals["torque_feedforward"], design.excitation(k)
            )
        )
    limits = {
        "hip": {"position": [-1.6, 1.6], "velocity": 40.0, "torque": 24.0},
        "knee": {"position": [-1.3, 4.0], "velocity": 40.0, "torque": 24.0},
    }
    return _over_can(design, seed, limits, {}), VirtualLeg((), seed=seed).run(trials)


def _over_can(
    design: Design, seed: int, limits: Mapping[str, object], loop: Mapping[str, float]
) -> list[Recording]:
    motors = [
        {"axis": axis, "bus": f"can{k}", "protocol": "damiao", "id": k + 1, "reply_id": 17 + k,
         "ranges": _RANGES, "limits": own}
        for k, (axis, own) in enumerate(limits.items())
    ]  # fmt: skip
    mechanism = [{"model": "leg", "axes": list(limits)}] if len(limits) == 2 else []
    bus = [
        {"name": f"can{k}", "interface": "workbench", "channel": f"can{k}.sock"} for k in range(len(motors))
    ]
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "robot.toml"
        content = {"format": 1, "bus": bus, "motor": motors, "mechanism": mechanism,
                   "loop": {"polls": 3, **loop}}  # fmt: skip
        path.write_text(tomli_w.dumps(content))
        config = load_config(path)
        return [
            record_simulated(
                config, design, k, Path(name) / f"{k}.log",
                SimulatedNetwork(config, MotorBank(config, seed=seed + k + 1)),
            )
            for k in range(len(design.trials))
        ]  # fmt: skip


def _text(estimate: Estimate) -> str:
    return f"{estimate.value:.5g} ± {1.96 * estimate.std:.2g}"


if __name__ == "__main__":
    main()
