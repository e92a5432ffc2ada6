"""The bundle file: a zip archive whose every part is listed with its hash."""

from __future__ import annotations

import hashlib
import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from workbench.core import DriveMap, InputError
from workbench.core.files import check_format, write_whole

from .archive import read_parts
from .manifest import ManifestTable

FORMAT = 1
MANIFEST, POLICY, MACHINE = "bundle.json", "policy.onnx", "machine.xml"
_DATE = 2000, 1, 1, 0, 0, 0  # one content, one file


@dataclass(frozen=True)
class ObservationEntry:
    """A stretch of the policy's input: ``scale * value`` of the named quantity from `start`, `size` long."""

    name: str
    start: int
    size: int
    scale: float
    about: str


@dataclass(frozen=True)
class Control:
    """What a policy's actions mean; n joints, arrays (n,) unless said otherwise.

    The joints' loop gets ``posture + action_scale * action``; it runs every `control_period_s`, the policy
    every `policy_period_s`, and a torque reaches the drives `delay_steps` control steps after its reading.

    Attributes:
        joints: names of the serial joints.
        transmission: J (n, n), q_p = J q_s; that of one posture where `map` is.
        posture: [rad].
        action_scale: [rad].
        kp, kd: gains in joint coordinates [N m/rad, N m s/rad].
        torque_limit: of the drives [N m].
        joint_limits: (n, 2) [rad].
        velocity_limit: of the drives [rad/s]; None where none is stated.
        tilt_limit: of the base against gravity, at which an episode ended [rad]; None as above.
        command_range: lowest and highest forward, sideward and turning speed that it was asked for (3, 2)
            [m/s, m/s, rad/s]; None as above.
        map: the drives' positions where the transmission changes with the posture; None where it is constant.
    """

    joints: tuple[str, ...]
    transmission: np.ndarray
    posture: np.ndarray
    action_scale: float
    kp: np.ndarray
    kd: np.ndarray
    torque_limit: np.ndarray
    joint_limits: np.ndarray
    control_period_s: float
    policy_period_s: float
    delay_steps: int
    velocity_limit: float | None = None
    tilt_limit: float | None = None
    command_range: np.ndarray | None = None
    map: DriveMap | None = None


@dataclass(frozen=True)
class PolicyBundle:
    """A policy and all that running it needs.

    Attributes:
        task: what it was trained for.
        variant: of S3N that it was trained in.
        observations: the layout of its input.
        control: what its output means.
        policy: the ONNX file's bytes, weights and normalisation in them.
        machine: the MJCF of the machine that it was trained with.
        files: the model's own files, by name.
        manifest: all of `bundle.json`: hashes, settings, versions, verification record.
        source: the file it was read from.
    """

    task: str
    variant: str
    observations: tuple[ObservationEntry, ...]
    control: Control
    policy: bytes
    machine: str
    files: Mapping[str, bytes]
    manifest: Mapping[str, Any]
    source: Path | None = None

    @property
    def verified(self) -> bool:
        """Return whether the model it was trained with had been compared with measurements."""
        return bool(self.manifest.get("record"))


def write_bundle(
    path: str | Path,
    manifest: Mapping[str, Any],
    policy: bytes,
    machine: str,
    files: Mapping[str, bytes],
    *,
    force: bool = False,
) -> Path:
    """Write a bundle, whole or not at all; the same content gives the same file.

    Args:
        path: of the new file, ``.zip``.
        manifest: `task`, `variant`, `observations`, `control` and whatever else is to be known.
        policy: the ONNX file.
        machine: the MJCF text.
        files: further files, by the name that they get in the bundle.

    Raises:
        InputError: the file exists and `force` is not set.
    """
    parts = {POLICY: policy, MACHINE: machine.encode(), **files}
    hashes = {name: hashlib.sha256(data).hexdigest() for name, data in parts.items()}
    text = json.dumps({**manifest, "format": FORMAT, "sha256": hashes}, indent=1) + "\n"
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in {MANIFEST: text.encode(), **parts}.items():
            archive.writestr(zipfile.ZipInfo(name, _DATE), data, zipfile.ZIP_DEFLATED)
    return write_whole(path, stream.getvalue(), force=force)


def read_bundle(path: str | Path) -> PolicyBundle:
    """Read a bundle and hold every part against its hash.

    Raises:
        InputError: not a bundle, of another format, a part that was changed, or a manifest that is not whole.
    """
    file = Path(path)
    parts = read_parts(file)
    try:
        manifest = json.loads(parts.pop(MANIFEST))
    except (KeyError, ValueError, RecursionError) as error:
        raise InputError(
            "not a policy bundle", file=file, remedy="make it with `workbench export`"
        ) from error
    check_format(manifest, FORMAT, file)
    found = manifest.get("format") if isinstance(manifest, dict) else None
    if found != FORMAT:
        raise InputError(f"the bundle has format {found}", file=file, remedy=f"this version reads {FORMAT}")
    wanted = manifest.get("sha256", {})
    wanted = wanted if isinstance(wanted, dict) else {}
    for name in sorted({*wanted, *parts, POLICY, MACHINE}):
        found = hashlib.sha256(parts[name]).hexdigest() if name in parts else None
        if found is None or found != wanted.get(name):
            raise InputError(
                f"'{name}' is missing or was changed", file=file, remedy="export the policy again"
            )
    try:
        table = ManifestTable.model_validate(manifest)
        machine = parts[MACHINE].decode()
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(map(str, first["loc"]))
        problem = (
            f"{MANIFEST} has no '{key}'" if first["type"] == "missing" else f"{MANIFEST}: {first['msg']}"
        )
        raise InputError(problem, file=file, column=key, remedy="export the policy again") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{MACHINE} is not text", file=file, remedy="export the policy again") from error
    return _bundle(table, manifest, parts, machine, file)


def _bundle(
    table: ManifestTable, manifest: dict[str, Any], parts: dict[str, bytes], machine: str, file: Path
) -> PolicyBundle:
    c = table.control
    arrays = ("transmission", "posture", "kp", "kd", "torque_limit", "joint_limits")
    control = Control(
        joints=tuple(c.joints),
        action_scale=c.action_scale,
        control_period_s=c.control_period_s,
        policy_period_s=c.policy_period_s,
        delay_steps=c.delay_steps,
        velocity_limit=c.velocity_limit,
        tilt_limit=c.tilt_limit,
        command_range=None if c.command_range is None else np.array(c.command_range),
        map=None if c.drive_map is None else DriveMap.of(c.drive_map.model_dump()),
        **{name: np.array(getattr(c, name), float) for name in arrays},
    )
    return PolicyBundle(
        task=table.task,
        variant=table.variant,
        observations=tuple(ObservationEntry(**entry.model_dump()) for entry in table.observations),
        control=control,
        policy=parts[POLICY],
        machine=machine,
        files={name: data for name, data in parts.items() if name not in (POLICY, MACHINE)},
        manifest=manifest,
        source=file,
    )
