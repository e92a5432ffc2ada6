"""Columns that no signal was made of: they are named, with how to say what they are."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from .draft import Draft

_SHOWN = 8


def note_unused(draft: Draft, unused: Sequence[str], signals: Collection[str], axes: int) -> None:
    """Note the columns that are not used, and where no torque was found, how to name one.

    Args:
        draft: takes the notes.
        unused: columns.
        signals: those that columns were found for.
        axes: their number.
    """
    if not unused:
        return
    more = f" and {len(unused) - _SHOWN} more" if len(unused) > _SHOWN else ""
    silent = not any(signal.startswith("torque") for signal in signals)
    how = f"; if the torque is among them: --column torque_measured={','.join('…' * axes)}" if silent else ""
    draft.notes.append(f"Not used: {', '.join(unused[:_SHOWN])}{more}{how}.")
    nil = [n for n in unused if draft.roles[n].kind == "torque" and not draft.table.columns[n].any()]
    if silent and len(nil) == axes:
        draft.notes.append(
            f"{', '.join(nil)} are zero in every row. If nothing drives this machine: --column "
            f'torque_command={",".join(nil)}, and kind = "none" in [controller].'
        )
