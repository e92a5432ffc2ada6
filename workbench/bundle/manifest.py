"""The grammar of ``bundle.json``: what is needed to run a policy, checked; whatever else is known is kept."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, model_validator

_Name = Annotated[str, Field(max_length=200)]
_Positive = Annotated[float, Field(gt=0.0, le=1.0)]
_Numbers = list[FiniteFloat]
_MOST = 100_000  # numbers that a policy sees


class _Table(BaseModel):
    model_config = ConfigDict(extra="ignore", strict=True, frozen=True)


class ObservationTable(_Table):
    """A stretch of the policy's input."""

    name: _Name
    start: Annotated[int, Field(ge=0, le=_MOST)]
    size: Annotated[int, Field(gt=0, le=_MOST)]
    scale: FiniteFloat
    about: str


class DriveMapTable(_Table):
    """See `DriveMap`."""

    middle: _Numbers
    half: list[Annotated[float, Field(gt=0.0)]]
    powers: Annotated[list[list[Annotated[int, Field(ge=0, le=30)]]], Field(min_length=1, max_length=10_000)]
    factors: list[_Numbers]

    @model_validator(mode="after")
    def _one_a_joint(self) -> DriveMapTable:
        n, terms = len(self.middle), len(self.powers)
        fits = len(self.half) == len(self.factors) == n and all(len(row) == n for row in self.powers)
        if not fits or any(len(row) != terms for row in self.factors):
            raise ValueError("drive_map needs one entry per joint, and one factor per joint and term")
        return self


class ControlTable(_Table):
    """What its actions mean; see `Control`."""

    joints: Annotated[list[_Name], Field(min_length=1, max_length=1000)]
    transmission: list[_Numbers]
    posture: _Numbers
    action_scale: FiniteFloat
    kp: _Numbers
    kd: _Numbers
    torque_limit: list[Annotated[float, Field(gt=0.0)]]
    joint_limits: list[Annotated[list[float], Field(min_length=2, max_length=2)]]
    control_period_s: _Positive
    policy_period_s: _Positive
    delay_steps: Annotated[int, Field(ge=0, le=1000)]
    velocity_limit: Annotated[float, Field(gt=0.0)] | None = None
    tilt_limit: Annotated[float, Field(gt=0.0)] | None = None
    drive_map: DriveMapTable | None = None
    command_range: Annotated[list[list[FiniteFloat]], Field(min_length=3, max_length=3)] | None = None

    @model_validator(mode="after")
    def _one_an_axis(self) -> ControlTable:
        n = len(self.joints)
        for name in ("transmission", "posture", "kp", "kd", "torque_limit", "joint_limits"):
            if len(getattr(self, name)) != n:
                raise ValueError(f"{name} has {len(getattr(self, name))} entries for {n} joints")
        if any(len(row) != n for row in self.transmission):
            raise ValueError("the transmission is not square")
        if self.drive_map is not None and len(self.drive_map.middle) != n:
            raise ValueError(f"drive_map has {len(self.drive_map.middle)} joints, not {n}")
        if any(len(row) != 2 or row[0] > row[1] for row in self.command_range or []):
            raise ValueError("a command_range needs two numbers, lowest and highest")
        return self


class ManifestTable(_Table):
    """The whole manifest."""

    control: ControlTable
    task: _Name
    variant: _Name
    observations: Annotated[list[ObservationTable], Field(min_length=1, max_length=1000)]
