"""Spoils valid files in every way that is easily thought of: of each, one clear line or sound data may come.

    python benchmarks/fuzz.py --count 100000 --seed 0
    python benchmarks/fuzz.py --kinds 'model TOML,MJCF' --count 2000
    python benchmarks/fuzz.py --count 0 --through-cli 1000

Of every case is asked that it is accepted and what was read is valid and finite, or that it is refused by an
error of one printable line that names the file; that nothing was written; that nothing else was said on the
terminal; that it took less than 10 s of CPU time and 3 GiB. Cases are read in processes of their own: one
that crashes or hangs is a failure, and the rest goes on. A case can be made again:
--kinds KIND --first NUMBER --count 1.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import select
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from fuzzing.case import SECONDS, Bench
from fuzzing.commands import through_cli
from fuzzing.kinds import KINDS
from joblib import Parallel, delayed

_CHUNK = 1500
_LOADING = 600.0  # s in which a process has loaded its libraries, on a machine that is busy
_ROOM = 3 * 2**30  # bytes of address space above what the libraries take


@dataclass
class Tally:
    """What came of the cases of one kind."""

    endings: Counter[str] = field(default_factory=Counter)
    failures: list[tuple[int, str]] = field(default_factory=list)
    cpu_s: float = 0.0

    def add(self, other: Tally) -> None:
        """Count the other's cases too."""
        self.endings += other.endings
        self.failures += other.failures
        self.cpu_s += other.cpu_s


def work(name: str, seed: int, first: int, count: int) -> None:
    """Read cases one by one; a line of JSON before and after each."""
    os.environ["WORKBENCH_FUZZ"] = "1"
    out = os.fdopen(os.dup(1), "w", buffering=1)
    with tempfile.TemporaryDirectory(dir=_shared_memory()) as folder:
        bench = Bench(name, Path(folder))
        bench.run(seed, first)  # loads what is loaded late, before memory is bounded
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + _ROOM, resource.RLIM_INFINITY))
        before = time.process_time()
        for number in range(first, first + count):
            out.write(json.dumps([number]) + "\n")
            outcome = bench.run(seed, number)
            out.write(json.dumps([number, outcome.ending, outcome.text]) + "\n")
        out.write(json.dumps({"cpu_s": time.process_time() - before}) + "\n")


def supervise(name: str, seed: int, first: int, count: int) -> Tally:
    """Have cases read in another process; one that ends it is a failure, and the next begins a new one."""
    tally, last = Tally(), first + count
    while first < last:
        words = ["--work", name, "--seed", str(seed), "--first", str(first), "--count", str(last - first)]
        process = subprocess.Popen(
            [sys.executable, __file__, *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            bufsize=1,
        )
        assert process.stdout and process.stderr
        begun, done = None, False
        while select.select([process.stdout], [], [], _LOADING if begun is None else 12 * SECONDS)[0]:
            line = process.stdout.readline()
            if not line:
                break
            said = json.loads(line)
            if isinstance(said, dict):
                tally.cpu_s, done = tally.cpu_s + said["cpu_s"], True
            elif len(said) == 1:
                begun = said[0]
            else:
                tally.endings[said[1]] += 1
                if said[1] == "failed":
                    tally.failures.append((said[0], said[2]))
                first = said[0] + 1
        process.kill()
        code, rest = process.wait(), process.stderr.read()
        if not done:
            if begun is None and first == last - count:
                raise SystemExit(f"{name}: the valid files cannot be read: {rest[-2000:]}")
            tally.endings["failed"] += 1
            tally.failures.append((first, f"ended the process with {code}: {rest[-300:]}"))
            first += 1
    e = tally.endings
    print(f"{name}: {e.total()} cases, {e['failed']} failed", file=sys.stderr, flush=True)
    return tally


def _shared_memory() -> str | None:
    return "/dev/shm" if os.access("/dev/shm", os.W_OK) else None


def shares(names: list[str], count: int) -> dict[str, int]:
    """How many cases of each kind."""
    total = sum(KINDS[name].weight for name in names)
    return {name: round(count * KINDS[name].weight / total) for name in names}


def main() -> None:
    """Prints a line a kind and the failures; exit code 1 where there are any."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--count", type=int, default=2000, help="cases read in process, of all kinds together"
    )
    parser.add_argument("--first", type=int, default=0, help="number of the first case of each kind")
    parser.add_argument("--kinds", default="", help=f"separated by commas: {', '.join(KINDS)}")
    parser.add_argument("--through-cli", type=int, default=0, metavar="N", help="cases given to commands")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--show", type=int, default=5, help="failures printed of each kind")
    parser.add_argument("--work", default="", help=argparse.SUPPRESS)
    a = parser.parse_args()
    if a.work:
        work(a.work, a.seed, a.first, a.count)
        return
    names = a.kinds.split(",") if a.kinds else list(KINDS)
    chunks = [
        (name, first, min(_CHUNK, a.first + count - first))
        for name, count in shares(names, a.count).items()
        for first in range(a.first, a.first + count, _CHUNK)
    ]
    # threads that wait for processes
    made = Parallel(a.jobs, prefer="threads")(delayed(supervise)(name, a.seed, f, n) for name, f, n in chunks)
    tallies = {name: Tally() for name in names}
    for (name, _, _), tally in zip(chunks, made, strict=True):
        tallies[name].add(cast(Tally, tally))
    if a.through_cli:
        tallies["commands"] = Tally(*through_cli(names, a.seed, a.first, a.through_cli))
    print(f"{'kind':22s} {'cases':>7s} {'accepted':>9s} {'refused':>8s} {'failed':>7s} {'CPU s':>8s}")
    for name, t in tallies.items():
        e = t.endings
        if not e:
            continue
        print(
            f"{name:22s} {e.total():7d} {e['accepted']:9d} {e['refused']:8d} {e['failed']:7d} {t.cpu_s:8.1f}"
        )
    failed = sum(t.endings["failed"] for t in tallies.values())
    cpu_s = sum(t.cpu_s for t in tallies.values())
    cases = sum(t.endings.total() for t in tallies.values())
    print(f"{failed} of {cases} cases failed; {cpu_s:.0f} s of CPU time")
    for name, t in tallies.items():
        for number, text in t.failures[: a.show]:
            print(f"{name} {number}: {text}")
    if failed:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
