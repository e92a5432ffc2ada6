"""The table of figures that the documentation states: where each stands, and how a new one is found.

The table is `figures.toml`, whose head says what its keys mean; `figures.py` makes the figures anew.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
TABLE = Path(__file__).with_name("figures.toml")
#: A number of its own: not the digits in a name such as S3N or UR10e.
NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?![\w]|\.\d)")
Figure = Mapping[str, Any]


class NotFoundError(Exception):
    """What the commands made has no such number."""


def figures() -> list[Figure]:
    """All figures."""
    return tomllib.loads(TABLE.read_text(encoding="utf-8"))["figure"]


def filled(figure: Figure, text: str, values: Mapping[str, str] | None = None) -> str:
    """A text with the figure's values, or others by name, in the places of their names."""
    return text.format(**{v["name"]: v["value"] for v in figure.get("values", ())} | dict(values or {}))


def table_rows(page: str) -> Iterator[list[str]]:
    """The rows of all Markdown tables of a text, cell by cell."""
    for line in page.splitlines():
        if line.startswith("|"):
            yield [cell.strip() for cell in line.strip().strip("|").split(" | ")]


def stated(stand: Mapping[str, str], page: str) -> list[str]:
    """The row of a page that a figure stands in, cell by cell.

    Raises:
        NotFoundError: the page has no such row.
    """
    for cells in table_rows(page):
        if cells[0].startswith(stand["row"]):
            return cells
    raise NotFoundError(f"{stand['file']} has no row that begins with '{stand['row']}'")


def measured(value: Mapping[str, Any], out: Path, printed: str) -> float:
    """The number that the commands made for one value.

    Args:
        value: an entry of ``values`` in the table.
        out: the folder that the commands wrote to.
        printed: what they printed.

    Raises:
        NotFoundError: it is not there.
    """
    text = (out / value["file"]).read_text(encoding="utf-8") if "file" in value else printed
    found = _number(value, text) * value.get("scale", 1)
    return found / _number({**value, **value["over"]}, text) if "over" in value else found


def like(shown: str, number: float) -> str:
    """A number with as many digits behind the point as another that is shown."""
    return f"{number:.{len(shown.partition('.')[2])}f}"


def _number(value: Mapping[str, Any], text: str) -> float:
    if "json" in value:
        return _at(json.loads(text), value["json"])
    if "pattern" in value:
        match = re.search(value["pattern"], text)
        if match is None:
            raise NotFoundError(f"nothing matches {value['pattern']}")
        return float(match[1])
    names = value.get("rows") or [value["row"]]
    cells = [_cell(text, name, value["column"], value.get("take", 0)) for name in names]
    if all(c is None for c in cells):
        raise NotFoundError(f"no table has a number in row '{names[0]}', column '{value['column']}'")
    return sum(c for c in cells if c is not None)  # a kind of which there is none has no number


def _at(tree: Any, path: str) -> float:
    for key in path.split("."):
        try:
            if "=" in key:
                name, wanted = key.split("=")
                tree = next(entry for entry in tree if entry[name] == wanted)
            else:
                tree = tree[int(key)] if isinstance(tree, list) else tree[key]
        except (KeyError, IndexError, StopIteration):
            raise NotFoundError(f"there is no '{key}' of '{path}'") from None
    if not isinstance(tree, (int, float)):
        raise NotFoundError(f"'{path}' is no number: {tree}")
    return float(tree)


def _cell(text: str, row: str, column: str, take: int) -> float | None:
    head: list[str] = []
    for cells in table_rows(text):
        if column in cells:
            head = cells
        elif head and cells[0] == row:
            numbers = NUMBER.findall(cells[head.index(column)])
            return float(numbers[take]) if len(numbers) > take else None
    return None
