"""The grammar of a model file, checked by pydantic."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from .model import VARIANTS

MOST = 1e12  # SI; no machine has more of anything, and the square of it is still a number
_Number = Annotated[float, Field(ge=-MOST, le=MOST)]
_Quantity = Annotated[float, Field(ge=0.0, le=MOST)]
_Positive = Annotated[float, Field(gt=0.0, le=MOST)]
_Limit = Annotated[float, Field(gt=0.0)]  # infinite: none


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class TransmissionTable(_Table):
    """``[transmission]``: q_p = matrix @ q_s over these MJCF joints."""

    joints: list[str]
    matrix: list[list[_Number]] | None = None
    posture_dependent: bool = False


class CouplingTable(_Table):
    """``[[closed_chain.couplings]]``: a joint that follows another, or is held where none is named."""

    joint: str
    follows: str | None = None
    polynomial: Annotated[list[_Number], Field(min_length=1)]


class ClosedChainTable(_Table):
    """``[closed_chain]``: the real mechanism; names that are left out are the reference leg's."""

    file: str
    drives: list[str] = ["hip", "crank_pin"]
    joints: list[str] = ["hip", "knee"]
    loops: list[tuple[str, str]] = []  # none named: those that the file itself declares
    foot: str | None = None
    start: dict[str, _Number] = Field(default_factory=dict)
    limits: list[tuple[_Number, _Number]] = []
    couplings: list[CouplingTable] = []


class ActuatorTable(_Table):
    """``[actuators]``: one value per axis, or one for all."""

    inertia: list[_Quantity] | _Quantity = 0.0
    damping: list[_Quantity] | _Quantity = 0.0
    torque_limit: list[_Limit] | _Limit = float("inf")
    delay_s: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    full_braking: bool = False


class ControllerTable(_Table):
    """``[controller]``, as in a recording."""

    kind: Literal["none", "pd", "cascade_pv", "unknown"]
    coordinates: Literal["joint", "actuator"] = "actuator"
    kp: list[_Quantity] | _Quantity = []
    kd: list[_Quantity] | _Quantity = []
    kv: list[_Quantity] | _Quantity = []
    gain: list[_Quantity] | _Quantity = []
    limit: list[_Limit] | _Limit = []
    period_s: _Positive | None = None
    velocity: Literal["sensor", "difference"] | None = None


class CrankTable(_Table):
    """``crank`` of ``[linkage]``: what of the increments turns with the knee's drive."""

    M12: _Number = 0.0
    M22: _Number = 0.0
    g2: _Number = 0.0


class LinkageTable(_Table):
    """``[linkage]``: increments of the parallelogram over the serial tree."""

    M11: _Number = 0.0
    M12: _Number = 0.0
    M22: _Number = 0.0
    g1: _Number = 0.0
    g2: _Number = 0.0
    identified: bool = False
    crank: CrankTable | None = None


class PayloadTable(_Table):
    """``[payload]``: the MJCF site where a payload hangs."""

    site: str


_Deviation = Annotated[float, Field(ge=0.0)]


class ParameterTable(_Table):
    """One parameter of an effect: ``{value = 0.25, std = 0.003, unit = "N*m"}``; lists where it repeats."""

    value: _Number | list[_Number]
    std: _Deviation | list[_Deviation] = 0.0
    unit: str = ""


class FrictionTable(_Table):
    """``[friction]``: how dry friction sets in."""

    sliding_speed: _Positive = 0.0005
    as_in_mjcf: bool = False


class BacklashTable(_Table):
    """``[backlash]``: how flanks meet."""

    retardation_s: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0


class GroundTable(_Table):
    """``[ground]``: what the feet stand on, for recordings on the ground."""

    feet: Annotated[list[str], Field(min_length=1)]
    radius: _Positive | None = None
    height: _Number | None = None
    surface: str | None = None
    friction: _Quantity | None = None
    stiffness: _Positive | None = None
    damping: _Quantity | None = None


class EffectTable(_Table):
    """``[[effects]]``: one effect that was added."""

    effect: str
    axis: str | None = None
    location: Literal["actuator", "joint"] = "actuator"
    parameters: dict[str, ParameterTable | _Number | list[_Number]] = Field(default_factory=dict)


class ModelTable(_Table):
    """A whole model file."""

    format: Literal[1]
    name: str
    serial: str
    closed_chain: str | ClosedChainTable | None = None
    variant: Literal["kin_only", "s3n_act", "s3n_full", "exact"] = "kin_only"
    axes: list[str] | None = None
    transmission: TransmissionTable | None = None
    actuators: ActuatorTable = ActuatorTable()
    controller: ControllerTable | None = None
    linkage: LinkageTable | None = None
    payload: PayloadTable | None = None
    friction: FrictionTable = FrictionTable()
    backlash: BacklashTable = BacklashTable()
    ground: GroundTable | None = None
    effects: list[EffectTable] = Field(default_factory=list)


assert set(VARIANTS) == set(ModelTable.model_fields["variant"].annotation.__args__)  # type: ignore[union-attr]
