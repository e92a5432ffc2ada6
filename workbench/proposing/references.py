"""Columns of commands: references and torque commands, found from how positions follow them."""

from __future__ import annotations

import numpy as np

from .assignment import Signals, filled, moves
from .match import ALIKE, derivative, follows
from .names import COMMANDS, Role
from .roles import is_held_reference, is_reference

_BESIDE = 0.5  # of its range, by which a reference may lie beside the positions
_SIZE = 10.0  # times as large as these it may be, or as small


def hold_references(out: Signals, data: dict[str, np.ndarray]) -> None:
    """Accept constant references only where positions are held at them."""
    asked, seen = out.columns.get("position_reference", {}), out.columns.get("position", {})
    if any(moves(data[column]) for column in asked.values()):
        return
    if not all(
        joint in seen and is_held_reference(filled(data[column]), filled(data[seen[joint]]))
        for joint, column in asked.items()
    ):
        out.drop("position_reference")


def speeds_that_are_references(out: Signals, data: dict[str, np.ndarray]) -> None:
    """Decide from the numbers whether ``qd`` is a speed or a desired position."""
    positions, velocities = out.columns.get("position", {}), out.columns.get("velocity", {})
    wrong = []
    for joint, column in velocities.items():
        if joint not in positions or "qd" not in column.lower():
            continue
        q, v = filled(data[positions[joint]]), filled(data[column])
        slope, same = derivative(q, v), follows(q, v)
        if same.likeness > max(ALIKE, slope.likeness) and 0.5 < same.factor < 2.0:
            wrong.append(joint)
    if wrong and len(wrong) >= 0.5 * len(velocities) and "position_reference" not in out.columns:
        for joint in velocities:
            out.put("position_reference", joint, velocities[joint], "it stays close to the position", 0.95)
        out.drop("velocity")


def settle_commands(out: Signals, data: dict[str, np.ndarray]) -> None:
    """Decide what a command is: a position if it runs along it, otherwise a torque."""
    commands = out.columns.pop("command", {})
    positions = out.columns.get("position", {})
    order = list(positions)
    for k, (joint, column) in enumerate(commands.items()):
        own = joint if joint in positions else order[k] if len(order) == len(commands) else None
        if own is None:
            continue
        relation = follows(filled(data[column]), filled(data[positions[own]]))
        if relation.likeness > ALIKE and 0.7 < relation.factor < 1.4 and relation.lag >= 0:
            if own not in out.columns.get("position_reference", {}):
                out.put("position_reference", own, column, "the position follows it", 0.95)
        elif own not in out.columns.get("torque_command", {}):
            out.put("torque_command", own, column, "a command that the position does not follow", 0.91)


def unnamed_references(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Return columns without a meaning that a position follows, one per joint."""
    free = [n for n in data if n not in out.used() and not roles[n].kind]
    by_name = {roles[n].joint: n for n in free if roles[n].role == "reference"}
    positions = out.columns.get("position", {})
    alike = [j for j, n in by_name.items() if j in positions and _follows(data, n, positions[j])]
    if positions and len(alike) == len(positions):
        for joint in alike:
            out.put("position_reference", joint, by_name[joint], "its name; the position follows it", 0.96)
        return
    # beyond what a loop can follow, a position is unlike its reference, and its name is all there is
    if positions and all(j in by_name and _may_lead(out, data, j, by_name[j], roles) for j in positions):
        for joint in positions:
            because = "its name; as large as the position, which hardly follows it"
            out.put("position_reference", joint, by_name[joint], because, 0.93)
        return
    found: dict[str, tuple[float, str]] = {}
    for joint, column in out.columns.get("position", {}).items():
        for name in free:
            relation = follows(filled(data[name]), filled(data[column]))
            if relation.likeness > 0.99 and 0.8 < relation.factor < 1.25 and relation.lag >= 0:
                found[joint] = max(found.get(joint, (0.0, "")), (relation.likeness, name))
    if found and len(found) == len(out.columns["position"]) == len({name for _, name in found.values()}):
        for joint, (_, name) in found.items():
            out.put("position_reference", joint, name, "the position follows it", 0.93)


def _may_lead(
    out: Signals, data: dict[str, np.ndarray], joint: str, name: str, roles: dict[str, Role]
) -> bool:
    """Whether a column that is called a reference is one of position, and not of speed or torque."""
    if set(roles[name].words) & COMMANDS:
        return False
    asked, seen = filled(data[name]), filled(data[out.columns["position"][joint]])
    of_position = follows(asked, seen).likeness
    others = [by[joint] for signal, by in out.columns.items() if signal != "position" and joint in by]
    if any(follows(asked, filled(data[other])).likeness > max(ALIKE, of_position) for other in others):
        return False
    size = max(np.ptp(asked), np.ptp(seen))
    near = abs(float(np.median(asked) - np.median(seen))) < _BESIDE * size
    return near and max(np.ptp(asked), np.ptp(seen)) < _SIZE * min(np.ptp(asked), np.ptp(seen))


def _follows(data: dict[str, np.ndarray], asked: str, seen: str) -> bool:
    return is_reference(filled(data[asked]), filled(data[seen]))
