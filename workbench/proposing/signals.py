"""Which columns are which signal of which joint."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .law import is_law
from .match import derivative, follows, held_share
from .names import Role
from .roles import drives, is_held_reference, is_reference, pairs
from .siblings import held, without_joint
from .table import Table

_ALIKE = 0.9


@dataclass
class Signals:
    """Signal -> joint -> column, and remarks on how it came about.

    Attributes:
        columns: the assignment.
        because: signal -> reason.
        sure: signal -> how sure.
        notes: what does not fit.
    """

    columns: dict[str, dict[str, str]] = field(default_factory=dict)
    because: dict[str, str] = field(default_factory=dict)
    sure: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def put(self, signal: str, joint: str, column: str, because: str, sure: float) -> None:
        """Assign one column; the least sure of a signal counts."""
        self.columns.setdefault(signal, {})[joint] = column
        if sure < self.sure.get(signal, 2.0):
            self.sure[signal], self.because[signal] = sure, because

    def drop(self, signal: str) -> None:
        """Forget a signal."""
        self.columns.pop(signal, None)

    def used(self) -> set[str]:
        """Every column that has a meaning."""
        return {c for by_joint in self.columns.values() for c in by_joint.values()}


def read_signals(table: Table, roles: dict[str, Role], time: str | None) -> Signals:
    """Assign columns by their names, and by their numbers where names leave it open."""
    out = Signals()
    full = {n: v for n, v in table.columns.items() if n != time and np.isfinite(v).sum() > 8}
    moving = {n for n, v in full.items() if _moves(v)}
    kept = moving | held(full.keys() - moving, moving, roles)
    data = {n: v for n, v in full.items() if n in kept or _may_hold(roles[n])}
    _by_name(out, data, roles)
    _held_references(out, data)
    if "position" not in out.columns:
        _by_role(out, data, roles)
    data = {n: v for n, v in data.items() if n in kept}
    if "position" not in out.columns:
        _by_derivative(out, data, roles)
    _of_joints(out)
    _reference_for_velocity(out, data)
    _commands(out, data)
    _drives(out, data, roles)
    _torques(out, data)
    if "position_reference" not in out.columns:
        _unnamed_references(out, data, roles)
    return out


def _moves(values: np.ndarray) -> bool:
    return bool(np.ptp(values[np.isfinite(values)]) > 0)


def _may_hold(role: Role) -> bool:
    """Whether a column that never changes may be the reference of an axis that is held."""
    return role.role == "reference" and role.kind in ("position", "")


def _of_joints(out: Signals) -> None:
    """Positions of joints alone, not those of a tool."""
    positions = out.columns.get("position", {})
    others = {j for s, by_joint in out.columns.items() if s != "position" for j in by_joint}
    tools = without_joint(list(positions), others)
    if tools:
        out.notes.append(f"Not among the axes, nothing but positions of them is logged: {', '.join(tools)}.")
    for joint in tools:
        del positions[joint]


def _held_references(out: Signals, data: dict[str, np.ndarray]) -> None:
    """References of which none moves are some, only where positions are held at them."""
    asked, seen = out.columns.get("position_reference", {}), out.columns.get("position", {})
    if any(_moves(data[column]) for column in asked.values()):
        return
    if not all(
        joint in seen and is_held_reference(_filled(data[column]), _filled(data[seen[joint]]))
        for joint, column in asked.items()
    ):
        out.drop("position_reference")


def _by_role(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Positions and references of which the names say no more than that they are measured and asked for."""
    filled = {n: _filled(v) for n, v in data.items() if n not in out.used()}
    for joint, (seen, asked) in pairs(filled, roles).items():
        out.put("position", joint, seen, f"its name; it follows '{asked}'", 0.95)
        if "position_reference" not in out.columns or joint not in out.columns["position_reference"]:
            out.put("position_reference", joint, asked, f"its name; '{seen}' follows it", 0.95)


