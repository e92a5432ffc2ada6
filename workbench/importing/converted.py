"""What is made of a file that states its loops in a way that the mechanism's parser does not read."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core import Coupling
from workbench.mechanism.parse import GRAVITY


@dataclass(frozen=True, kw_only=True)
class Beside:
    """What a file says beside its tree of links and joints.

    Attributes:
        couplings: joints that follow others, or are held, by the file's own word.
        round_rods: ball joints of an MJCF that are taken as universal ones.
        armature: joint -> what an MJCF has there [kg m^2 or kg].
        torque_limit: joint -> what its motor, or the joint of a URDF or SDF, has [N m or N]; inf or no entry
            without a limit.
        damping, friction: joint -> what the file has there; dry friction [N m or N].
        motors: joints that motors turn, as far as the file says.
        springs: joints that springs hold where they are.
        said_by: a file beside it that states loops, by name.
        gravity: downward, as the file has it [m/s^2].
    """

    couplings: tuple[Coupling, ...] = ()
    round_rods: tuple[str, ...] = ()
    armature: dict[str, float] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    friction: dict[str, float] = field(default_factory=dict)
    torque_limit: dict[str, float] = field(default_factory=dict)
    motors: tuple[str, ...] = ()
    springs: tuple[str, ...] = ()
    said_by: str = ""
    gravity: float = GRAVITY


@dataclass(frozen=True)
class Converted(Beside):
    """A file that states its loops itself as one with its loops cut open.

    Attributes:
        text: of the file, SDF or URDF.
        suffix: of that file.
        loops: pairs of frames in it that coincide.
        closed: number of loops; whole frames that coincide are three pairs.
        start: joint -> where it is in a posture that the file states [rad or m].
    """

    text: str
    suffix: str
    loops: tuple[tuple[str, str], ...]
    closed: int
    start: dict[str, float] = field(default_factory=dict)
