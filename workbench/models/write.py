"""Writing models: TOML files that read back equal."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from workbench.core import Mechanism, together
from workbench.core.files import write_whole
from workbench.core.paths import models_folder
from workbench.core.text import plain

from .model import VARIANTS, AppliedEffect, Linkage, Model
from .stated_effects import structural_effect


def write_model(model: Model, path: str | Path, *, force: bool = False) -> None:
    """Write a model as TOML, whole or not at all; it reads back equal.

    Raises:
        InputError: the file exists and `force` is not set, or cannot be written.
    """
    write_whole(path, model_text(model, path), force=force)


def model_text(model: Model, path: str | Path) -> str:
    """Return the text of a model file for the place `path`."""
    text = tomli_w.dumps(model_table(model, Path(path).resolve().parent))
    name = " ".join(plain(model.name).split())  # a comment ends with its line
    return f"# {name}: written by workbench.\n" + _arrays_on_one_line(text)


def _arrays_on_one_line(text: str) -> str:
    """Put innermost arrays on one line; nothing else changes."""
    return re.sub(
        r"\[\n([^\[\]{}]*?),?\n\s*\]",
        lambda m: "[" + ", ".join(x.strip() for x in m[1].split(",\n")) + "]",
        text,
    )


def model_table(model: Model, folder: Path) -> dict[str, Any]:
    """Return the model as nested tables of a model file in `folder`."""
    # a structural effect that was taken out or given other values makes it no longer that variant
    inside = tuple(structural_effect(name, model.linkage) for name in VARIANTS[model.variant])
    variant = model.variant if model.effects[: len(inside)] == inside else "kin_only"
    skip = len(VARIANTS[variant])
    n = len(model.driven)  # of a base that floats the MJCF speaks
    table: dict[str, Any] = {
        "format": 1,
        "name": model.name,
        "serial": _relative(model.serial, folder),
        "variant": variant,
        "axes": list(model.driven),
        "transmission": {
            "joints": list(model.joints[:n]),
            "matrix": model.transmission[:n, :n].tolist(),
            **({"posture_dependent": True} if model.posture_dependent else {}),
        },
        "actuators": {
            "inertia": list(model.actuators.inertia[:n]),
            "damping": list(model.actuators.damping[:n]),
            "delay_s": model.actuators.delay_s,
            **({"full_braking": True} if model.actuators.full_braking else {}),
        },
    }
    if any(np.isfinite(model.actuators.torque_limit[:n])):
        table["actuators"]["torque_limit"] = list(model.actuators.torque_limit[:n])
    if model.closed_chain:
        table["closed_chain"] = _closed_chain_table(model.closed_chain, folder)
    if model.controller.kind != "unknown":
        c = model.controller
        entries = {k: list(getattr(c, k)) for k in ("kp", "kd", "kv", "gain", "limit") if getattr(c, k)}
        table["controller"] = {"kind": c.kind, "coordinates": c.coordinates, **entries}
        if c.period_s:
            table["controller"]["period_s"] = c.period_s
        if c.velocity:
            table["controller"]["velocity"] = c.velocity
    if model.linkage:
        table["linkage"] = linkage_table(model.linkage)
    if model.payload_site:
        table["payload"] = {"site": model.payload_site}
    table["friction"] = {"sliding_speed": model.sliding_speed}
    if model.friction_as_in_mjcf:
        table["friction"]["as_in_mjcf"] = True
    if model.flank_retardation_s:
        table["backlash"] = {"retardation_s": model.flank_retardation_s}
    if model.ground:
        stated = {k: v for k, v in vars(model.ground).items() if v is not None}
        table["ground"] = {**stated, "feet": list(model.ground.feet)}
    table["effects"] = together([_effect_table(e) for e in model.effects[skip:]])
    if not table["effects"]:
        del table["effects"]
    return table


def linkage_table(linkage: Linkage) -> dict[str, Any]:
    """Return a linkage as in ``[linkage]`` and JSON; without the crank if that is unknown."""
    table = dict(vars(linkage))
    crank = table.pop("crank")
    return table | ({"crank": dict(vars(crank))} if crank else {})


def _closed_chain_table(chain: Mechanism, folder: Path) -> dict[str, Any]:
    table: dict[str, Any] = {
        "file": _relative(chain.file, folder),
        "drives": list(chain.drives),
        "joints": list(chain.joints),
        "loops": [list(pair) for pair in chain.loops],
    }
    if chain.foot:
        table["foot"] = chain.foot
    if chain.start:
        table["start"] = dict(chain.start)
    if chain.limits:
        table["limits"] = [list(pair) for pair in chain.limits]
    if chain.couplings:
        table["couplings"] = [
            {
                "joint": c.joint,
                **({"follows": c.follows} if c.follows else {}),
                "polynomial": list(c.polynomial),
            }
            for c in chain.couplings
        ]
    return table


def _effect_table(effect: AppliedEffect) -> dict[str, Any]:
    entry: dict[str, Any] = {"effect": effect.key.effect}
    if effect.key.axis:
        entry["axis"] = effect.key.axis
    entry["location"] = effect.key.location
    if effect.key.copy > 1:
        entry["copy"] = effect.key.copy
    entry["parameters"] = {k: dict(vars(v)) for k, v in effect.parameters.items()}
    return entry


def _relative(path: Path, folder: Path) -> str:
    """Return a path that can be found again: in the shipped models, or relative to the new file's folder."""
    for root in (models_folder().resolve(), folder):
        # one of the same name beside the new file would be found first
        if path.is_relative_to(root) and (root == folder or not (folder / path.relative_to(root)).exists()):
            return path.relative_to(root).as_posix()
    try:
        return Path(os.path.relpath(path.resolve(), folder)).as_posix()
    except ValueError:  # on another drive of Windows
        return path.as_posix()
