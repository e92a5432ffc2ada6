"""An excitation, what a training run leaves, and what a loop that played one leaves."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from .machines import can_config
from .tables import AXES


def design(folder: Path) -> None:
    """A multisine for two axes."""
    from workbench.frf import Design, save_design
    from workbench.frf.excitation import Trial

    t = np.arange(200) * 0.001
    signals = np.stack(
        [np.column_stack([np.sin(2 * np.pi * 5 * t), s * np.sin(2 * np.pi * 5 * t)]) for s in (1, -1)]
    )
    trials = Trial("sum", "sum"), Trial("difference", "difference")
    made = Design(
        "d", "multisine", AXES, "torque_feedforward", 1000.0, signals, np.array([1]), trials, periods=1
    )
    save_design(made, folder / "design.toml")


def run(folder: Path) -> None:
    """The folder of a training run, its bundle, and a verification record, without having trained."""
    import torch

    from workbench.effects import load_model
    from workbench.training.checkpoint import save
    from workbench.training.export import export
    from workbench.training.folder import CHECKPOINT, CONFIG, MJCF, MODEL, copy_model
    from workbench.training.machine import make_machine
    from workbench.training.settings import Settings, resolved
    from workbench.training.tasks import TASKS

    leg = load_model("leg")
    machine = make_machine("leg", leg, "s3n_full")
    config = resolved(TASKS["reach"], machine, Settings(), {"processes": 1, "record": None, "unverified": []})
    size = sum(entry["size"] for entry in config["observations"])
    torch.manual_seed(0)
    shapes = ((8, size), (8,)), ((2, 8), (2,))
    state = {"obs_normalizer._mean": torch.zeros(1, size), "obs_normalizer._std": torch.ones(1, size)}
    for i, (weight, bias) in zip((0, 2), shapes, strict=True):
        state |= {f"mlp.{i}.weight": 0.1 * torch.randn(weight), f"mlp.{i}.bias": torch.zeros(bias)}
    own = folder / "run"
    (own / MODEL).mkdir(parents=True)
    (own / CONFIG).write_text(json.dumps(config))
    (own / MJCF).write_text(machine.xml)
    copy_model(machine.model, own / MODEL)
    save(own / CHECKPOINT, {"iteration": 2, "seconds": 1.0, "learner": {"actor_state_dict": state}})
    export(own, folder / "reach.zip")
    record = {
        "format": 1, "model": "leg", "variant": "exact", "files": leg.digests(),
        "checks": [{"name": "mass matrix", "passed": True}], "passed": True,
        "recordings": [{"name": "run", "error": 0.1, "noise_error": 0.1, "sha256": None}],
        "error": 0.1, "noise_error": 0.1, "consistent": True, "versions": {},
    }  # fmt: skip
    (folder / "leg.record.json").write_text(json.dumps(record))


def played(folder: Path) -> None:
    """A log that a loop left behind, with the note of when it began, its configuration and its design."""
    can_config(folder)
    design(folder)
    from workbench.can import Feedback, load_config, make_drive
    from workbench.can.candump import line
    from workbench.can.messages import Setpoint, burst
    from workbench.deployment import joints_of
    from workbench.deployment.player import Player
    from workbench.frf import load_design

    config = load_config(folder / "robot.toml")
    joints, (kp, kd) = joints_of(config), (np.array(gains) for gains in config.gains())
    player = Player(load_design(folder / "design.toml"), 0, 0.003)
    lines, torque = [], np.zeros(len(config.motor))
    for k in range(120):
        seen = np.zeros((2, len(config.motor)))
        for i, motor in enumerate(config.motor):
            drive, stamp = make_drive(motor), 1e9 + 0.003 * k + 3e-4 * i
            asked = burst(drive.command(Setpoint(0.0, 0.0, 0.0, 0.0, torque[i])))
            lines += [line(stamp, "can0", frame) for frame in asked]
            q = float(player.reference[0, i]) + 0.02 * float(np.sin(0.05 * k + i))
            answer = drive.answer(Feedback(q, 0.0, 0.0, 30.0, True))
            lines.append(line(stamp + 2e-4, "can0", answer))
            said = drive.decode(answer)
            assert isinstance(said, Feedback)
            seen[:, i] = said.position, said.velocity
        # the loop's own law, on what was heard: it goes out with the next tick
        row = max(k - 1, 0)
        position, velocity = (joints.position(x) for x in seen)
        asked = joints.torque(
            kp * (joints.within(player.reference[row]) - position) - kd * velocity, position
        )
        torque = asked + player.feedforward[row] * (k > 0)
    (folder / "sum.log").write_text("".join(lines))
    (folder / "sum.begun").write_text(f"{1e9 + 0.003:.6f}\n")
