"""Interrupts and kills commands at random moments: old results stay whole, nothing half-written is left.

    python benchmarks/interrupts.py --count 50 --seed 0

Each command runs in a folder that has its outputs already. After an interrupt (SIGINT) the exit code has to
be 130, or 0 or 1 where it was done; while the program is still loading, nothing can be half-written, and the
process may end by the signal itself (number 2, which a shell shows as 130 too). After a kill (SIGKILL)
at most one hidden ``.part`` folder may be left. Every other file has to be what it was before, or what the
whole run makes of it, and training has to go on.
"""

from __future__ import annotations

import argparse
import hashlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

#: Command -> its words; what comes before it makes the inputs.
COMMANDS = {
    "record": "record leg -o data --force",
    "compare page": "compare leg_kin_only data/slow.toml --json out.json --html out.html --force",
    "add": "add leg_kin_only viscous_damping@hip damping=0.02 -o new.toml --force",
    "excite": "excite leg --kind chirp -o design/design.toml --force",
    "improve": "improve leg_s3n_act data/slow.toml -o better.toml --html steps.html --force",
    "train": "train reach --unverified --envs 4 --iterations 40 --save-every 1 -o run",
    "export": "export run -o reach.zip --force",
}
_SLOW = 1.5  # of the time that the whole run takes; later nothing is left to interrupt


def words(name: str) -> list[str]:
    """A command as it is started."""
    return [sys.executable, "-m", "workbench.cli", *COMMANDS[name].split(), "--quiet"]


def listing(folder: Path) -> dict[str, str]:
    """File -> hash."""
    return {
        p.relative_to(folder).as_posix(): hashlib.sha256(p.read_bytes()).hexdigest()
        for p in folder.rglob("*")
        if p.is_file()
    }


def whole(name: str, folder: Path) -> tuple[float, dict[str, str]]:
    """Run a command to its end; how long it took [s], and what then lies there."""
    begun = time.perf_counter()
    if name == "train":
        shutil.rmtree(folder / "run", ignore_errors=True)
    done = subprocess.run(words(name), cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{name}: exit {done.returncode}: {done.stderr[-500:]}")
    return time.perf_counter() - begun, listing(folder)


def stopped(name: str, folder: Path, how: signal.Signals, after: float, good: dict[str, str]) -> str:
    """Run a command, stop it, and say what must not be; nothing where all is well."""
    if name == "train":
        shutil.rmtree(folder / "run", ignore_errors=True)
    process = subprocess.Popen(
        words(name), cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    time.sleep(after)
    process.send_signal(how)
    _, said = process.communicate(timeout=120)
    code, now = process.returncode, listing(folder)
    if how == signal.SIGINT and code not in (0, 1, 130, -signal.SIGINT):  # the last: while it was loading
        return f"exit code {code}: {said[-300:]}"
    if "Traceback" in said and not _while_loading(said):
        return f"a traceback: {said[-300:]}"
    parts = {p for p in folder.rglob("*.part") if p.name.startswith(".")}
    if len(parts) > (how == signal.SIGKILL):
        return f"left {sorted(p.name for p in parts)}"
    for part in parts:
        shutil.rmtree(part)
    if name == "train":
        return _resumed(folder)
    made = {f for f in now if not any(p.name in f for p in parts)}
    if strange := made - set(good):
        return f"left {sorted(strange)[:3]}"
    changed = [f for f in made if now[f] != good[f] and not f.endswith((".html", ".json"))]
    missing = set(good) - made
    cut = [
        f for f in made if f.endswith(".html") and not (folder / f).read_text().rstrip().endswith("</html>")
    ]
    return f"changed {changed}, missing {sorted(missing)}, cut {cut}" if changed or missing or cut else ""


def _while_loading(said: str) -> bool:
    """Whether Python itself was interrupted, before any line of the program ran."""
    return said.rstrip().endswith("KeyboardInterrupt") and set(re.findall(r'File "([^"]+)"', said)) <= {
        "<frozen runpy>",
        "<frozen site>",
    }


def _resumed(folder: Path) -> str:
    """A run that was stopped goes on where it has a checkpoint, and begins anew where it has none."""
    again = [*words("train"), *(["--resume"] if (folder / "run" / "checkpoint.pt").exists() else [])]
    done = subprocess.run(again, cwd=folder, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else f"does not go on: {done.stderr[-300:]}"


def main() -> None:
    """Prints a line a command and what went wrong; exit code 1 where anything did."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, default=50, help="of interrupts and kills, over all commands")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--commands", default=",".join(COMMANDS))
    a = parser.parse_args()
    # what was started in the background ignores interrupts, and so would all that it starts
    signal.signal(signal.SIGINT, signal.default_int_handler)
    random, wrong, names = np.random.default_rng(a.seed), 0, a.commands.split(",")
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        took = {name: whole(name, folder) for name in COMMANDS}
        good = took["export"][1]
        for k in range(a.count):
            name = names[k % len(names)]
            how = (signal.SIGINT, signal.SIGKILL)[k // len(names) % 2]
            after = float(random.uniform(0.0, _SLOW * took[name][0]))
            found = stopped(name, folder, how, after, good)
            if name == "train" and not found:
                whole("export", folder)  # the checkpoint is another now
                good = listing(folder)
            wrong += bool(found)
            print(
                f"{name:14s} {how.name:8s} after {after:6.2f} s of {took[name][0]:6.2f}: {found or 'whole'}",
                flush=True,
            )
    print(f"{wrong} of {a.count} left something half-written or ended otherwise than they should")
    if wrong:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
