"""A mechanism whose transmission changes with the posture, seen from its drives.

In the drives' own coordinates nothing changes with the posture but the torque that the links need:

    tau_p = A q_p'' + B q_p' + J^-T (M_links q_s'' + bias - gravity),     q_s'' = J^-1 (q_p'' - J' q_s'),

with everything behind J^-T from the closed chain's series. So a search can take the machine for rotors, a
drive each, that carry the links: what acts at a drive acts as in any other machine. More mass on a link that
a serial joint moves is behind J^-T too, and what it needs along q_s is what it needs in the serial tree.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import mujoco
import numpy as np

from workbench.core import CarriedMotion, DriveMap
from workbench.effects import axis_units
from workbench.models import Model, load_tree

from .drive_map import drive_map
from .posture import PostureDependent
from .posture_closure import LoopClosure

_GRAIN = 1e-9  # kg and kg m^2: what a rotor of no inertia is given, so that it can be compiled


class LinksOnDrives:
    """The links of a mechanism before any effect, as `core.Carried`.

    The closed chain is solved when a torque is asked for.

    Args:
        model: names its closed chain and limits.
    """

    def __init__(self, model: Model) -> None:
        self._model = replace(model, effects=())
        self.serial, self.joints = model.serial, model.joints

    @cached_property
    def _chain(self) -> PostureDependent:
        return PostureDependent(self._model)

    @cached_property
    def _map(self) -> DriveMap:
        found = drive_map(self._model, self._chain)
        assert found is not None
        return found

    def at(self, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> CarriedMotion:
        """Return the links at a posture, as `core.Carried`."""
        joints = self._chain.nearest_inside(self._map.joints(position))
        terms = self._chain.at(joints)
        slope = np.linalg.inv(terms.jacobian)
        rate = np.einsum("kij,kj->ki", slope, velocity)
        change = np.einsum("kij,kj->ki", slope, acceleration - terms.drive_rate(rate))
        torque = np.einsum("kij,kj->ki", terms.links, change) + terms.link_bias(rate) - terms.gravity
        return CarriedMotion(joints, rate, change, slope, terms.links, torque)

    def weights(self, position: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
        """Return masses of cranks and rods and what they ask of the drives, as `core.Carried`."""
        loops, own = LoopClosure(self._model), load_tree(self.serial)
        joints = self._chain.nearest_inside(self._map.joints(position[None]))[0]
        posture = loops.at(joints)
        back, rise, out = np.linalg.inv(posture.jacobian).T, np.zeros((3, loops.m.nv)), {}
        for body in range(1, loops.m.nbody):
            name = loops.m.body(body).name
            mujoco.mj_jacBodyCom(loops.m, loops.data, rise, None, body)
            asked = -back @ posture.slope.T @ rise.T @ loops.m.opt.gravity
            if asked.any() and own.body(name) is None:
                out[name] = float(loops.m.body_mass[body]), asked
        return out


def on_drives(model: Model) -> Model:
    """Return a model in the coordinates of its drives; the model itself if its transmission is constant."""
    if not model.posture_dependent:
        return model
    return replace(
        model,
        serial=_rotors(model.axes, axis_units(model)),
        joints=model.axes,
        transmission=np.eye(model.size),
        posture_dependent=False,
        carried=LinksOnDrives(model),
    )


def off_drives(found: Model, given: Model) -> Model:
    """Return what a search found on `on_drives` of a model, as that model with the same effects."""
    if found.carried is None:
        return found
    return replace(
        found,
        serial=given.serial,
        joints=given.joints,
        transmission=given.transmission,
        posture_dependent=given.posture_dependent,
        carried=None,
    )


@cache
def _folder() -> TemporaryDirectory[str]:
    """Return a folder that is kept until the process ends: a model names the file of its tree."""
    return TemporaryDirectory(prefix="workbench-drives-")


@cache
def _rotors(axes: tuple[str, ...], units: tuple[str, ...]) -> Path:
    """Write an MJCF with one body per drive and nothing else; return its path."""
    bodies = "".join(
        f'<body><joint name="{axis}" type="{"hinge" if unit == "rad" else "slide"}" axis="0 0 1"/>'
        f'<inertial pos="0 0 0" mass="{_GRAIN}" diaginertia="{_GRAIN} {_GRAIN} {_GRAIN}"/></body>'
        for axis, unit in zip(axes, units, strict=True)
    )
    folder = Path(_folder().name)
    file = folder / f"{len(list(folder.iterdir()))}.xml"
    file.write_text(f'<mujoco><option gravity="0 0 0"/><worldbody>{bodies}</worldbody></mujoco>')
    return file
