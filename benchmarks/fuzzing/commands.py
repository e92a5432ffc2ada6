"""Spoilt files given to commands: what a person at a terminal would see of them."""

from __future__ import annotations

import contextlib
import io
import os
import subprocess
import sys
import tempfile
import time
import zlib
from collections import Counter
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from limits import TooLong, at_most

from . import mutate
from .case import Bench, Outcome, told

#: Kind -> commands that its files are given to; a simulation of the reference leg where there is one.
COMMANDS: dict[str, tuple[str, ...]] = {
    "recording": (
        "inspect run.toml", "compare leg run.toml --json out.json", "frf leg run.toml --json out.json",
        "identify leg run.toml --json out.json", "diagnose leg run.toml --json out.json",
    ),
    "import": ("import {file} -o out.toml --yes", "import {file} -o out.toml --json out.json"),
    "model TOML": (
        "check leg.toml --json out.json", "add leg.toml viscous_damping@hip damping=0.1 -o out.toml",
        "normalize leg.toml -o out.xml", "excite leg.toml --kind chirp -o out/design.toml",
        "train reach --model leg.toml --envs 4 --iterations 1 -o out",
    ),
    "MJCF": ("normalize leg.toml -o out.xml", "check leg.toml --json out.json"),
    "SDF": ("import leg.sdf -o out.toml --drive hip --drive crank_pin --joint hip --joint knee --foot foot "
            "--loop coupler_end:rear_arm_end",),
    "URDF": ("import leg.urdf -o out.toml --drive hip --drive knee --joint hip --joint knee",),
    "CAN configuration": ("can load robot.toml --json out.json", "can dbc robot.toml -o out.dbc",
                          "deploy tracker robot.toml --dry-run --seconds 1 --json out.json"),
    "CAN log": ("inspect run.toml", "import run{ending} -o out.toml --yes"),
    "MCAP": ("import {file} -o out.toml --yes",),
    "ROS 2 bag": ("import bag -o out.toml --yes",),
    "LeRobot": ("import set -o out.toml --yes",),
    "excitation": ("record leg design.toml -o out",),
    "bundle": ("evaluate reach.zip -o out --seconds 1.5",),
    "record": ("train reach --record leg.record.json --model leg --envs 4 --iterations 1 -o out",),
    "checkpoint": ("export run -o out.zip",),
}  # fmt: skip
_PROCESSES = 20  # every so many cases goes through a process of its own


def through_cli(names: list[str], seed: int, first: int, count: int) -> tuple[Counter[str], list, float]:
    """Endings, failures and CPU seconds of `count` cases, spread evenly over the kinds that commands take."""
    names = [name for name in names if _commands(name)]
    endings, failures, before = Counter[str](), [], time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        # before any command runs here: it leaves out imports that writing these files needs
        benches = [_bench(name, Path(folder) / str(i)) for i, name in enumerate(names)]
        for i, (name, bench) in enumerate(zip(names, benches, strict=True)):
            for number in range(first + i * count // len(names), first + (i + 1) * count // len(names)):
                outcome = _case(bench, name, seed, number)
                endings[outcome.ending] += 1
                if outcome.ending == "failed":
                    failures.append((number, f"{name}: {outcome.text}"))
    return endings, failures, time.process_time() - before


def _bench(name: str, folder: Path) -> Bench:
    folder.mkdir()
    return Bench(name, folder)


def _commands(name: str) -> tuple[str, ...]:
    return next((commands for start, commands in COMMANDS.items() if name.startswith(start)), ())


def _case(bench: Bench, name: str, seed: int, number: int) -> Outcome:
    random = np.random.default_rng([seed, zlib.crc32(name.encode()), number, 1])
    bench.lay()
    how = bench.spoil(random)
    file = next(iter(bench.kind.spoil))
    words = str(mutate.pick(random, _commands(name))).format(file=file, ending=name.rpartition(" ")[2])
    before = {p.name for p in bench.work.iterdir()}
    here = Path.cwd()
    os.chdir(bench.work)
    try:
        run = _process if number % _PROCESSES == 0 else _here
        code, out, err = run(words.split())
    except TooLong:
        return Outcome("failed", f"{how}: workbench {words}: took longer than a minute")
    except BaseException as error:
        return Outcome("failed", f"{how}: workbench {words}: {told(error)}")
    finally:
        os.chdir(here)
    wrong = _wrong(code, out, err, {p.name for p in bench.work.iterdir()} - before)
    text = f"{how}: workbench {words}: exit {code}: {wrong or err.strip()[-200:]}"
    return Outcome("failed" if wrong else "refused" if code == 2 else "accepted", text)


def _wrong(code: Any, out: str, err: str, new: set[str]) -> str:
    """What must not be, or nothing."""
    lines = [line for line in err.splitlines() if line.strip()]
    strange = [line for line in out.splitlines() + lines if not line.isprintable()]
    if code not in (0, 1, 2):
        return f"exit code {code}: {err[-300:]!r}"
    if "Traceback" in err or "Warning" in err:
        return f"not for people: {err[-300:]!r}"
    if code == 2 and (len(lines) != 1 or not lines[0].startswith("error: ")):
        return f"not one line: {err[:300]!r}"
    if code == 2 and new:
        return f"refused, but wrote {sorted(new)[:3]}"
    if strange:
        return f"not printable: {strange[0][:200]!r}"
    left = sorted(n for n in new if not n.startswith("out"))
    return f"left {left}" if left else ""


def _here(words: list[str]) -> tuple[Any, str, str]:
    """The command line in this process."""
    from workbench.cli import main

    out, err = io.StringIO(), io.StringIO()
    code: Any = 0
    with (
        mock.patch.object(sys, "argv", ["workbench", *words]),
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        at_most(60.0, cpu=True),
    ):
        try:
            main()
        except SystemExit as end:
            code = end.code or 0
    return code, out.getvalue(), err.getvalue()


def _process(words: list[str]) -> tuple[Any, str, str]:
    """The command line in a process of its own."""
    command = [sys.executable, "-m", "workbench.cli", *words]
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=120.0, stdin=subprocess.DEVNULL
        )
    except subprocess.TimeoutExpired as error:
        raise TooLong from error
    return done.returncode, done.stdout, done.stderr
