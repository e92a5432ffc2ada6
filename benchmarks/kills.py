"""Kills one process of a robot at a random moment, many times: drives must stop, logs must be readable.

    python benchmarks/kills.py --kills 100 --seed 0

Each time a bus, three virtual motors, a logger and a tracker are started as processes of their own, and one
of them is killed between verification and the third second. Then the motors must have driven no longer
without a command than their watchdog allows (and a row of theirs), the host must have ended with a fault
where it lost bus or motors, and the log must be readable to its last frame. (A logger that is killed takes
along what it had not yet written: on a busy machine that is some tenths of a second.)
"""

from __future__ import annotations

import argparse
import json
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from virtual_robot import four_legs

from workbench.can import load_config
from workbench.can.candump import packed, read_candump
from workbench.deployment.processes import end, start

#: Who is killed, and how; to a drive a host that is stopped is the same as one that is killed.
VICTIMS = (
    ("host", signal.SIGKILL), ("host", signal.SIGSTOP), ("motors", signal.SIGKILL),
    ("bus", signal.SIGKILL), ("logger", signal.SIGKILL),
)  # fmt: skip
WATCHDOG_S, ROW_S = 0.020, 0.0005
LATEST_S = 3.0  # of the bench: verification, arming, soft start and two seconds of motion


@dataclass(frozen=True)
class Outcome:
    """What was left behind.

    Attributes:
        victim: who was killed. after: how long after verification [s].
        longest: that a motor drove without a command [s]; NaN where the motors themselves were killed.
        driving: motors that still drove at the end.
        host: exit code of the host; None where it was killed.
        frames: in the log, every one of which can be read. late: from its last frame to the kill [s].
    """

    victim: str
    after: float
    longest: float
    driving: str
    host: int | None
    frames: int
    late: float

    @property
    def wrong(self) -> str:
        """What must not be, or nothing."""
        if self.longest > WATCHDOG_S + 2 * ROW_S:
            return f"driven {1e3 * self.longest:.1f} ms without a command"
        if self.driving not in ("none", "gone"):
            return f"still driving: {self.driving}"
        if self.victim in ("motors", "bus") and self.host != 1:
            return f"the host ended with {self.host}, not with a fault"
        return "" if self.frames else "nothing in the log"


def kill_once(folder: Path, time_scale: float, victim: str, how: signal.Signals, after: float) -> Outcome:
    """Starts everything in an empty folder, kills one, ends the others, and looks."""
    path, log = four_legs(folder, time_scale, legs=1), folder / "run.log"
    clock = load_config(path).clock
    running = {"bus": start("can", "bus", str(path))}
    try:
        running["logger"] = start("can", "log", str(path), "-o", str(log))
        running["motors"] = start("can", "motors", str(path))
        running["host"] = host = subprocess.Popen(
            [sys.executable, "-m", "workbench.cli", "deploy", "tracker", str(path), "--yes", "-o", ""],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert host.stderr
        while "watchdog" not in (line := host.stderr.readline()):
            assert line, "the host ended before it had verified its drives"
        time.sleep(clock.machine(after))
        at = clock.now()
        running[victim].send_signal(how)
        time.sleep(clock.machine(0.3))
        code, (longest, driving) = None, (float("nan"), "gone")
        if victim != "host":
            if victim == "logger":
                host.send_signal(signal.SIGINT)
            code = host.wait(timeout=60.0)
        if victim != "motors":
            longest, driving = _report(running["motors"])
    finally:
        for process in reversed(running.values()):
            if process.poll() is None and how == signal.SIGSTOP and process is running[victim]:
                process.kill()
            end(process)
    stamps = [frame.stamp for frame in read_candump(log)]
    frames = packed(log)[0]
    assert frames == len(stamps)
    shift = json.loads(log.with_suffix(".clock").read_text().splitlines()[0])["shift"]
    late = at + shift - stamps[-1] if stamps else float("inf")
    return Outcome(victim, after, longest, driving, code, frames, late)


def _report(motors: subprocess.Popen[str]) -> tuple[float, str]:
    """What the motors say of themselves when they are asked to end: longest silence [s], who drives."""
    if motors.poll() is None:
        motors.send_signal(signal.SIGTERM)
    said, _ = motors.communicate(timeout=60.0)
    found = re.search(r"longest without a command: ([\d.]+) ms; driving: (.*)", said)
    assert found, said
    return 1e-3 * float(found[1]), found[2]


def main() -> None:
    """Prints a line a victim; exit code 1 where anything went wrong."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--time-scale", type=float, default=2.0)
    arguments = parser.parse_args()
    # what was started in the background ignores interrupts, and so would all that it starts
    signal.signal(signal.SIGINT, signal.default_int_handler)
    generator, outcomes = np.random.default_rng(arguments.seed), list[Outcome]()
    for k in range(arguments.kills):
        victim, how = VICTIMS[generator.integers(len(VICTIMS))]
        after = float(generator.uniform(0.0, LATEST_S))
        with tempfile.TemporaryDirectory() as folder:
            outcomes.append(kill_once(Path(folder), arguments.time_scale, victim, how, after))
        if outcomes[-1].wrong:
            print(f"kill {k}: {victim} after {after:.2f} s: {outcomes[-1].wrong}")
    print("killed     times   longest without a command    frames in the log    last one before the kill")
    for victim, times in sorted(Counter(outcome.victim for outcome in outcomes).items()):
        own = [outcome for outcome in outcomes if outcome.victim == victim]
        longest = "" if victim == "motors" else f"{1e3 * max(o.longest for o in own):.1f} ms"
        frames = min(outcome.frames for outcome in own)
        late = f"at most {max(o.late for o in own):.2f} s" if victim == "logger" else ""
        print(f"{victim:10s} {times:5d}   {longest:>10s}                   {frames} or more         {late}")
    wrong = sum(bool(outcome.wrong) for outcome in outcomes)
    print(f"{wrong} of {arguments.kills} left a motor driven too long or a log that cannot be read")
    if wrong:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