def _drives(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """What drives gave or were asked for, where nothing else is a torque."""
    if any(signal.startswith("torque") for signal in out.columns):
        return
    free = [n for n in data if n not in out.used()]
    for signal, joint, column in drives(free, roles, list(out.columns.get("position", {}))):
        if joint not in out.columns.get(signal, {}):
            out.put(signal, joint, column, "a drive's by its name; taken for torque", 0.91)


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
    relation = follows(_filled(data[first]), _filled(data[name]))
    if relation.likeness < _ALIKE or relation.lag == 0:
        return
    leader, follower = (first, name) if relation.lag > 0 else (name, first)
    out.columns[signal][joint] = follower
    out.put(asked[signal], joint, leader, f"it leads by {abs(relation.lag)} rows", 0.93)


def _by_derivative(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Positions without a name: columns of which another is the derivative."""
    free = [n for n in data if n not in out.used()]
    velocities = out.columns.get("velocity", {})
    pairs = []
    for a in free:
        others = velocities.values() if velocities else (b for b in free if b != a)
        for b in others:
            relation = derivative(_filled(data[a]), _filled(data[b]))
            if relation.likeness > 0.97:
                pairs.append((relation.likeness, a, b))
    taken: set[str] = set()
    found: dict[str, tuple[str, str]] = {}
    for _, a, b in sorted(pairs, reverse=True):
        if a in taken or b in taken:
            continue
        taken |= {a, b}
        joint = next(
            (j for j, c in velocities.items() if c == b), "" if a.startswith("column_") else roles[a].joint
        )
        found[a] = (joint or a, b)
    for a in (n for n in data if n in found):  # in the file's order
        joint, b = found[a]
        out.put("position", joint, a, f"'{b}' is its derivative", 0.95)
        if b not in velocities.values():
            out.put("velocity", joint, b, f"it is the derivative of '{a}'", 0.95)


def _reference_for_velocity(out: Signals, data: dict[str, np.ndarray]) -> None:
    """``qd`` is a speed to some and a desired position to others; the numbers tell."""
    positions, velocities = out.columns.get("position", {}), out.columns.get("velocity", {})
    wrong = []
    for joint, column in velocities.items():
        if joint not in positions or "qd" not in column.lower():
            continue
        q, v = _filled(data[positions[joint]]), _filled(data[column])
        slope, same = derivative(q, v), follows(q, v)
        if same.likeness > max(_ALIKE, slope.likeness) and 0.5 < same.factor < 2.0:
            wrong.append(joint)
    if wrong and len(wrong) >= 0.5 * len(velocities) and "position_reference" not in out.columns:
        for joint in velocities:
            out.put("position_reference", joint, velocities[joint], "it runs along the position", 0.95)
        out.drop("velocity")


def _commands(out: Signals, data: dict[str, np.ndarray]) -> None:
    """A command of what? Of position where it runs along it, else of torque."""
    commands = out.columns.pop("command", {})
    positions = out.columns.get("position", {})
    order = list(positions)
    for k, (joint, column) in enumerate(commands.items()):
        own = joint if joint in positions else order[k] if len(order) == len(commands) else None
        if own is None:
            continue
        relation = follows(_filled(data[column]), _filled(data[positions[own]]))
        if relation.likeness > _ALIKE and 0.7 < relation.factor < 1.4 and relation.lag >= 0:
            if own not in out.columns.get("position_reference", {}):
                out.put("position_reference", own, column, "the position follows it", 0.95)
        elif own not in out.columns.get("torque_command", {}):
            out.put("torque_command", own, column, "a command that the position does not follow", 0.91)


def _unnamed_references(out: Signals, data: dict[str, np.ndarray], roles: dict[str, Role]) -> None:
    """Columns without a meaning that a position follows, one a joint."""
    free = [n for n in data if n not in out.used() and not roles[n].kind]
    by_name = {roles[n].joint: n for n in free if roles[n].role == "reference"}
    positions = out.columns.get("position", {})
    alike = [j for j, n in by_name.items() if j in positions and _follows(data, n, positions[j])]
    if positions and len(alike) == len(positions):
        for joint in alike:
            out.put("position_reference", joint, by_name[joint], "its name; the position follows it", 0.96)
        return
    found: dict[str, tuple[float, str]] = {}
    for joint, column in out.columns.get("position", {}).items():
        for name in free:
            relation = follows(_filled(data[name]), _filled(data[column]))
            if relation.likeness > 0.99 and 0.8 < relation.factor < 1.25 and relation.lag >= 0:
                found[joint] = max(found.get(joint, (0.0, "")), (relation.likeness, name))
    if found and len(found) == len(out.columns["position"]) == len({name for _, name in found.values()}):
        for joint, (_, name) in found.items():
            out.put("position_reference", joint, name, "the position follows it", 0.93)


def _follows(data: dict[str, np.ndarray], asked: str, seen: str) -> bool:
    return is_reference(_filled(data[asked]), _filled(data[seen]))


def _torques(out: Signals, data: dict[str, np.ndarray]) -> None:
    """A torque without a role: measured, unless it is the smooth one of two or is held like a command."""
    plain = out.columns.pop("torque", {})
    because, sure = out.because.pop("torque", "its name"), out.sure.pop("torque", 0.97)
    del sure
    # columns of one name are one signal, whatever a joint that hardly moves looks like
    held = bool(plain) and float(np.median([held_share(data[c]) for c in plain.values()])) > 0.4
    commanded = "torque_command" in out.columns
    law = not commanded and bool(plain) and is_law(*_loop(out, data, list(plain.values())))
    for joint, column in plain.items():
        if joint in out.columns.get("torque_measured", {}):
            if joint not in out.columns.get("torque_command", {}):
                out.put("torque_command", joint, column, "the other torque is measured", 0.91)
        elif commanded:
            out.put("torque_measured", joint, column, f"{because}; the other one is the command", 0.96)
        elif law:
            out.put("torque_command", joint, column, "a law of the logged errors and speeds", 0.97)
        elif held:
            out.put("torque_command", joint, column, "held for rows, as a controller's output is", 0.9)
        else:
            out.put("torque_measured", joint, column, "its name; not said whether measured", 0.91)


def _loop(
    out: Signals, data: dict[str, np.ndarray], torques: list[str]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Errors, speeds and torques (N, n) of all joints; no columns where not all are logged."""
    signals = [out.columns.get(s, {}) for s in ("position_reference", "position", "velocity")]
    asked, seen, speeds = ({j: c for j, c in own.items() if c in data} for own in signals)
    joints = [j for j in seen if j in asked and j in speeds] if len(torques) == len(seen) else []
    if len(joints) < len(seen):
        return np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0))
    error = [_filled(data[asked[j]]) - _filled(data[seen[j]]) for j in joints]
    speed = [_filled(data[speeds[j]]) for j in joints]
    torque = [_filled(data[name]) for name in torques]
    return np.stack(error, axis=1), np.stack(speed, axis=1), np.stack(torque, axis=1)


def _filled(values: np.ndarray) -> np.ndarray:
    """The column with empty cells bridged."""
    good = np.isfinite(values)
    if good.all():
        return values
    at = np.arange(len(values))
    return np.interp(at, at[good], values[good])
