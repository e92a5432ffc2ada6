"""What the law of the contact does to the lap; the hardware's ground is that of the force plate."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from transfer_crossed import Study, Values, cells, collected, crossed, paired, table
from transfer_floor import ON_PLATE, identified_law
from transfer_measures import GAIT
from transfer_runs import Made
from transfer_worlds import EVALUATION, TRAINED, TRAINING, IdentifiedLaw, Law

Gaps = Callable[[Made, Made], dict[str, float]]
_MEASURES = "E_phi", "stride frequency", "duty factor", "foot force over the stride"
_DAMPINGS = 150.0, 200.0, 261.0  # N s/m: the plate's; what Drake's steps make of it; still more
_FINE_S = 0.0001


def laws_table(study: Study, seconds: float, gaps: Gaps) -> dict[str, Values]:
    """Default, training, evaluation and, where effects were looked for, the law of the plate."""
    laws: dict[str, Law] = {"default": TRAINED, "training": TRAINING, "evaluation": EVALUATION}
    if "found" in study.files:
        laws["identified"] = identified_law(study.files["found"], study.out / "models", study.seed)
    title = f"The law of the contact, S3N-Full's policies on the lap, {study.which}"
    return _under(study, "contact", title, seconds, gaps, laws, _MEASURES, "paired")


def damping_table(study: Study, seconds: float, gaps: Gaps) -> dict[str, Values]:
    """The plate's stiffness with its damping and with more, in steps that resolve both."""
    files = {name: file for name, file in study.files.items() if name != "s3n_act"}
    wanted = _DAMPINGS[:1] if study.quick else _DAMPINGS
    laws: dict[str, Law] = {f"{c:g} N s/m": IdentifiedLaw(1e5, c, 0.8, _FINE_S) for c in wanted}
    title = f"The damping of the contact, S3N-Full's policies on the lap, {study.which}"
    measures = [m for m in _MEASURES if m != "duty factor"]
    return _under(replace(study, files=files), "damping", title, seconds, gaps, laws, measures)


def _under(
    study: Study, name: str, title: str, seconds: float, gaps: Gaps, laws: Mapping[str, Law],
    measures: Sequence[str], *more: str,
) -> dict[str, Values]:  # fmt: skip
    """The table of some measures under each law; `more`: ``paired``, what pairs of simulators tell."""
    units, rows, out = study.policies("circular", "s3n_full"), [], {}
    for short, law in laws.items():
        hardware, again, simulated = crossed(study, units, seconds, ON_PLATE, law)
        values = collected(list(GAIT), hardware, again, simulated, gaps)
        for m in measures:
            label = f"{m} [{GAIT[m]}]" if GAIT[m] else m
            shown = cells(study, values[m], 2 if GAIT[m] else 3)
            rows.append((f"{label}, {short}: {law}", *shown, *(paired(study, values[m]) for _ in more)))
            out[f"{short}: {m}"] = values[m]
    table(study, name, title, len(units), rows, *more)
    return out
