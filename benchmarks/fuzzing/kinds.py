"""Every kind of file: how valid ones are made, which are spoilt, who reads them, and what must then hold."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from . import mutate, seeds
from .checks import Wrong, check_bundle, check_design, check_model, check_recording, check_table


@dataclass(frozen=True)
class Kind:
    """One kind of input.

    Attributes:
        make: writes valid files into an empty folder.
        spoil: file in that folder -> style: ``toml``, ``json``, ``xml``, ``text``, ``bytes``, ``table``.
        read: reads them as commands do.
        check: raises `Wrong` where what was read is not valid.
        weight: share of the cases.
    """

    make: Callable[[Path], object]
    spoil: Mapping[str, str]
    read: Callable[[Path, mutate.Random], Any]
    check: Callable[[Any], None] = lambda result: None
    weight: float = 1.0


def _recording(folder: Path, random: mutate.Random) -> Any:
    from workbench.recordings import load_recording

    return load_recording(folder / "run.toml")


def _inspected(folder: Path, random: mutate.Random) -> Any:
    """Read, and now and then looked at, as it would be next."""
    from workbench.inspection import inspect

    recording = _recording(folder, random)
    if random.random() < 0.03:
        inspect([recording])
    return recording


def _imported(file: str, folder: Path, random: mutate.Random) -> Any:
    from workbench.proposing import Answers, complete, open_table, propose

    table = open_table(folder / file)
    if random.random() < 0.1:
        proposal = propose(table, Answers())
        if not proposal.questions:
            check_recording(complete(proposal, table, Answers())[1])
    return table


def _model(file: str, folder: Path, random: mutate.Random) -> Any:
    from workbench.effects import compile_plant, load_model

    model = load_model(folder / file)
    return model, compile_plant(model)


def _contents(file: str, folder: Path, random: mutate.Random) -> Any:
    from workbench.importing import contents_of

    return contents_of(folder / file)


def _chain(folder: Path, random: mutate.Random) -> Any:
    from workbench.core import Mechanism
    from workbench.mechanism import ClosedChain

    pairs, limits = (("coupler_end", "rear_arm_end"),), ((-1.6, 1.6), (0.35, 2.6))
    mechanism = Mechanism(
        folder / "leg.sdf", ("hip", "crank_pin"), ("hip", "knee"), pairs, "foot", limits=limits
    )
    return ClosedChain(mechanism).serial_dynamics(np.array([0.2, 1.2]), np.zeros(2))


def _config(folder: Path, random: mutate.Random) -> Any:
    from workbench.can import bus_load, load_config

    config = load_config(folder / "robot.toml")
    bus_load(config)
    return config


def _played(folder: Path, random: mutate.Random) -> Any:
    from workbench.can import load_config
    from workbench.deployment.record import from_log
    from workbench.frf import load_design

    config = load_config(folder / "robot.toml")
    return from_log(config, load_design(folder / "design.toml"), 0, folder / "sum.log")


def _design(folder: Path, random: mutate.Random) -> Any:
    from workbench.frf import load_design

    return load_design(folder / "design.toml")


def _bundle(folder: Path, random: mutate.Random) -> Any:
    from workbench.bundle import Policy, read_bundle
    from workbench.training.of_bundle import machine_of

    read = read_bundle(folder / "reach.zip")
    actions = Policy(read)(np.zeros((1, sum(o.size for o in read.observations))))
    if actions.shape != (1, len(read.control.joints)):
        raise Wrong(f"actions of shape {actions.shape}")
    if random.random() < 0.3:
        (folder / "unpacked").mkdir()
        machine_of(read, folder / "unpacked")
    return read


def repacked(folder: Path, random: mutate.Random) -> None:
    """One part of a bundle spoilt and its hash made right again: what a bungling exporter would write."""
    import hashlib
    import zipfile

    path = folder / "reach.zip"
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    name = str(mutate.pick(random, ["bundle.json"] * 4 + list(parts)))
    style = {"json": "json", "toml": "toml", "xml": "xml"}.get(name.rpartition(".")[2], "bytes")
    parts[name] = STYLES[style](random, parts[name])
    if name != "bundle.json":
        manifest = json.loads(parts["bundle.json"])
        manifest["sha256"][name] = hashlib.sha256(parts[name]).hexdigest()
        parts["bundle.json"] = json.dumps(manifest).encode()
    if random.random() < 0.1:
        parts[str(mutate.pick(random, ("../out.txt", "/tmp/out.txt", "model/../../x", "a/" * 50 + "b")))] = (
            b"x"
        )
    with zipfile.ZipFile(path, "w") as archive:
        for each, data in parts.items():
            archive.writestr(each, data)


def _exported(folder: Path, random: mutate.Random) -> Any:
    from workbench.training.curve import read_curve
    from workbench.training.export import export

    read_curve(folder / "run")
    return export(folder / "run", folder / "new.zip")


def _record(folder: Path, random: mutate.Random) -> Any:
    from workbench.effects import load_model
    from workbench.training.record import objections, read_record, summary

    record = read_record(folder / "leg.record.json")
    return record and (objections(record, load_model("leg"), "exact"), summary(record))


#: Style of a file -> ways to spoil it; bytes and text are spoilt in any of them.
STYLES: dict[str, Callable[[mutate.Random, bytes], bytes]] = {
    "toml": mutate.toml,
    "json": mutate.json_,
    "xml": mutate.xml,
    "text": mutate.text,
    "bytes": mutate.bytes_,
}


def _table_kind(*files: str) -> dict[str, Kind]:
    return {
        f"recording {file.partition('.')[2]}": Kind(
            partial(seeds.recording, file=file), {file: "table"}, _inspected, check_recording
        )
        for file in files
    }


def _write(folder: Path, file: str) -> None:
    seeds.write_table(folder / file, seeds.table())


def _log_kinds() -> dict[str, Kind]:
    return {
        f"CAN log {e}": Kind(
            partial(seeds.can_log, ending=e),
            {f"run{e}": "text" if e in (".log", ".asc") else "bytes", "run.dbc": "text"},
            _recording, check_recording, 0.05 if e == ".mf4" else 0.5,  # that starts a process each
        )
        for e in (".log", ".blf", ".asc", ".mf4")
    }  # fmt: skip


KINDS: dict[str, Kind] = {
    "recording TOML": Kind(seeds.recording, {"run.toml": "toml"}, _inspected, check_recording, 3.0),
    **_table_kind("run.csv", "run.csv.gz", "run.parquet", "run.mat"),
    **{
        f"import {file}": Kind(
            partial(_write, file=file), {file: "table"}, partial(_imported, file), check_table, 0.5
        )
        for file in ("a.csv", "a.txt", "a.tsv", "a.parquet", "a.mat", "a.npz", "a.npy", "a.json", "a.jsonl")
    },
    "model TOML": Kind(seeds.model, {"leg.toml": "toml"}, partial(_model, "leg.toml"), check_model, 3.0),
    "MJCF": Kind(seeds.model, {"leg.xml": "xml"}, partial(_model, "leg.toml"), check_model, 1.5),
    "SDF": Kind(seeds.model, {"leg.sdf": "xml"}, partial(_contents, "leg.sdf"), weight=0.5),
    "SDF chain": Kind(seeds.model, {"leg.sdf": "xml"}, _chain, weight=0.3),
    "URDF": Kind(seeds.urdf, {"leg.urdf": "xml"}, partial(_contents, "leg.urdf"), weight=0.5),
    "CAN configuration": Kind(seeds.can_config, {"robot.toml": "toml"}, _config, weight=1.5),
    **_log_kinds(),
    "CAN run": Kind(seeds.played, {"sum.log": "text", "sum.begun": "text"}, _played, check_recording, 0.4),
    "MCAP ROS 2": Kind(seeds.mcap, {"ros.mcap": "bytes"}, partial(_imported, "ros.mcap"), check_table, 0.5),
    "MCAP JSON": Kind(seeds.mcap, {"json.mcap": "bytes"}, partial(_imported, "json.mcap"), check_table, 0.5),
    "ROS 2 bag": Kind(
        seeds.bag, {"bag/metadata.yaml": "text", "bag/bag.db3": "bytes"}, partial(_imported, "bag"),
        check_table, 0.3,
    ),
    "LeRobot": Kind(
        seeds.lerobot,
        {"set/meta/info.json": "json", "set/data/chunk-000/episode_000000.parquet": "bytes"},
        partial(_imported, "set"), check_table, 0.5,
    ),
    "excitation": Kind(seeds.design, {"design.toml": "toml", "sum.csv.gz": "bytes"}, _design, check_design),
    "bundle": Kind(seeds.run, {"reach.zip": "bundle"}, _bundle, check_bundle, 1.0),
    "record": Kind(seeds.run, {"leg.record.json": "json"}, _record),
    "checkpoint": Kind(
        seeds.run, {"run/checkpoint.pt": "bytes", "run/config.json": "json"}, _exported, weight=0.5
    ),
}  # fmt: skip
