"""Task, machine and hardware of a bundle, and the model of its recordings."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from workbench.bundle import PolicyBundle
from workbench.bundle.bundle import MACHINE
from workbench.core import Controller, InputError
from workbench.core.paths import models_folder
from workbench.importing import described
from workbench.models import Actuators, Ground, Model, model_text, read_model
from workbench.models.mjcf import check_mjcf_text
from workbench.s3n import with_variant

from .injected import EXPLICIT
from .machine import LEGS, STEP_S, Machine, make_machine
from .task import Task
from .task_code import same_code
from .task_file import TASK_FILE, read_task
from .tasks import TASKS


def task_of(bundle: PolicyBundle, file: Path | None = None) -> Task:
    """Return the task of a bundle: the one that it contains, or a shipped one.

    Args:
        bundle: where it comes from.
        file: of a task that is Python, of which the bundle has the text alone.

    Raises:
        InputError: the task is unknown, or Python that is not named.
    """
    own = bundle.files.get(f"model/{TASK_FILE}.toml")
    if own is not None:
        return read_task(own.decode("utf-8", "replace"), bundle.source)
    code = bundle.files.get(f"model/{TASK_FILE}.py")
    if code is not None:
        return same_code(code.decode("utf-8", "replace"), file, bundle.source)
    if bundle.task not in TASKS:
        raise InputError(f"no task is called '{bundle.task}'", file=bundle.source, remedy="update workbench")
    return TASKS[bundle.task]


def machine_of(bundle: PolicyBundle, folder: Path, file: Path | None = None) -> Machine:
    """Return the machine with which a bundle was trained.

    Args:
        bundle: where it comes from.
        folder: an empty one, where the model's files go and have to stay as long as the machine is used.
        file: of a task that is Python.

    Raises:
        InputError: the bundle's task is unknown, or its model is not whole.
    """
    task = task_of(bundle, file)
    names = tuple(entry.name for entry in task.observations)
    if tuple(entry.name for entry in bundle.observations) != names:
        raise InputError(
            f"the bundle's observations are not those of '{task.name}'", file=bundle.source,
            remedy="train and export it again",
        )  # fmt: skip
    for name, data in bundle.files.items():
        target = folder / name
        if not target.resolve().is_relative_to(folder.resolve()):
            raise InputError(f"'{name}' leads out of the bundle", file=bundle.source)
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(data)
        except OSError as error:  # a part in a part, or a name longer than the system allows
            raise InputError(f"'{name}' cannot be unpacked", file=bundle.source) from error
    own, model = bundle.control, read_model(folder / "model" / "model.toml")
    for file in model.files:
        roots = folder.resolve(), models_folder().resolve()
        if not any(file.resolve().is_relative_to(root) for root in roots):
            raise InputError(f"its model names '{file}'", file=bundle.source, remedy="export it again")
    check_mjcf_text(bundle.machine, bundle.source)
    try:
        compiled = mujoco.MjModel.from_xml_string(bundle.machine)
    except (ValueError, mujoco.FatalError) as error:
        raise InputError(f"MuJoCo cannot read {MACHINE}: {error}", file=bundle.source) from error
    return replace(
        _made(task.machine, model, bundle),
        # the world that the policy was trained in, whatever this version would make of the model
        xml=bundle.machine,
        mujoco=compiled,
        transmission=own.transmission,
        map=own.map,
        posture=own.posture,
        kp=own.kp,
        kd=own.kd,
        torque_limit=own.torque_limit,
        delay_steps=own.delay_steps,
    )


def _made(kind: str, model: Model, bundle: PolicyBundle) -> Machine:
    if bundle.variant == EXPLICIT:
        return make_machine(kind, model, EXPLICIT)
    if not model.posture_dependent:
        return make_machine(kind, with_variant(model, bundle.variant))
    if bundle.control.map is None:
        raise InputError("its drive_map is missing", file=bundle.source, remedy="train and export it again")
    return make_machine(kind, model, fitted=(bundle.machine, bundle.control.map))


def robot_files(bundle: PolicyBundle, folder: Path, file: Path | None = None) -> dict[Path, str]:
    """Return a model for comparison with recordings of a walking policy, as text by file; empty for a leg.

    Raises:
        InputError: as `machine_of`.
    """
    with tempfile.TemporaryDirectory() as unpacked:
        return model_files(machine_of(bundle, Path(unpacked), file), folder)


def hardware_of(bundle: PolicyBundle, file: Path | None = None) -> str:
    """Return one line on the virtual hardware on which a bundle is evaluated.

    Raises:
        InputError: as `machine_of`.
    """
    with tempfile.TemporaryDirectory() as folder:
        machine = machine_of(bundle, Path(folder), file)
    if not machine.floating:
        whole = replace(machine.model.actuators, delay_s=machine.delay_steps * STEP_S)
        return described(replace(machine.model, actuators=whole))
    return (
        "Virtual hardware: the reference quadruped in Drake, its trunk and its legs, with the drives of "
        f"{machine.model.name}; not a robot of your own."
    )


def model_files(machine: Machine, folder: Path) -> dict[Path, str]:
    """Return the texts of a model (TOML) and its MJCF, by file in `folder`; empty if drives have joints of
    their own, or torques are injected.

    Args:
        machine: of kind ``quadruped``; a leg's recordings are held against the leg's own model.
        folder: where they will lie.
    """
    if not machine.floating or len(machine.rotors.places) or machine.injected is not None:
        return {}
    tree, file = folder / "robot.xml", folder / "robot.toml"
    n = machine.size
    model = Model(
        name="robot",
        serial=tree.resolve(),
        axes=machine.joints,
        joints=machine.joints,
        transmission=np.array(machine.transmission),
        # rotors and damping are in the MJCF already, on joints and tendons
        actuators=Actuators(
            (0.0,) * n, (0.0,) * n, tuple(map(float, machine.torque_limit)), machine.delay_steps * STEP_S
        ),
        controller=Controller(
            "pd", "joint", kp=tuple(map(float, machine.kp)), kd=tuple(map(float, machine.kd)), period_s=STEP_S
        ),
        ground=Ground(tuple(f"{leg}_sphere" for leg in LEGS), surface="ground"),
    )
    return {tree: machine.xml, file: model_text(model, file)}
