"""What the second leg hides, by the names of the catalogue."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True)
class Hidden:
    """One effect or outsider; attributes as of `workbench.rigs.HiddenEffect`, parameters SI."""

    effect: str
    axis: str | None = None
    location: Literal["actuator", "joint"] = "actuator"
    parameters: Mapping[str, float] = field(default_factory=dict)
