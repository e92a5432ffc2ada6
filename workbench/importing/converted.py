"""What is made of a file that states its loops in a way that the mechanism's parser does not read."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core import Coupling


@dataclass(frozen=True)
class Converted:
    """A file that states its loops itself as one with its loops cut open.

    Attributes:
        text: of the file, SDF or URDF.
        suffix: of that file.
        loops: pairs of frames in it that coincide.
        closed: number of loops; whole frames that coincide are three pairs.
        couplings: joints that follow others, and those that are held.
        round_rods: ball joints that were taken as universal ones.
        armature, damping, torque_limit: joint -> what an MJCF has there, inf without a limit.
        motors: joints that motors turn, as far as the file says.
        springs: joints that springs hold where they are.
        start: joint -> where it is in a posture that the file states [rad or m].
        said_by: a file beside it that states loops, by name.
    """

    text: str
    suffix: str
    loops: tuple[tuple[str, str], ...]
    closed: int
    couplings: tuple[Coupling, ...] = ()
    round_rods: tuple[str, ...] = ()
    armature: dict[str, float] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    torque_limit: dict[str, float] = field(default_factory=dict)
    motors: tuple[str, ...] = ()
    springs: tuple[str, ...] = ()
    start: dict[str, float] = field(default_factory=dict)
    said_by: str = ""
