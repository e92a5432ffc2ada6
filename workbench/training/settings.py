"""Settings of a training run, and what is written before it starts."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from math import acos
from typing import Any

from workbench.core.provenance import versions

from .environment import STEEPEST
from .machine import POLICY_STEPS, STEP_S, Machine
from .randomisation import LEG_RANDOMISATION, Randomisation
from .situation import POLICY_S
from .task import Task

_PACKAGES = "mujoco", "mujoco-warp", "numpy", "rsl-rl-lib", "torch", "warp-lang", "workbench"


@dataclass(frozen=True)
class Learning:
    """Settings of PPO (rsl_rl); the defaults are common for legged robots.

    Attributes:
        rollout: policy steps of each world per iteration.
        epochs, batches: passes over them, and mini-batches a pass.
        clip, gamma, lam, value_weight, entropy, gradient_norm: as in rsl_rl's PPO.
        rate: learning rate at the start; adapted to hold the KL divergence at `kl`.
        std: deviation of actions at the start.
    """

    rollout: int = 24
    epochs: int = 5
    batches: int = 4
    clip: float = 0.2
    gamma: float = 0.99
    lam: float = 0.95
    value_weight: float = 1.0
    entropy: float = 0.005
    gradient_norm: float = 1.0
    rate: float = 1e-3
    kl: float = 0.01
    std: float = 0.6


@dataclass(frozen=True)
class Settings:
    """A run: task, number of worlds, length, seed, folder.

    Attributes:
        worlds: simulated side by side, a process.
        iterations: of PPO in all, those before a resumption counted in.
        save_every: iterations from checkpoint to checkpoint.
        threads: of the simulation on the CPU; 0 takes all cores.
    """

    worlds: int = 256
    iterations: int = 200
    seed: int = 0
    device: str = "cpu"
    save_every: int = 50
    threads: int = 0
    learning: Learning = field(default_factory=Learning)
    randomisation: Randomisation = field(default_factory=Randomisation)


def resolved(task: Task, machine: Machine, settings: Settings, extra: Mapping[str, Any]) -> dict[str, Any]:
    """Return everything on which a run depends, as JSON: settings, tables, machine, versions, hashes."""
    return {
        "format": 1,
        "task": task.name,
        "variant": machine.variant,
        "settings": asdict(settings),
        "leg_randomisation": asdict(links)
        if (links := LEG_RANDOMISATION[settings.randomisation.legs])
        else None,
        "observations": layout(task, machine),
        "rewards": [{"name": r.name, "weight": r.weight, "about": r.about} for r in task.rewards],
        "hidden": list(task.hidden),
        "control": control_table(task, machine),
        "model": {
            "name": machine.model.name,
            "effects": [str(e.key) for e in machine.model.effects],
            "left_out": list(machine.left_out),
            "mjcf_sha256": machine.digest,
            "files": machine.model.digests(),
        },
        "versions": library_versions(),
        **extra,
    }


def layout(task: Task, machine: Machine) -> list[dict[str, Any]]:
    """Return the input of the policy, entry by entry, with place and scale."""
    from .probe import sizes

    entries, start = [], 0
    for entry, size in zip(task.observations, sizes(task, machine), strict=True):
        entries.append(
            {
                "name": entry.name, "start": start, "size": size, "scale": entry.scale,
                "noise": entry.noise, "about": entry.about,
            }
        )  # fmt: skip
        start += size
    return entries


def control_table(task: Task, machine: Machine) -> dict[str, Any]:
    """Return joints, gains, rates, limits and transmission: the meaning of the actions of a policy."""
    return {
        "joints": list(machine.joints),
        "transmission": machine.transmission.tolist(),
        "drive_map": None if machine.map is None else machine.map.table(),
        "posture": machine.posture.tolist(),
        "action_scale": task.action_scale,
        "kp": machine.kp.tolist(),
        "kd": machine.kd.tolist(),
        "torque_limit": machine.torque_limit.tolist(),
        "joint_limits": machine.limits.tolist(),
        "control_period_s": STEP_S,
        "policy_period_s": POLICY_S,
        "control_steps_a_policy_step": POLICY_STEPS,
        "delay_steps": machine.delay_steps,
        "tilt_limit": acos(STEEPEST) if machine.floating else None,
        "command_range": [list(each) for each in task.commands] if task.commands else None,
    }


def library_versions() -> dict[str, str]:
    """Return the versions of Python, the platform, and all installed packages on which a result depends."""
    return {"platform": sys.platform, **versions(_PACKAGES)}
