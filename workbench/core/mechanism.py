"""What must be stated about a closed chain beside its SDF or URDF file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .coupling import Coupling, declared_couplings


@dataclass(frozen=True)
class Mechanism:
    """A mechanism with loops: the tree in the file, and the places where its loops close.

    Attributes:
        file: SDF or URDF of the tree that is left when every loop is cut.
        drives: joints of the file that the motors turn, in the order of a model's axes.
        joints: joints of the file that are the serial coordinates, in the order of a model's joints.
        loops: pairs of frames whose origins coincide where the loops are closed.
        foot: frame at the end of the leg, if one is named.
        start: angles of the file's joints near a closed posture [rad or m], where assembly begins and which
            picks the branch; zero for joints not named.
        limits: lower and upper limit of each serial coordinate [rad or m], in the order of `joints`.
        couplings: joints that follow others or are held; those of the file (``<mimic>``) need not be named.
        rest: angles in a posture that the file itself states [rad or m]. Assembly begins there. Where loops
            close in several ways, `start` decides, and these only where `start` names no joint of the loops.
    """

    file: Path
    drives: tuple[str, ...] = ("hip", "crank_pin")
    joints: tuple[str, ...] = ("hip", "knee")
    loops: tuple[tuple[str, str], ...] = (("coupler_end", "rear_arm_end"),)
    foot: str | None = "foot"
    start: tuple[tuple[str, float], ...] = ()
    limits: tuple[tuple[float, float], ...] = ()
    couplings: tuple[Coupling, ...] = ()
    rest: tuple[tuple[str, float], ...] = ()

    def all_couplings(self) -> tuple[Coupling, ...]:
        """Return the couplings named here, then those of the file for other joints.

        Raises:
            InputError: the file cannot be read, or a ``<mimic>`` in it is none.
        """
        named = {coupling.joint for coupling in self.couplings}
        own = (coupling for coupling in declared_couplings(self.file) if coupling.joint not in named)
        return (*self.couplings, *own)
