"""What a fleet has in common: robots by effect, and where they differ."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import Any

from workbench.core import FORMAT, EffectKey, Estimate, apart

from .spread import Spread, spread


@dataclass(frozen=True)
class Peculiar:
    """A robot that stands out: its name, and by how many standard deviations from the others."""

    robot: str
    deviations: float


@dataclass(frozen=True)
class Shared:
    """One effect across the fleet.

    Attributes:
        key: which, where.
        robots: that have it.
        perhaps: for which it explains as well what another effect was named for.
        unseen: whose recordings could not have shown it.
        parameters: name -> estimate of each robot that has it, by robot.
        spreads: name -> how these differ, where two robots or more have it.
    """

    key: EffectKey
    robots: tuple[str, ...]
    perhaps: tuple[str, ...]
    unseen: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Estimate]]
    spreads: Mapping[str, Spread]

    def peculiar(self, name: str) -> tuple[Peculiar, ...]:
        """Robots whose parameter of this name stands out, those furthest off first."""
        told = self.spreads.get(name)
        if told is None:
            return ()
        estimated = [robot for robot, e in self.parameters[name].items() if e.std > 0]
        pairs = zip(estimated, told.deviations, told.stands_out, strict=True)
        out = [Peculiar(robot, float(z)) for robot, z, apart in pairs if apart]
        return tuple(sorted(out, key=lambda p: -abs(p.deviations)))


@dataclass(frozen=True)
class Fleet:
    """Results of all robots as they were kept, by name, and effects, those of most robots first."""

    robots: tuple[Mapping[str, Any], ...]
    effects: tuple[Shared, ...]

    @property
    def failed(self) -> tuple[Mapping[str, Any], ...]:
        """Robots that have no diagnosis."""
        return tuple(r for r in self.robots if r["failed"] is not None)

    @property
    def diagnosed(self) -> tuple[Mapping[str, Any], ...]:
        """Robots that have one."""
        return tuple(r for r in self.robots if r["failed"] is None)


def summarise(robots: Sequence[Mapping[str, Any]]) -> Fleet:
    """Order the results of robots by effect."""
    done = [r for r in robots if r["failed"] is None]
    found: dict[EffectKey, dict[str, Mapping[str, Estimate]]] = {}
    for robot in done:
        for finding in robot["diagnosis"]["findings"]:
            for key, parameters in apart(finding):
                found.setdefault(key, {})[robot["rig"]] = parameters
    effects = []
    for key, by_robot in found.items():
        names = list(dict.fromkeys(n for f in by_robot.values() for n in f))
        parameters = {
            name: {
                robot: replace(f[name], std=f[name].std if isfinite(f[name].std) else 0.0)
                for robot, f in by_robot.items()
                if name in f and isfinite(f[name].value)
            }
            for name in names
        }
        perhaps = [
            r["rig"]
            for r in done
            if r["rig"] not in by_robot
            and any(
                key == key_of(other)
                for f in r["diagnosis"]["findings"]
                for other in f["indistinguishable_from"]
            )
        ]
        unseen = [
            r["rig"]
            for r in done
            if r["rig"] not in by_robot and any(key == key_of(k) for k in r["diagnosis"]["not_excited"])
        ]
        effects.append(
            Shared(key, tuple(by_robot), tuple(perhaps), tuple(unseen), parameters, _spreads(parameters))
        )
    effects.sort(key=lambda e: (-len(e.robots), str(e.key)))
    return Fleet(tuple(robots), tuple(effects))


def _spreads(parameters: Mapping[str, Mapping[str, Estimate]]) -> dict[str, Spread]:
    out = {}
    for name, by_robot in parameters.items():
        known = [e for e in by_robot.values() if e.std > 0]
        if len(known) > 1 and len({e.unit for e in known}) == 1:
            out[name] = spread([e.value for e in known], [e.std for e in known])
    return out


def key_of(entry: Mapping[str, Any]) -> EffectKey:
    """Effect and place of a finding, as it was kept."""
    return EffectKey(
        entry["effect"], entry["axis"], entry.get("location", "actuator"), site=entry.get("site")
    )


def fleet_dict(fleet: Fleet) -> dict[str, Any]:
    """Return the JSON of ``workbench fleet``."""
    return {
        "format": FORMAT,
        "robots": [_robot(r) for r in fleet.robots],
        "effects": [_effect(e) for e in fleet.effects],
        "failed": [{"rig": r["rig"], "problem": r["failed"]} for r in fleet.failed],
    }


def _robot(r: Mapping[str, Any]) -> dict[str, Any]:
    told, way = r["diagnosis"] or {}, r["improvement"] or {}
    return {
        **{k: r[k] for k in ("rig", "model", "recordings", "held_out", "left_out", "failed", "verdict")},
        **{
            k: way.get(k)
            for k in (
                "error_before",
                "error_after",
                "holdout_error_before",
                "holdout_error_after",
                "noise_error",
            )
        },
        "findings": told.get("findings", []),
        "unexplained": told.get("unexplained"),
        "next_experiment": told.get("next_experiment"),
        "not_excited": told.get("not_excited", []),
        "improved": r["improved"],
        "used": way.get("used"),
        "notes": way.get("notes", []),
    }


def _effect(e: Shared) -> dict[str, Any]:
    parameters = {}
    for name, by_robot in e.parameters.items():
        told = e.spreads.get(name)
        parameters[name] = {
            "unit": next((x.unit for x in by_robot.values()), ""),
            "values": [{"rig": robot, "value": x.value, "std": x.std} for robot, x in by_robot.items()],
            "mean": told.mean if told else None,
            "std": told.std if told else None,
            "between": told.between if told else None,
            "ratio": told.ratio if told else None,
            "p_value": told.p_value if told else None,
            "stands_out": [{"rig": p.robot, "deviations": p.deviations} for p in e.peculiar(name)],
        }
    return {
        "effect": e.key.effect,
        "axis": e.key.axis,
        "location": e.key.location,
        "robots": list(e.robots),
        "perhaps": list(e.perhaps),
        "unseen": list(e.unseen),
        "parameters": parameters,
    }
