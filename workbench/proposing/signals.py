"""Which column is which signal of which joint."""

from __future__ import annotations

import numpy as np

from .assignment import Signals, filled, moves
from .column_context import held, without_joint
from .gains import GAINS
from .match import ALIKE, derivative, follows
from .names import Role
from .references import hold_references, settle_commands, speeds_that_are_references, unnamed_references
from .roles import pairs
from .table import Table
from .torques import settle_torques, take_drives
from .unnamed_columns import by_column_order


def read_signals(table: Table, roles: dict[str, Role], time: str | None) -> Signals:
    """Assign columns by their names, and by their numbers where names leave it open."""
    out = Signals()
    full = {n: v for n, v in table.columns.items() if n != time and np.isfinite(v).sum() > 8}
    moving = {n for n, v in full.items() if moves(v)}
    kept = moving | held(full.keys() - moving, moving, roles)
    data = {n: v for n, v in full.items() if n in kept or _may_hold(roles[n])}
    _by_name(out, data, roles)
    hold_references(out, data)
    if "position" not in out.columns:
        _by_role(out, data, roles)
    data = {n: v for n, v in data.items() if n in kept}
    if "position" not in out.columns:
        _by_derivative(out, data, roles)
    _of_joints(out)
    speeds_that_are_references(out, data)
    settle_commands(out, data)
    take_drives(out, data, roles)
    settle_torques(out, data)
    if "position_reference" not in out.columns:
        unnamed_references(out, data, roles)
    return out


def _may_hold(role: Role) -> bool:
    """Whether a column that never changes may be a gain, or the reference of an axis that is held."""
    return role.kind in GAINS or (role.role == "reference" and role.kind in ("position", ""))


def _of_joints(out: Signals) -> None:
    """Positions of joints alone, not those of a tool."""
    positions = out.columns.get("position", {})
    others = {j for s, by_joint in out.columns.items() if s != "position" for j in by_joint}
    tools = without_joint(list(positions), others)
    if tools:
        out.notes.append(f"Not taken as axes, because only their positions are logged: {', '.join(tools)}.")
    for joint in tools:
        del positions[joint]


def _by_role(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Positions and references of which the names say no more than that they are measured and asked for."""
    whole = {n: filled(v) for n, v in data.items() if n not in out.used()}
    for joint, (seen, asked) in pairs(whole, roles).items():
        out.put("position", joint, seen, f"its name; it follows '{asked}'", 0.95)
        if "position_reference" not in out.columns or joint not in out.columns["position_reference"]:
            out.put("position_reference", joint, asked, f"its name; '{seen}' follows it", 0.95)


def _by_name(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    for name in data:
        signal = _signal(roles[name])
        if not signal:
            continue
        joint = roles[name].joint
        if joint in out.columns.get(signal, {}):
            _second(out, data, signal, joint, name)
        else:
            out.put(signal, joint, name, "its name", 0.97)


def _signal(role: Role) -> str:
    """The signal that a name means by itself; ``torque`` and ``command`` are settled later."""
    if role.kind == "position":
        return "position_reference" if role.role == "reference" else "position"
    if role.kind == "velocity":
        return "velocity_reference" if role.role == "reference" else "velocity"
    if role.kind == "torque" or (role.kind == "" and role.role == "feedforward"):
        named = {
            "reference": "torque_command",
            "feedforward": "torque_feedforward",
            "measured": "torque_measured",
        }
        return named.get(role.role, "torque")
    if role.kind in GAINS:
        return role.kind
    if role.kind in ("current", "voltage", "temperature"):
        return "" if role.role == "reference" else role.kind
    return "command" if role.kind == "command" else ""


def _second(out: Signals, data: dict[str, np.ndarray], signal: str, joint: str, name: str) -> None:
    """Two columns of one name: of two positions or torques, the one that leads was asked for."""
    first = out.columns[signal][joint]
    asked = {
        "position": "position_reference",
        "torque": "torque_command",
        "torque_measured": "torque_command",
    }
    if signal not in asked or joint in out.columns.get(asked[signal], {}):
        return
    relation = follows(filled(data[first]), filled(data[name]))
    if relation.likeness < ALIKE or relation.lag == 0:
        return
    leader, follower = (first, name) if relation.lag > 0 else (name, first)
    out.columns[signal][joint] = follower
    out.put(asked[signal], joint, leader, f"it leads by {abs(relation.lag)} rows", 0.93)


def _is_counted(name: str, role: Role) -> bool:
    """Whether a column has no name but its number, and no joint but that of such a name."""
    return name.startswith("column_") and role.joint in ("", *role.words, "_".join(role.words))


def _by_derivative(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Positions without a name: columns of which another is the derivative."""
    free = [n for n in data if n not in out.used()]
    velocities = out.columns.get("velocity", {})
    alike: dict[tuple[str, str], float] = {}
    for a in free:
        others = velocities.values() if velocities else (b for b in free if b != a)
        for b in others:
            alike[a, b] = derivative(filled(data[a]), filled(data[b])).likeness
    pairs = [(likeness, a, b) for (a, b), likeness in alike.items() if likeness > 0.97]
    taken: set[str] = set()
    found: dict[str, tuple[str, str]] = {}
    for _, a, b in sorted(pairs, reverse=True):
        if a in taken or b in taken:
            continue
        taken |= {a, b}
        joint = next(
            (j for j, c in velocities.items() if c == b), "" if _is_counted(a, roles[a]) else roles[a].joint
        )
        found[a] = (joint or a, b)
    rank = by_column_order({a: b for a, (_, b) in found.items()}, list(data), alike) if found else {}
    found |= {a: (a, b) for a, b in rank.items()}
    for a in (n for n in data if n in found):  # in the file's order
        joint, b = found[a]
        sure, nearly = (0.91, "nearly ") if a in rank else (0.95, "")
        out.put("position", joint, a, f"'{b}' is {nearly}its derivative", sure)
        if b not in velocities.values():
            out.put("velocity", joint, b, f"it is {nearly}the derivative of '{a}'", sure)
