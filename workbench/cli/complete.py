"""Shell completion: what may follow, read from file names and their text.

A shell waits for this at the press of a key, so nothing that is slow to import may be imported here.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import typer

import workbench
from workbench.core import InputError
from workbench.core.paths import models_folder
from workbench.core.xml import parse_xml

#: Names that commands take; the tests hold them against what there is.
TASKS = ("reach", "pitch-in-place", "circular")
TARGETS = "mujoco", "mujoco3", "mjlab", "newton", "urdf"
VARIANTS = ("kin_only", "s3n_act", "s3n_full", "exact")
LEGS = ("none", "leg_rand", "heavy_leg_rand")
DEVICES = ("cpu", "cuda")
LOGGERS = ("tensorboard", "wandb", "none")
RIGS = ("leg", "leg_on_plate", "actuator")
EXPERIMENTS = {
    "leg": (
        *("chirp_hip", "chirp_knee", "multisine_sum", "multisine_diff", "slow", "validation"),
        *("range_sweep", "dither", "steps", "ladder_hip", "ladder_knee", "work_and_rest"),
    ),
    "leg_on_plate": ("press", "step", "slide", "walk"),
}

_EFFECTS = Path(workbench.__file__).parent / "effects"
_MOVING = "hinge", "slide", "revolute", "continuous", "prismatic"  # of MJCF, of URDF
_LARGEST = 2**20  # bytes of a model file that is read for the names of its axes


def models(incomplete: str) -> list[str]:
    """Return shipped models and model files in this folder; the shell completes other paths."""
    if "/" in incomplete:
        return []
    shipped = sorted(p.stem for p in models_folder().glob("*.toml"))
    here = sorted(p.name for p in Path().glob("*") if p.suffix in (".toml", ".xml", ".urdf") and _is_model(p))
    return _begun(incomplete, [*shipped, *here])


def effects(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return effects of the catalogue, each in every place of the named model."""
    return _begun(incomplete, _places(_axes(ctx.params.get("model") or "")))


def hidden(incomplete: str) -> list[str]:
    """Return effects that the virtual leg may hide."""
    return _begun(incomplete, _places(("hip", "knee")))


def values(ctx: typer.Context, incomplete: str) -> list[str]:
    """Parameters of the effect; its axis if the shell splits ``effect@axis`` at the ``@``, as bash does."""
    axes, given = _axes(ctx.params.get("model") or ""), list(ctx.params.get("values") or ())
    if incomplete == "@":
        return [_AfterAt(axis) for axis in axes]
    if given == ["@"]:
        return _begun(incomplete, axes)
    effect, taken = (ctx.params.get("effect") or "").partition("@")[0], {v.partition("=")[0] for v in given}
    return _begun(incomplete, [f"{name}=" for name in parameter_names(effect) if name not in taken])


class _AfterAt(str):
    """An axis after an ``@`` that stays: typer drops what does not begin with the word it was asked for."""

    def startswith(self, *_: Any) -> bool:
        return True


def _of(names: Sequence[str]) -> Callable[[str], list[str]]:
    """Return those of the names that begin with the word."""

    def begun(incomplete: str) -> list[str]:
        return _begun(incomplete, names)

    return begun


tasks, variants, targets = _of(TASKS), _of(VARIANTS), _of(TARGETS)
legs, devices, loggers = _of(LEGS), _of(DEVICES), _of(LOGGERS)
rigs = _of(RIGS)  # a CAN file is the shell's to complete


def experiments(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return experiments of a rig that were not named yet."""
    named = ctx.params.get("experiments") or ()
    known = EXPERIMENTS.get(ctx.params.get("rig") or "", ())
    return _begun(incomplete, [name for name in known if name not in named])


@cache
def effect_names() -> dict[str, bool]:
    """Return every effect of the catalogue, and whether it acts on all axes at once.

    An effect is one file of its name that says so; reading is far quicker than importing them.
    """
    found = {}
    for file in sorted(_EFFECTS.glob("*.py")):
        text = file.read_text(encoding="utf-8")
        if re.search(rf'^    name = "{file.stem}"$', text, re.MULTILINE):
            found[file.stem] = re.search(r"^    locations = WHOLE$", text, re.MULTILINE) is not None
    return found


def parameter_names(effect: str) -> tuple[str, ...]:
    """Return parameters of an effect, read like `effect_names`; none if there is no such effect."""
    if effect not in effect_names():
        return ()
    text = (_EFFECTS / f"{effect}.py").read_text(encoding="utf-8")
    return tuple(re.findall(r'\bParameter\(\s*"(\w+)"', text))


def _places(axes: tuple[str, ...]) -> list[str]:
    """Return ``effect`` or ``effect@axis``, whichever the effect needs."""
    found: list[str] = []
    for name, on_all in effect_names().items():
        found += [name] if on_all or not axes else [f"{name}@{axis}" for axis in axes]
    return found


def _axes(model: str) -> tuple[str, ...]:
    """Return the axes that a model's file names; none if it does not name them plainly."""
    given = Path(model)
    file = given if given.is_file() else models_folder() / f"{given.stem}.toml"
    try:
        text = file.read_bytes()[:_LARGEST]
        if file.suffix in (".xml", ".urdf"):
            joints = parse_xml(text, file).iter("joint")
            names: Any = [j.get("name") for j in joints if j.get("type", "hinge") in _MOVING]
        else:
            table: Any = tomllib.loads(text.decode())
            names = table.get("axes") or table.get("transmission", {}).get("joints") or []
    except (OSError, ValueError, AttributeError, InputError):
        return ()
    return tuple(name for name in names if isinstance(name, str))


def _is_model(file: Path) -> bool:
    """Return whether a file's text looks like a model's; recordings and designs also end in .toml."""
    try:
        text = file.read_bytes()[:_LARGEST]
    except OSError:
        return False
    sign = {".xml": rb"<mujoco", ".urdf": rb"<robot"}.get(file.suffix, rb"(?m)^serial\s*=")
    return re.search(sign, text) is not None


def _begun(incomplete: str, names: Any) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
