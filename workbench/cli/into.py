"""``--into``: results written into the numbers of the user's own MJCF or URDF."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from typer import Option

from workbench.core import InputError
from workbench.core.files import write_whole
from workbench.core.xml_text import XmlText

from .common import check_outputs

if TYPE_CHECKING:
    from workbench.effects import Change, InFile
    from workbench.models import Model

IntoOption = Annotated[
    str | None,
    Option(
        "--into",
        metavar="ROBOT",
        help="Write the numbers into a copy of this .xml or .urdf (-o names it); all else stays as it is.",
    ),
]
_FOLDERS = {"meshdir", "texturedir", "assetdir"}


def check_into(model: Model, into: str, output: str, *, force: bool) -> None:
    """Refuse, before any work is done, a file that is not the model's, or an unsuitable output.

    Raises:
        InputError: as it says.
    """
    from workbench.effects import open_text

    source, target = Path(into), Path(output)
    if not source.is_file():
        raise InputError("no such file", file=into, remedy="give --into the .xml or .urdf of the model")
    text = open_text(model, source)
    if target.suffix.lower() != source.suffix.lower():
        raise InputError(
            f"the output is a copy of {source.name}", file=output,
            remedy=f"give it the ending {source.suffix}, or omit --into",
        )  # fmt: skip
    check_outputs(output, force=force)
    if target.resolve().parent != source.resolve().parent and (named := _beside(text)):
        raise InputError(
            f"{source.name} names '{named}' relative to its own folder", file=output,
            remedy=f"write the copy into {source.parent}",
        )  # fmt: skip


def _beside(text: XmlText) -> str | None:
    """Return a file or folder that a document names relative to its own folder."""
    for element in text.elements:
        for name, value in element.attributes.items():
            if (name in _FOLDERS or name.startswith("file")) and "://" not in value:
                return value
    return None


@dataclass(frozen=True)
class Into:
    """A file with new numbers, ready to be written.

    `source`: the user's file; `output`: its copy; `model`: as it was given; `made`: what is in the copy.
    """

    source: str
    output: str
    model: Model
    made: InFile

    @staticmethod
    def of(given: Model, improved: Model, into: str, output: str) -> Into:
        """Return the file with the effects of an improved model.

        Raises:
            InputError: the file has no number for any of them, or does not become that model.
        """
        from workbench.effects import into_file

        made = into_file(improved, Path(into))
        if made.left and not made.written:
            raise InputError(
                f"it has no number for {_phrases(made)}", file=into,
                remedy="omit --into: -o NEW.toml keeps effects that have no number there",
            )  # fmt: skip
        return Into(into, output, given, made)

    def write(self, *, force: bool) -> None:
        """Write the copy, whole or not at all."""
        write_whole(self.output, self.made.content, force=force)

    @property
    def as_dict(self) -> dict[str, Any]:
        """Return the JSON block about it."""
        from workbench.report import effect_dict

        return {
            "file": self.output,
            "into": self.source,
            "written": [_change_dict(change) for change in self.made.changes],
            "not_written": [effect_dict(a.key, a.parameters) for a in self.made.left],
        }

    @property
    def lines(self) -> list[str]:
        """Return the lines that tell the user each new number."""
        name = Path(self.source).name
        if not self.made.changes:
            return [f"Wrote {self.output}: {name} as it is."]
        return [f"Wrote {self.output}: {name} with", *(f"  {_change_line(c)}" for c in self.made.changes)]

    @property
    def notes(self) -> list[str]:
        """Return notes on what is not in the copy, and what to watch for."""
        out = []
        if self.made.left:
            it = "it" if len({a.key for a in self.made.left}) == 1 else "them"
            out.append(
                f"not in {self.output}, which has no number for {it}: {_phrases(self.made)}; "
                f"-o NEW.toml, without --into, keeps {it}"
            )
        file = self.model.source
        if Path(self.source).resolve() != self.model.serial.resolve():
            out.append(f"{self.model.serial.name} still includes {self.source}, not {self.output}")
        elif file and file.suffix == ".toml" and any(e in self.made.written for e in self.model.effects):
            out.append(
                f"to use {self.output} with {file.name}, name it there as serial, and delete those of "
                "its [[effects]] that are now in the numbers"
            )
        return out


def _phrases(made: InFile) -> str:
    from workbench.report.wording import any_of, effect_phrases

    return any_of(effect_phrases(dict.fromkeys(a.key for a in made.left)), "and")


def _change_dict(change: Change) -> dict[str, Any]:
    before, after = np.asarray(change.before).tolist(), np.asarray(change.after).tolist()
    return {"joint": change.joint, "number": change.number, "before": before, "after": after}


def _change_line(change: Change) -> str:
    of_body = change.number in ("mass", "centre", "inertia")
    where = f"body of {change.joint}" if of_body else change.joint
    return f"{where}: {change.number} {_short(change.after)}, not {_short(change.before)}"


def _short(value: float | np.ndarray) -> str:
    """Return four digits of each number; rounding errors beside the largest become 0."""
    rows = np.atleast_2d(value)
    rows = np.where(np.abs(rows) < 1e-9 * np.abs(rows).max(), 0.0, rows)
    return "; ".join(" ".join(f"{v:.4g}" for v in row) for row in rows)
