"""Does to a robot what can go wrong, in simulated time and every protocol, and writes down what it does.

    python benchmarks/fault_table.py            # prints the table
    python benchmarks/fault_table.py --write    # and puts it into docs/can.md

Four drives on two buses swing two legs; from a known moment on something is wrong. Times are those of the
bus: until everything damps, and until the last drive has been told to, or has stopped itself.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path

from fault_bench import PROTOCOLS, Bench, Fault
from faults import FAULTS

from workbench.core import WorkbenchError
from workbench.core.files import write_whole
from workbench.deployment.deploy import run_host
from workbench.deployment.stopping import exit_code

DOCS = Path(__file__).resolve().parents[1] / "docs" / "can.md"
BEGIN, END = (
    "<!-- fault table: written by benchmarks/fault_table.py -->\n",
    "<!-- end of the fault table -->\n",
)
RUN_S = 0.6  # after which a run ends by itself


@dataclass(frozen=True)
class Outcome:
    """What one fault did in one protocol.

    Attributes:
        detected_s: from the fault until everything damps [s]; None where the run went on.
        gone_s: until no drive had torque any more [s]; None as above.
        torque: largest torque or stiffness that a drive was told after that [N m, N m/rad].
        state: in which the run was left.
        code: exit code.
        said: the fault's name.
        longest_s: the longest that a drive drove without a command [s].
    """

    detected_s: float | None
    gone_s: float | None
    torque: float
    state: str
    code: int | None
    said: str | None
    longest_s: float


def measure(fault: Fault, protocol: str, folder: Path) -> Outcome:
    """One fault in one protocol."""
    bench = Bench(folder, protocol, fault)
    result = None
    try:
        result = run_host(bench.host, bench.network, RUN_S, bench.say)
        code, said = exit_code(result), result["fault"]
    except WorkbenchError as error:
        code, said = error.exit_code, str(error)
    except SystemExit:
        code, said = None, None  # kill -9: nobody is left to say anything
    bench.network.sleep_until(bench.network.now() + 0.1)
    if fault.fatal:
        return Outcome(
            None, bench.gone(), bench.torque_after(), "off, by the drives", None, None, bench.longest
        )
    off = not any(motor.enabled for motor in bench.motors)
    if said is None:
        state = "running" if bench.ran_on else "off"
        return Outcome(None, None, 0.0, state, code, None, bench.longest)
    state = "off" if bench.damped is None else "damping, off"
    return Outcome(
        bench.damped,
        bench.gone(),
        bench.torque_after(),
        state if off else "DRIVING",
        code,
        said,
        bench.longest,
    )


def row(fault: Fault, outcomes: Sequence[Outcome]) -> list[str]:
    """The cells of one fault, by its outcome in each protocol."""
    return [
        fault.about,
        _each([_ms(o.detected_s) for o in outcomes]),
        _each(["as it was" if o.gone_s is None else f"none after {_ms(o.gone_s)}" for o in outcomes]),
        _each([o.state for o in outcomes]),
        _each(["-" if o.code is None else str(o.code) for o in outcomes]),
    ]


def _ms(seconds: float | None) -> str:
    return "never" if seconds is None else f"{ceil(1e3 * seconds - 1e-6)} ms"


def _each(cells: Sequence[str]) -> str:
    """One cell for all protocols, or one each."""
    if all(cell.startswith("none after ") for cell in cells):
        return f"none after {_each([cell.removeprefix('none after ') for cell in cells])}"
    if len(set(cells)) == 1:
        return cells[0]
    if all(cell.endswith(" ms") for cell in cells):
        return " / ".join(cell.removesuffix(" ms") for cell in cells) + " ms"
    return " / ".join(cells)


def table(cells: Sequence[Sequence[str]]) -> str:
    """As Markdown."""
    head = ["fault", "detected after", "torque", "state", "exit code"]
    lines = [head, ["---"] * len(head), *cells]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def written() -> list[list[str]]:
    """The cells that stand in the docs."""
    text = DOCS.read_text(encoding="utf-8")
    inside = text[text.index(BEGIN) + len(BEGIN) : text.index(END)].strip().splitlines()[2:]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in inside]


def main() -> None:
    """Measures all of it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--write", action="store_true", help="into docs/can.md")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        cells = [row(fault, [measure(fault, p, Path(name)) for p in PROTOCOLS]) for fault in FAULTS]
    made = table(cells)
    print(made, end="")
    if arguments.write:
        text = DOCS.read_text(encoding="utf-8")
        head, tail = text[: text.index(BEGIN) + len(BEGIN)], text[text.index(END) :]
        write_whole(DOCS, f"{head}\n{made}\n{tail}", force=True)


if __name__ == "__main__":
    main()
