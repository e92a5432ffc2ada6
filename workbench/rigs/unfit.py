"""Errors in the parameters of an effect to hide, in a user's words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import Parameter, signature
from typing import Any

from workbench.core import InputError


def unfit(name: str, install: Callable[..., Any], given: Mapping[str, float]) -> InputError | None:
    """Return the error for parameters that an effect lacks or does not know; None if they fit.

    Args:
        name: of the effect.
        install: what puts it into a machine; its parameters are keyword-only.
        given: name -> value.
    """
    known = {k: p for k, p in signature(install).parameters.items() if p.kind is Parameter.KEYWORD_ONLY}
    lacking = [k for k, p in known.items() if p.default is Parameter.empty and k not in given]
    unknown = [k for k in given if k not in known]
    if not lacking and not unknown:
        return None
    said = [f"it has no {', '.join(unknown)}"] if unknown else []
    said += [f"it needs {', '.join(lacking)}"] if lacking else []
    sets = " ".join(f"--set {k}=VALUE" for k, p in known.items() if k in lacking or p.default is p.empty)
    remedy = f"give {sets or 'no --set'}; units are in docs/effects.md"
    return InputError(f"parameters of '{name}' do not fit: {' and '.join(said)}", remedy=remedy)
