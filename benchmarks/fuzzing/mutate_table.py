"""Ways in which the columns of a valid table become bad ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from .mutate import NUMBERS, TEXTS, Random, pick

Columns = dict[str, Any]


def columns(random: Random, table: Columns) -> Columns:
    """A table's cells, rows and columns."""
    out: Columns = {name: np.array(values) for name, values in table.items()}
    for _ in range(int(random.integers(1, 3))):
        if not out:
            break
        name = str(pick(random, list(out)))
        rows = len(out[name])
        row = int(random.integers(max(rows, 1)))
        match int(random.integers(16)):
            case 0 | 1 | 2 if rows and out[name].dtype.kind == "f":
                out[name][row : row + int(2 ** random.integers(0, 6))] = pick(random, NUMBERS)
            case 3 if rows:
                other = out[name].astype(object)
                other[row] = pick(random, (*TEXTS[2:], True, None))
                out[name] = other
            case 4:
                del out[name]
            case 5:
                other = str(pick(random, list(out)))
                out[name], out[other] = out[other], out[name]
            case 6:
                order = random.permutation(rows)
                out = {n: v[order] if len(v) == rows else v for n, v in out.items()}
            case 7:
                out = {n: np.delete(v, slice(row, row + 7)) for n, v in out.items()}
            case 8:
                out[name] = out[name][: int(random.integers(rows + 1))]
            case 9:
                keep = int(pick(random, (0, 1, 2, 3, 7, 8, 16)))
                out = {n: v[:keep] for n, v in out.items()}
            case 10:
                out = {n: v[::-1] for n, v in out.items()}
            case 11 if out[name].dtype.kind == "f":
                with np.errstate(all="ignore"):
                    out[name] = out[name] * float(
                        pick(random, (-1.0, 0.0, 1e3, 1e-3, 180 / np.pi, 1e200, 1e306))
                    )
            case 12:
                out[name] = np.full(rows, pick(random, NUMBERS))
            case 13:
                out[str(pick(random, (*TEXTS, name.upper(), f" {name}", f"{name}.1")))] = out[name]
            case 14 if rows > 4 and out[name].dtype.kind == "f":
                out[name][rows // 2 :] += float(pick(random, (2 * np.pi, -2 * np.pi, 1e6)))
            case _:
                out[name] = np.round(out[name].astype(float), 1) if out[name].dtype.kind == "f" else out[name]
    return out
