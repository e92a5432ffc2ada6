"""Check that a file with new numbers is the same machine as a model with effects."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from workbench.core import InputError, WorkbenchError
from workbench.models import Inertial, Model, check_mjcf, is_urdf

from .build import compile_plant
from .stiffness import tendon_row

_SAME = 1e-9  # of the largest number of its kind
_POSTURES = 8


def check_same(model: Model, file: Path, content: bytes) -> None:
    """Compare the model with one that reads this content in place of a file and has no effects.

    Mass matrix, forces of gravity and motion, those of springs and dampers, and dry friction, at random
    postures and speeds.

    Raises:
        InputError: they differ, or MuJoCo cannot use the new one; says in what.
    """
    there, here = compile_plant(model).mujoco, _read(model, file, content)
    for what, one, other in zip(_WHAT, _numbers(there), _numbers(here), strict=True):
        _check(what, one, other, file)


def check_inertials(model: Model, file: Path, content: bytes, inertials: Mapping[str, Inertial]) -> None:
    """Check that MuJoCo takes these inertials of bodies, by joint, from this content in place of a file.

    Raises:
        InputError: it takes others, or cannot use them; says which.
    """
    here = _read(model, file, content)
    for joint, wanted in inertials.items():
        found = Inertial.of(here, int(here.joint(joint).bodyid[0]))
        for what in ("mass", "centre", "tensor"):
            name = f"{what.replace('tensor', 'inertia')} of the body of {joint}"
            _check(name, np.asarray(getattr(wanted, what)), np.asarray(getattr(found, what)), file)


def _read(model: Model, file: Path, content: bytes) -> mujoco.MjModel:
    """Return what MuJoCo makes of the model with this content in place of a file, without effects."""
    with tempfile.TemporaryDirectory() as folder:
        serial = _copy(model.serial, Path(folder), file, content)
        try:
            return compile_plant(replace(model, serial=serial, effects=())).mujoco
        except WorkbenchError as error:
            said = str(error).replace(folder, str(model.serial.parent))
            raise InputError(f"with these numbers it is not a possible machine: {said}", file=file) from error


def _check(what: str, one: np.ndarray, other: np.ndarray, file: Path) -> None:
    if not np.max(np.abs(one - other), initial=0.0) <= _SAME * np.max(np.abs(one), initial=0.0):
        raise InputError(
            f"with these numbers it is not the model: the {what} differs", file=file,
            remedy="a setting of the file overrides them (inertiafromgeom, settotalmass, a flag): take "
                "it out, or write the model as .toml",
        )  # fmt: skip


_WHAT = "mass matrix", "torque of gravity and motion", "torque of springs and dampers", "dry friction"


def _numbers(m: mujoco.MjModel) -> tuple[np.ndarray, ...]:
    generator, data = np.random.default_rng(0), mujoco.MjData(m)
    rows: list[tuple[np.ndarray, ...]] = []
    for _ in range(_POSTURES):
        data.qpos[:], data.qvel[:] = generator.uniform(-1.5, 1.5, m.nq), generator.normal(0.0, 2.0, m.nv)
        mujoco.mj_fwdPosition(m, data)
        mujoco.mj_fwdVelocity(m, data)
        mass = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, data, mass)
        rows.append((mass, data.qfrc_bias.copy(), data.qfrc_passive.copy()))
    return (*(np.stack(each) for each in zip(*rows, strict=True)), _dry(m))


def _dry(m: mujoco.MjModel) -> np.ndarray:
    """Return the dry friction of joints (with that of tendons on one joint) and of each other tendon."""
    joints, others = m.dof_frictionloss.copy(), m.tendon_frictionloss.copy()
    for k in range(m.ntendon):
        row = np.abs(tendon_row(m, m.tendon(k).name))
        if np.count_nonzero(row) == 1:
            joints += row * others[k]
            others[k] = 0.0
    return np.concatenate([joints, others])


def _copy(serial: Path, folder: Path, file: Path, content: bytes) -> Path:
    """Return a folder with the serial tree and all files it reads, with this content in place of one file."""
    for each in [serial] if is_urdf(serial) else check_mjcf(serial):
        target = folder / os.path.relpath(each, serial.parent)
        target.parent.mkdir(parents=True, exist_ok=True)
        if each.resolve() == file.resolve():
            target.write_bytes(content)
        else:
            shutil.copyfile(each, target)
    return folder / serial.name
