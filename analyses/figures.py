"""Makes the figures that the documentation states anew, and says what has changed.

    make figures                     # the quick ones; or: python analyses/figures.py
    make figures ALL=1               # all, many hours
    make figures ONLY="ladder exam"  # some of them, by their names in analyses/figures.toml
    make figures WRITE=1             # and write what is new into the pages and the table

Ends with 1 where something changed by more than noise or could not be made.
"""

from __future__ import annotations

import argparse
import importlib
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from figure_files import changed_lines, changed_pictures, put_back, taken
from figure_table import ROOT, TABLE, Figure, NotFoundError, figures, filled, like, measured, stated
from rich.table import Column, Table

from workbench import report
from workbench.core.files import write_whole

_WHERE = "data: docs/measured-data.md; modules: make training, pip install 'mujoco[sysid]'"
Line = tuple[str, str, str, str, str]  # figure, what, was, is, how far


def main(arguments: Sequence[str] | None = None) -> int:
    """Make, compare, print; returns the exit code."""
    known = [f["id"] for f in figures()]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--all", action="store_true", help="those that take long too")
    parser.add_argument("--only", nargs="+", choices=known, default=[], metavar="NAME", help=", ".join(known))
    parser.add_argument("--write", action="store_true", help="write what is new where it stands")
    default = Path(os.environ.get("WORKBENCH_DATA", ROOT.parent / "shared" / "data"))
    parser.add_argument("--data", type=Path, default=default, help="folder of the measured data")
    given = parser.parse_args(arguments)
    lines: list[Line] = []
    for figure in figures():
        if figure["id"] in given.only or (not given.only and (given.all or not figure.get("long"))):
            print(f"{figure['id']} ...", file=sys.stderr, flush=True)
            lines += made(figure, given.data, given.write)
    table = Table("figure", Column("what", overflow="fold"), "was", "is", "")
    for line in lines:
        table.add_row(*line)
    report.print_table(table)
    return int(any(line[-1].startswith("!") for line in lines))


def made(figure: Figure, data: Path, write: bool) -> list[Line]:
    """One figure made anew: a line for each value, page and picture."""
    name = figure["id"]
    if lacking := [need for need in figure.get("needs", ()) if not _there(need, data)]:
        return [(name, f"left out: needs {', '.join(lacking)}; {_WHERE}", "", "", "")]
    standing = [ROOT / f for f in figure.get("pages", ())]
    standing += [ROOT / p["file"] for p in figure.get("pictures", ())]
    with tempfile.TemporaryDirectory() as folder:
        out, before = Path(folder) / "out", taken(standing, Path(folder) / "before")
        out.mkdir()
        printed = []
        try:
            for command in figure["commands"]:
                printed.append(_run(command.format(out=out, data=data.resolve())))
            lines = values(figure, out, "\n".join(printed), write)
            for page in figure.get("pages", ()):
                changes = changed_lines(page, before, figure.get("ignore", ""))
                lines += [(name, *line) for line in changes]
            for picture in figure.get("pictures", ()):
                lines += [(name, *line) for line in changed_pictures(picture, out, before, write)]
        except subprocess.CalledProcessError as error:
            put_back(before)
            last = (error.stderr or error.stdout).strip().splitlines()[-1:] or [
                f"exit code {error.returncode}"
            ]
            return [(name, f"{error.cmd[-1]}: {last[0]}", "", "", "! failed")]
        if not write:
            put_back(before)
    return lines


def values(figure: Figure, out: Path, printed: str, write: bool) -> list[Line]:
    """A line for each value; they are written into pages and table where that is asked and all were found."""
    lines: list[Line] = []
    new: dict[str, str] = {}
    for value in figure.get("values", ()):
        old = value["value"]
        try:
            number = measured(value, out, printed)
        except (NotFoundError, OSError) as error:
            lines.append((figure["id"], value["name"], old, "–", f"! {error}"))
            continue
        new[value["name"]] = like(old, number)
        off = abs(float(new[value["name"]]) - float(old))
        far = "the same" if off == 0 else "within noise" if off <= value["within"] else "! changed"
        lines.append((figure["id"], value["name"], old, new[value["name"]], far))
    if write and len(new) == len(figure.get("values", ())):
        written(figure, new)
    return lines


def written(figure: Figure, new: dict[str, str]) -> None:
    """New values in the rows where they stand, and in the table of figures."""
    for stand in figure.get("stands", ()):
        page = (ROOT / stand["file"]).read_text(encoding="utf-8")
        first = stated(stand, page)[0]
        texts = [stand[cell] for cell in ("text", "peer") if cell in stand]
        old, then = (
            "".join(f"| {c} " for c in (first, *(filled(figure, t, v) for t in texts))) + "|"
            for v in (None, new)
        )
        write_whole(ROOT / stand["file"], page.replace(old, then), force=True)
    table = TABLE.read_text(encoding="utf-8")
    start = table.index(f'id = "{figure["id"]}"')
    end = (table + "[[figure]]").index("[[figure]]", start)
    part = table[start:end]
    for value in figure["values"]:
        entry = f'name = "{value["name"]}", value = "{{}}"'
        part = part.replace(entry.format(value["value"]), entry.format(new[value["name"]]))
    write_whole(TABLE, table[:start] + part + table[end:], force=True)


def _there(need: str, data: Path) -> bool:
    if (data / need).is_dir():
        return True
    module, _, part = need.partition(":")
    try:
        return hasattr(importlib.import_module(module), part or "__name__")
    except ImportError:
        return False


def _run(command: str) -> str:
    """What a command prints; its programs are those of this Python."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])
    environment = {**os.environ, "PATH": path, "COLUMNS": "200"}
    done = subprocess.run(
        ["bash", "-c", command], cwd=ROOT, env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
