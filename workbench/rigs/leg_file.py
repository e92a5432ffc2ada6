"""The SDF of the reference leg with longer links, or with a heavier shank.

A length error moves pins, not mass: every mass, mass centre (from the link's own upper pin) and central
inertia stays. On the thigh the distance hip to knee grows, and the coupler with it, so that opposite sides of
the parallelogram stay equal. On the shank the distance knee to foot grows; rear arm and crank stay, so that
on a fixed base only a payload feels it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

from workbench.core.paths import closed_chain_file

#: Frames and links whose pose lies at the end of thigh and shank.
_ENDS = (("link[@name='shank']", "frame[@name='coupler_end']"), ("frame[@name='foot']",))
_INERTIAS = ("mass", "inertia/ixx", "inertia/iyy", "inertia/izz")


@contextmanager
def leg_file(longer: tuple[float, float] = (0.0, 0.0), shank: float = 1.0) -> Iterator[Path]:
    """Write an SDF file of the leg; it is deleted at the end of the ``with`` block.

    Args:
        longer: by how much thigh and shank are longer than nominal [m].
        shank: factor of the shank's mass and inertia.
    """
    nominal = closed_chain_file("leg")
    if not any(longer) and shank == 1.0:
        yield nominal
        return
    document = ElementTree.parse(nominal)
    model = _only(document.getroot(), "model")
    for ends, more in zip(_ENDS, longer, strict=True):
        for end in ends:
            pose = _only(model, f"{end}/pose")
            x, y, z, *turn = (pose.text or "").split()
            pose.text = " ".join([x, y, repr(float(z) - more), *turn])
    for name in _INERTIAS:
        entry = _only(model, f"link[@name='shank']/inertial/{name}")
        entry.text = repr(float(entry.text or "") * shank)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "leg.sdf"
        document.write(file)
        yield file


def leg_mass() -> float:
    """Return the mass of all links of the reference leg [kg]."""
    return sum(float(mass.text or "") for mass in ElementTree.parse(closed_chain_file("leg")).iter("mass"))


def _only(parent: ElementTree.Element, path: str) -> ElementTree.Element:
    found = parent.findall(path)
    if len(found) != 1:
        raise LookupError(f"the leg's SDF has {len(found)} of {path}")
    return found[0]
