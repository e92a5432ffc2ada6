"""LeRobot data sets: a folder with ``meta/info.json`` and Parquet files; one episode becomes a table."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from workbench.core import InputError
from workbench.core.bounds import check_cells, inside, too_large

from ..table import Table
from .arrays import check_unpacked, parquet_columns

_WANTED = ("timestamp", "frame_index", "episode_index")


def is_lerobot(folder: Path) -> bool:
    """Return whether a folder is a LeRobot data set."""
    return (folder / "meta" / "info.json").is_file()


def read_lerobot(folder: Path, episode: int = 0) -> Table:
    """Return one episode: state, action and time stamps, named after the motors.

    Raises:
        InputError: no such episode, a file outside the folder, or files that cannot be read.
    """
    info = _info(folder)
    features = info.get("features") if isinstance(info.get("features"), dict) else {}
    assert isinstance(features, dict)
    # the folder is searched; the path template in info.json is only text from a stranger
    files = [inside(folder, file) for file in sorted((folder / "data").glob("**/*.parquet"))]
    parts = []
    for file in files:
        try:
            with pq.ParquetFile(file) as opened:
                check_unpacked(opened.metadata, file)
                names = opened.schema_arrow.names
                wanted = [n for n in names if n in _WANTED or n == "action" or n.startswith("observation.")]
                wanted = [n for n in wanted if "image" not in n]
                if "episode_index" not in names:
                    raise InputError("has no episode_index", file=file, remedy="is it a LeRobot data set?")
                check_cells(opened.metadata.num_rows * len(wanted), file)
                table = opened.read(columns=wanted)
        except (pa.ArrowException, OSError, ValueError) as error:
            raise InputError(
                "is not a readable Parquet file", file=file, remedy="download it again"
            ) from error
        mine = table.filter(pc.equal(table["episode_index"], episode))
        if mine.num_rows:
            parts.append(mine)
        elif parts:
            break
    if not parts:
        remedy = f"it says that it has {info.get('total_episodes', 'no')} episodes; give --episode"
        raise InputError(f"has no episode {episode}", file=folder, remedy=remedy)
    whole = pa.concat_tables(parts)
    columns, _ = parquet_columns(whole, folder)
    named = {_name(column, features): values for column, values in columns.items()}
    named = {n: v for n, v in named.items() if n not in ("episode_index", "frame_index")}
    units = {"timestamp": "s"} if "timestamp" in named else {}
    fps = info.get("fps")
    if "timestamp" not in named and isinstance(fps, int | float) and fps > 0:
        named["timestamp"] = np.arange(whole.num_rows) / float(fps)
        units = {"timestamp": "s"}
    note = f"Episode {episode} of {info.get('total_episodes', '?')}."
    return Table(folder, named, units, False, "timestamp" if units else None, (note,))


def _name(column: str, features: dict[str, Any]) -> str:
    """``observation.state[2]`` as ``observation.state/elbow``."""
    base, bracket, rest = column.partition("[")
    feature = features.get(base)
    names = feature.get("names") if isinstance(feature, dict) else None
    if isinstance(names, dict):
        names = next((v for v in names.values() if isinstance(v, list)), None)
    index = rest.rstrip("]")
    if bracket and isinstance(names, list) and index.isdigit() and int(index) < len(names):
        return f"{base}/{str(names[int(index)])[:80]}"
    return column


def _info(folder: Path) -> dict[str, Any]:
    file = inside(folder, folder / "meta" / "info.json")
    try:
        if file.stat().st_size > 2**24:
            raise too_large(file)
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError("is not readable JSON", file=file, remedy="download the data set again") from error
    if not isinstance(content, dict):
        raise InputError("is not a data set's description", file=file, remedy="download it again")
    return content
