"""Changes of a normalised tree against the user's own, as a table for the terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.text import Text

from workbench.models import limits_left_out
from workbench.report.layout import table as new_table
from workbench.s3n import FloatingBaseError, NormalisedTree, omissions
from workbench.s3n.posture_fitted import FittedTree, error_lines


def normalize_table(tree: NormalisedTree, base: FloatingBaseError | None, unknown: str) -> Group:
    """Return one line per changed number, what is not in the file, and the errors on a free base.

    Args:
        tree: the normalised tree.
        base: its errors on a free base, if they could be found.
        unknown: why they could not.
    """
    table = new_table("element", "quantity", ("before", "right"), ("after", "right"), "unit")
    kind = "fitted over its limits" if isinstance(tree, FittedTree) else f"variant {tree.model.variant}"
    table.title, table.title_justify = f"{tree.model.name}, {kind}", "left"
    last = ""
    for entry in tree.added:
        before = "new" if entry.before is None else f"{entry.before:.5g}"
        name = entry.element if entry.element != last else ""
        table.add_row(name, entry.quantity, before, f"{entry.after:.5g}", entry.unit)
        last = entry.element
    parts: list[RenderableType] = [table]
    if tree.left_out:
        parts.append(Text(f"Not in the file, as plain MJCF cannot state it: {', '.join(tree.left_out)}."))
    parts += [Text(f"Left out: {line}.") for line in tree.removed]
    if note := limits_left_out(tree.model):
        parts.append(Text(f"Note: {note}."))
    if isinstance(tree, FittedTree):
        off = ", ".join(error_lines(tree.error))
        parts.append(
            Text(f"Not exact. Differences from the closed chain on a level base, over its limits: {off}.")
        )
        return Group(*parts)
    missing = omissions(tree.model)
    held = f"On its fixed base it moves as the model's variant {tree.model.variant} does"
    if missing:
        held = f"{held}, which leaves out {'; '.join(missing)}"
    elif tree.model.variant == "exact":
        held = "Exact on its fixed base"
    if base is None:
        parts.append(Text(f"{held}. Errors on a free base are not known: {unknown}."))
        return Group(*parts)
    parts.append(
        Text(
            f"{held}. On a free base against the closed chain: "
            f"mass {base.mass:.3f} of {base.true_mass:.3f} kg, weight of {base.weight:.3f} of "
            f"{base.true_weight:.3f} kg, coupling with the base off by {100 * base.coupling:.1f} %, "
            f"inertia of the whole by {100 * base.inertia:.1f} %, "
            f"moment of gravity by {100 * base.moment:.1f} %."
        )
    )
    return Group(*parts)
