"""Whether the model that a policy was trained with had been held against the machine, by its record."""

from __future__ import annotations

from .bundle import PolicyBundle


def objections(bundle: PolicyBundle) -> list[str]:
    """Why a policy may not drive hardware by the record in its bundle; none if it may.

    The record is the one that ``workbench approve`` wrote for the model and ``workbench train`` took along.
    """
    record = bundle.manifest.get("record")
    if not isinstance(record, dict) or not record:
        return ["its model had no verification record"]
    found = []
    model = bundle.manifest.get("model")
    trained = model.get("files") if isinstance(model, dict) else None
    if record.get("files") != trained or not trained:
        found.append("its record is for other model files than those it was trained with")
    if record.get("variant") != bundle.variant:
        found.append(f"its record is for variant {record.get('variant')}, not {bundle.variant}")
    if record.get("passed") is not True:
        found.append("a check of its model against the closed chain failed")
    if not record.get("recordings"):
        found.append("its model was compared with no recording")
    elif record.get("consistent") is not True:
        found.append("its model's error against recordings is above the noise")
    return found
