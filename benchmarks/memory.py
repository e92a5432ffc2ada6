"""Peak memory and time of comparing and diagnosing logs of twelve axes at 1 kHz, by their length.

    python benchmarks/memory.py --minutes 1 5 15 60 --folder logs

Logs are simulated without a break (`long_logs.py`) and kept in the folder. Each command runs in a process of
its own, whose largest resident set the kernel tells; neither starts others. Exit code 1 where one needs more
than the limit.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path

from long_logs import LEGS, write_log, write_model

COMMANDS = "compare", "diagnose"


def measure(command: str, model: Path, log: Path) -> tuple[float, float, float, dict]:
    """Peak resident memory [MB], CPU time [s] and size of the page [MB] of a command, and what it said."""
    told, page = (log.with_suffix(f".{command}.{ending}") for ending in ("json", "html"))
    words = [command, str(model), str(log), "--json", str(told), "--html", str(page), "--force", "--quiet"]
    process = os.posix_spawn(sys.executable, [sys.executable, "-m", "workbench.cli", *words], os.environ)
    _, status, usage = os.wait4(process, 0)
    if os.waitstatus_to_exitcode(status):
        raise SystemExit(f"{' '.join(words)} ended with {os.waitstatus_to_exitcode(status)}")
    cpu = usage.ru_utime + usage.ru_stime
    return usage.ru_maxrss / 1024, cpu, page.stat().st_size / 1e6, json.loads(told.read_text())


def main() -> None:
    """Prints a line a length."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, nargs="+", default=[1.0, 5.0, 15.0, 60.0])
    parser.add_argument("--legs", type=int, default=len(LEGS))
    parser.add_argument("--table", choices=("parquet", "csv"), default="parquet")
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--limit", type=float, default=2000.0, help="most that a command may need [MB]")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    model, above = write_model(arguments.folder, arguments.legs), False
    print("minutes  table MB   compare MB   CPU s   page MB   diagnose MB   CPU s   page MB   rows used")
    for minutes in arguments.minutes:
        name = f"legs{arguments.legs}_{minutes:g}min_{arguments.table}"
        log = arguments.folder / f"{name}.toml"
        if not log.is_file():
            write_log(arguments.folder, name, 60.0 * minutes, legs=arguments.legs, table=arguments.table)
        size = (arguments.folder / f"{name}.{arguments.table}").stat().st_size / 1e6
        cells, told = [], {}
        for command in COMMANDS:
            peak, cpu, page, told = measure(command, model, log)
            above |= peak > arguments.limit
            cells.append(f"{peak:10.0f} {cpu:7.0f} {page:9.1f}")
        used = f"{100 * told['used']:9.2g} %"
        print(f"{minutes:7g} {size:9.0f}   {'    '.join(cells)} {used}", flush=True)
    if above:
        raise SystemExit(f"more than {arguments.limit:g} MB")


if __name__ == "__main__":
    main()
