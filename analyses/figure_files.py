"""Pages and pictures as they stand and as they were made anew: what differs, and the old ones put back."""

from __future__ import annotations

import difflib
import re
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from figure_table import ROOT
from matplotlib.image import imread
from scipy.ndimage import uniform_filter, zoom

_WIDE = 400  # pixels to which pictures are brought before they are held against each other
_SAME, _NOISE = 0.03, 0.01  # of full brightness, which no eye tells apart; of the pixels, which noise moves
_NUMBERS = 60  # characters of a line that are shown


def taken(files: Iterable[Path], folder: Path) -> dict[Path, Path]:
    """Copies of files and folders as they stand, by where they stand; of what is not there, none."""
    folder.mkdir()
    copies = {}
    for k, file in enumerate(files):
        copies[file] = folder / f"{k}{file.suffix}"
        if file.is_dir():
            shutil.copytree(file, copies[file])
        elif file.is_file():
            shutil.copyfile(file, copies[file])
    return copies


def put_back(copies: Mapping[Path, Path]) -> None:
    """Files and folders as they were taken."""
    for file, copy in copies.items():
        for part in sorted(copy.rglob("*")) if copy.is_dir() else [copy] if copy.is_file() else []:
            if part.is_file():
                shutil.copyfile(part, file / part.relative_to(copy) if copy.is_dir() else file)


def changed_lines(page: str, before: Mapping[Path, Path], ignore: str) -> Iterator[tuple[str, str, str, str]]:
    """What, was, is and how far of each line that a page has otherwise now, `ignore` left out."""
    texts = (p.read_text(encoding="utf-8") for p in (before[ROOT / page], ROOT / page))
    old, new = ((re.sub(ignore, "", t, flags=re.MULTILINE) if ignore else t).splitlines() for t in texts)
    if old == new:
        yield page, "", "", "the same"
    for tag, a, b, c, d in difflib.SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
        for k in range(max(b - a, d - c)) if tag != "equal" else ():
            was, now = (x[i + k] if i + k < end else "" for x, i, end in ((old, a, b), (new, c, d)))
            yield page, was[:_NUMBERS], now[:_NUMBERS], "! changed"


def changed_pictures(
    picture: Mapping[str, str], out: Path, before: Mapping[Path, Path], write: bool
) -> Iterator[tuple[str, str, str, str]]:
    """What, was, is and how far of a picture, or of each of a folder that was drawn in its place."""
    file = ROOT / picture["file"]
    old, new = before[file], out / picture["made"] if "made" in picture else file
    pairs = [(old / n.name, n) for n in sorted(new.glob("*.png"))] if new.is_dir() else [(old, new)]
    for was, now in pairs:
        if not now.is_file():
            yield picture["file"], "", "", "! was not made"
            continue
        apart = difference(was, now) if was.is_file() else 1.0
        far = "the same" if apart == 0 else "within noise" if apart <= _NOISE else "! looks different"
        yield (
            (str(file.relative_to(ROOT) / now.name) if new.is_dir() else picture["file"]),
            "",
            (f"{100.0 * apart:.1f} % of it differ" if apart else ""),
            far,
        )
        if write and now != file and not new.is_dir():
            shutil.copyfile(now, file)


def difference(a: Path, b: Path) -> float:
    """Share of pixels in which two pictures differ, both brought to one size."""
    first, second = (imread(p)[..., :3] for p in (a, b))
    rows = max(1, round(_WIDE * first.shape[0] / first.shape[1]))
    pixels = [_shrunk(p, (rows, _WIDE)) for p in (first, second)]
    return float(np.mean(np.abs(pixels[0] - pixels[1]).max(axis=-1) > _SAME))


def _shrunk(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """A picture (H, W, 3) with each pixel of its new size the mean about its place."""
    factors = [new / old for new, old in zip(size, image.shape[:2], strict=True)]
    widths: Any = [*(max(1, round(1 / f)) for f in factors), 1]
    return np.asarray(zoom(uniform_filter(image.astype(float), widths), [*factors, 1.0], order=1))
