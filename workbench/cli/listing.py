"""The command list of ``--help``: grouped by purpose, in the order of the work, with whole sentences."""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup

_WHOLE = 1000  # characters; no first sentence is as long
#: Heading to commands; those that stand nowhere come last.
_SECTIONS = {
    "Compare a model with measurements": (
        *("demo", "import", "inspect", "compare", "diagnose", "add", "improve", "fleet", "ui"),
    ),
    "Experiments and frequency responses": ("excite", "record", "frf", "identify"),
    "Parallel legs": ("check", "normalize"),
    "Policies and hardware": ("approve", "train", "export", "evaluate", "show", "deploy", "can"),
}


class Listing(TyperGroup):
    """A group whose help shows each command's whole first sentence, under headings for the main program."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write the sections."""
        left = {name: command for name, command in self.commands.items() if not command.hidden}
        sections = {head: [n for n in names if n in left] for head, names in _SECTIONS.items()}
        if not any(sections.values()):
            sections = {}
        sections["Commands"] = [n for n in left if not any(n in names for names in sections.values())]
        for head, names in sections.items():
            if names:
                with formatter.section(head):
                    formatter.write_dl([(n, left[n].get_short_help_str(_WHOLE)) for n in names])
