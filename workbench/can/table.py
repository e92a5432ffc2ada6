"""Base of all tables of a configuration: only known keys, and valid numbers."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, field_validator

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


class Table(BaseModel):
    """A table with known keys only."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @field_validator("*", mode="before")
    @classmethod
    def _no_truth(cls, value: Any) -> Any:
        """Nothing here is true or false, and a number that is would become 1 or 0."""
        if any(isinstance(each, bool) for each in (value if isinstance(value, list) else [value])):
            raise ValueError("true and false are not allowed here")
        return value
