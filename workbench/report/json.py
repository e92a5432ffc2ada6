"""Results as JSON: the stable schema that other programs read (keys are added at the end, never changed)."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from workbench.core import (
    FORMAT,
    Comparison,
    Diagnosis,
    Finding,
    Improvement,
    RecordingError,
    Shape,
    Step,
    Verification,
    together,
)
from workbench.core.files import write_whole

from .json_parts import clean, effect_dict, key_dict, key_dicts, picked, share_dicts
from .told_apart import disagreement_dicts, identifiability_dict
from .trace import trace_dicts

Truth = Sequence[Mapping[str, Any]]
_CHECK = "name", "value", "tolerance", "passed", "unit", "about", "hint"


def comparison_dict(result: Comparison) -> dict[str, Any]:
    """Return the JSON of ``workbench compare``."""
    return clean(
        {
            "format": FORMAT,
            "model": result.model,
            "error": result.error,
            "noise_error": result.noise_error,
            "recordings": [_recording(r) for r in result.recordings],
            "consistent": bool(result.consistent),
            "noise_error_std": result.noise_error_std,
            "where": share_dicts(result.where),
            "inverse_dynamics": result.inverse_dynamics,
            "notes": list(result.notes),
            "outlier": None if result.outlier is None else vars(result.outlier),
        }
    )


def diagnosis_dict(result: Diagnosis) -> dict[str, Any]:
    """Return the JSON of ``workbench diagnose``."""
    return clean(
        {
            "format": FORMAT,
            "verdict": result.verdict,
            "error": result.error,
            "noise_error": result.noise_error,
            "findings": together([_finding(f) for f in result.findings]),
            "unexplained": {
                "fraction": result.unexplained_fraction,
                "where": share_dicts(result.where),
                "evidence": list(result.evidence),
                "shapes": [_shape(s) for s in result.shapes],
            },
            "next_experiment": result.next_experiment,
            "not_excited": key_dicts(result.not_excited),
            "settled": dict(result.settled),
            "model": result.model,
            "ranking": [{**key_dict(key), "share": share} for key, share in result.ranking],
            "holdout_noise_error": result.holdout_noise_error,
            "used": result.used,
            "notes": list(result.notes),
            "near": [_finding(f) for f in result.near],
            "stopped": result.stopped,
            "identifiability": identifiability_dict(result.identifiability),
            "disagreeing": disagreement_dicts(result.disagreeing),
            "trace": trace_dicts(result.trace),
            "mend": list(result.mend),
            "mend_recordings": key_dicts(result.mend_recordings),
        }
    )


def improvement_dict(result: Improvement, truth: Truth | None = None) -> dict[str, Any]:
    """Return the JSON of ``workbench improve``; with `truth`, of ``workbench demo``.

    Args:
        result: the way from a model to a better one.
        truth: what the virtual hardware hid: mappings with ``effect``, ``axis`` and ``parameters``.
            It stands after all else.
    """
    out: dict[str, Any] = {
        "format": FORMAT,
        "steps": [_step(s) for s in result.steps],
        "error_before": result.error_before,
        "error_after": result.error_after,
        "holdout_error_before": result.holdout_error_before,
        "holdout_error_after": result.holdout_error_after,
        "noise_error": result.noise_error,
        "verdict": result.verdict,
        "holdout_noise_error": result.holdout_noise_error,
        "model": result.model,
        "used": result.used,
        "notes": list(result.notes),
        "nearest": result.nearest,
        "near": [_finding(f) for f in result.diagnosis.near] if result.diagnosis else [],
        "stopped": result.diagnosis.stopped if result.diagnosis else None,
        "mend": list(result.diagnosis.mend) if result.diagnosis else [],
        "mend_recordings": key_dicts(result.diagnosis.mend_recordings) if result.diagnosis else [],
    }
    if truth is not None:
        out["truth"] = [
            {
                "effect": t["effect"],
                "axis": t.get("axis"),
                "parameters": t.get("parameters", {}),
                **{k: v for k, v in t.items() if k not in ("effect", "axis", "parameters")},
            }
            for t in truth
        ]
    return clean(out)


def verification_dict(result: Verification) -> dict[str, Any]:
    """Return the JSON of ``workbench check``."""
    return clean(
        {
            "format": FORMAT,
            "passed": result.passed,
            "checks": [picked(c, *_CHECK) for c in result.checks],
            "variants": {name: {"M_at_90deg": list(m)} for name, m in result.variants.items()},
            "explicit_spectral_radius": {"alpha_deg": result.alpha_deg, "radius": result.radius},
            "model": result.model,
            "facts": {
                name: dict(zip(("value", "unit", "about"), fact, strict=True))
                for name, fact in result.facts.items()
            },
            "not_checked": list(result.not_checked),
        }
    )


def dumps(obj: Mapping[str, Any]) -> str:
    """Return `obj` as JSON text: two spaces of indent, NaN and infinity as null, a newline at the end."""
    return json.dumps(clean(obj), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write_json(obj: Mapping[str, Any], path: str | Path, *, force: bool = False) -> None:
    """Write `obj` to a file, complete or not at all, or to standard output if `path` is ``"-"``.

    Raises:
        InputError: the file exists and `force` is false, or it cannot be written.
    """
    text = dumps(obj)
    if str(path) == "-":
        sys.stdout.write(text)
        sys.stdout.flush()
    else:
        write_whole(path, text, force=force)


def _recording(r: RecordingError) -> dict[str, Any]:
    ground = () if r.ground_force_rmse is None else ("ground_force_rmse", "ground_force_noise")
    scores = "position_rmse", "torque_rmse", "position_noise", "torque_noise", "error", "noise_error"
    return {
        "name": r.recording.name,
        "axes": r.recording.axes,
        **picked(r, *scores),
        "units": r.recording.units,
        "coordinates": r.recording.coordinates,
        **picked(r, *ground),
    }


def _shape(s: Shape) -> dict[str, Any]:
    return {
        "axis": s.axis,
        "of": s.quantities,
        "units": s.units,
        "frequency_hz": s.frequency,
        **picked(s, "share", "grid", "torque", "std", "torque_unit"),
    }


def _finding(f: Finding) -> dict[str, Any]:
    return {
        **effect_dict(f.key, f.parameters),
        **picked(f, "error_after", "holdout_error_before", "holdout_error_after", "probability"),
        "indistinguishable_from": key_dicts(f.indistinguishable_from),
        "evidence": list(f.evidence),
        **({} if f.total is None else picked(f, "model_value", "total")),
    }


def _step(s: Step) -> dict[str, Any]:
    return {
        **effect_dict(s.key, s.parameters),
        "error": s.error,
        "holdout_error": s.holdout_error,
        "indistinguishable_from": key_dicts(s.indistinguishable_from),
        "evidence": list(s.evidence),
        "removed": key_dicts(s.removed),
    }
