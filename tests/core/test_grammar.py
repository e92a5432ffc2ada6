"""The one line about a file that its grammar refuses."""

from __future__ import annotations

from typing import Annotated, Any

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from workbench.core.grammar import explained


class _Joint(BaseModel):
    model_config = ConfigDict(extra="forbid")

    name: str
    gain: Annotated[float, Field(ge=0.0)] | list[Annotated[float, Field(ge=0.0)]] = 0.0


class _Robot(BaseModel):
    model_config = ConfigDict(extra="forbid")

    joints: list[_Joint] = []
    tools: dict[str, _Joint] = {}
    base: _Joint | None = None


@pytest.mark.parametrize(
    ("content", "line"),
    [
        ({"joint": 1}, "key 'joint': unknown key 'joint'; did you mean 'joints'?"),
        ({"base": {"name": "a", "x": 1}}, "key 'base.x': unknown key 'x'; known keys: name, gain"),
        ({"tools": {"a": {"name": "a", "x": 1}}}, "key 'tools.a.x': unknown key 'x'; known keys: name, gain"),
        ({"joints": [{"gain": 1.0}]}, "key 'joints.0.name': is missing; add it"),
        ({"joints": [{"name": "a", "gain": [1.0, -2.0]}]},
         "key 'joints.0.gain.1': must be greater than or equal to 0, found -2.0; correct the value"),
        ({"base": {"name": 3}}, "key 'base.name': must be a valid string, found 3; correct the value"),
    ],
)  # fmt: skip
def test_names_the_key_as_the_file_has_it(content: dict[str, Any], line: str) -> None:
    with pytest.raises(ValidationError) as refused:
        _Robot.model_validate(content)
    assert str(explained(refused.value, _Robot, content, "robot.toml")) == f"robot.toml, {line}"
