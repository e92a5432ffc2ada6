"""Runs a tracker over CAN across processes, 12 virtual motors on 4 buses, beside a bare loop.

    python benchmarks/control_loop.py                                 # 60 s, ten times slower than real time
    python benchmarks/control_loop.py --seconds 10 --time-scale 1

Bus, motors and loop are three processes on one clock. With a time scale of 10 that clock runs ten times
slower than real time, and with it buses, drives, watchdogs and limits: a virtual machine whose processor is
taken away for tens of milliseconds now and then cannot keep a limit of 9 ms otherwise. The bare loop keeps
the same pace, sends twelve packets over a socket and waits until another process has sent them back: what the
machine costs whatever one does. All times are those of the bench's clock.
"""

from __future__ import annotations

import argparse
import json
import socket
import subprocess
import sys
import tempfile
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from virtual_robot import four_legs

from workbench.can.clock import Clock
from workbench.can.packets import SIZE, pack
from workbench.deployment import Punctuality
from workbench.deployment.processes import virtual_hardware

PERIOD, MOTORS = 0.003, 12


def main() -> None:
    """Prints a line for the loop and one for the bare loop; exit code 1 where a fault ended the run."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--time-scale", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    result = tracker(arguments.seconds, arguments.time_scale, arguments.seed)
    for line in result["lacks"]:
        print(f"said before it began: not enough time: {line}")
    trip = result["round_trip_ms"]
    print("                 round trip p50 / p99    missed ticks")
    _line("over CAN", trip["p50"], trip["p99"], result["missed_share"])
    bare = bare_loop(min(arguments.seconds, 15.0), Clock(arguments.time_scale))
    _line("bare loop", 1e3 * bare.percentile(50), 1e3 * bare.percentile(99), bare.missed)
    print(
        f"{PERIOD * (result['ticks'] + result['skipped']):.1f} s in {result['ticks']} ticks, "
        f"{result['incomplete']} without every answer, {result['stalls']} stalls, "
        f"{result['sent_again']} of {MOTORS * result['ticks']} commands sent again"
    )
    print(f"ended by a fault: {result['fault']}" if result["fault"] else "no fault")
    if result["fault"]:
        raise SystemExit(1)


def tracker(seconds: float, time_scale: float, seed: int) -> dict:
    """What ``workbench deploy tracker`` says of a run."""
    with tempfile.TemporaryDirectory() as name:
        config, out = four_legs(Path(name), time_scale), Path(name) / "run.json"
        with virtual_hardware(config):
            words = ["deploy", "tracker", str(config), "--yes", "--quiet", "--json", str(out)]
            words += ["--seconds", str(seconds), "--seed", str(seed), "-o", str(Path(name) / "kept")]
            subprocess.run([sys.executable, "-m", "workbench.cli", *words], check=False)
        return json.loads(out.read_text())


def bare_loop(seconds: float, clock: Clock) -> Punctuality:
    """Ticks that send twelve packets and wait for them to come back."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    echo = get_context("fork").Process(target=_echo, args=(theirs, ours), daemon=True)
    echo.start()
    theirs.close()
    said, packet = Punctuality(), pack(b"S")
    begin, tick, last = clock.now() + PERIOD, 0, round(seconds / PERIOD)
    while tick < last:
        at = begin + tick * PERIOD
        clock.sleep_until(at)
        sent = clock.now()
        said.late.append(sent - at)
        for _ in range(MOTORS):
            ours.send(packet)
        for _ in range(MOTORS):
            ours.recv(SIZE)
        # as in the loop over CAN: what is not back within its tick is no round trip, but a missed tick
        if (trip := clock.now() - sent) < PERIOD:
            said.round_trips.append(trip)
        else:
            said.incomplete += 1
        following = max(tick + 1, int(np.ceil((clock.now() - begin) / PERIOD)))
        said.skipped += following - tick - 1
        tick = following
    ours.close()
    echo.join()
    return said


def _echo(end: socket.socket, other: socket.socket) -> None:
    other.close()
    while packet := end.recv(SIZE):
        end.send(packet)


def _line(name: str, p50: float, p99: float, missed: float) -> None:
    print(f"{name:12s}     {p50:5.2f} / {p99:5.2f} ms          {100 * missed:.2f} %")


if __name__ == "__main__":
    main()
