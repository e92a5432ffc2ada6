"""Meaning of the name of a column: quantity, unit, joint, and whether it is measured or commanded."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from .units import fits, known_unit, spelled

#: Words for each quantity, as controllers, simulators and people write them.
KINDS: dict[str, tuple[str, ...]] = {
    "acceleration": ("acc", "accel", "acceleration", "ddq", "qdd", "qddot", "qacc", "alpha"),
    "velocity": (
        *("velocity", "velocities", "vel", "speed", "dq", "qd", "qdot", "qvel", "omega", "w", "v", "vm"),
        *("thetadot", "dtheta", "thdot", "dth", "phidot", "dphi", "rpm", "om", "rate", "spd", "drehzahl"),
    ),
    "torque": (
        *("torque", "torques", "tau", "tq", "trq", "moment", "mom", "effort", "efforts", "eff", "force"),
        *("frc", "actuatorforce", "qfrc", "load", "drehmoment"),
    ),
    "position": (
        *("position", "positions", "pos", "q", "qpos", "qm", "angle", "angles", "ang", "theta", "th", "phi"),
        *("enc", "encoder", "state", "winkel", "motorposition", "linkposition"),
    ),
    "current": ("current", "currents", "curr", "cur", "amps", "iq", "i", "strom"),
    "voltage": ("voltage", "volt", "volts", "u"),
    "temperature": ("temperature", "temp", "temps", "celsius"),
    "time": (
        *("time", "t", "timestamp", "stamp", "clock", "zeit", "epoch", "datetime", "timestep", "tid"),
        *("sec", "secs", "seconds", "millis", "micros", "ms", "us", "ns", "date", "ts"),
        *("nanosec", "nanosecs", "nanoseconds", "nsec", "nsecs", "usec", "usecs", "msec", "msecs"),
    ),
    "kp": ("kp", "stiffness"),
    "kd": ("kd", "damping"),
    "valid": ("valid", "ok"),
    "index": ("index", "idx", "sample", "samples", "frame", "row", "step", "n", "count", "counter", "nr"),
}
ROLES: dict[str, tuple[str, ...]] = {
    "feedforward": ("ff", "feedforward", "injected", "excitation"),
    "reference": (
        *("ref", "reference", "des", "desired", "set", "setpoint", "sp", "target", "goal", "demand", "soll"),
        *("cmd", "command", "commands", "commanded", "action", "actions", "ctrl", "control", "tgt", "rq"),
        "dem",
    ),
    "measured": (
        *("meas", "measured", "mes", "act", "actual", "fb", "feedback", "msr", "ist", "real", "observation"),
        *("obs", "present", "sensed", "sensor", "est", "estimated", "states", "measurement", "measurements"),
    ),
}
#: Words for what is asked of a drive, whatever it is.
COMMANDS = frozenset({"cmd", "command", "commands", "commanded", "action", "actions", "ctrl", "control"})
_NOISE = (
    *("joint", "joints", "jnt", "axis", "axes", "ax", "motor", "motors"),
    *("main", "data", "robot", "feedback"),
)
_KIND = {word: kind for kind, words in KINDS.items() for word in words}
_ROLE = {word: role for role, words in ROLES.items() for word in words}
_BRACKET = re.compile(r"\s*[\[\(<{]\s*([^\]\)>}]*)\s*[\]\)>}]\s*$")
#: Units that say by themselves what a column is, as they end names.
_TELLING = ("deg", "rad", "nm", "mnm", "ncm", "dps", "rps", "rpm", "deg/s", "rad/s", "mm/s", "m/s")
_STATE = "state"
_INPUT = "input"  # of a drive; an encoder on the input side of a gear measures a position
_SHORT = ("w", "v", "i", "u", "n", "t", "a", "om", "q", "x")


@dataclass(frozen=True)
class Role:
    """Meaning of one name.

    Attributes:
        kind: a key of `KINDS`, ``command`` where only that is said, or ``""``.
        role: ``measured``, ``reference``, ``feedforward`` or ``""`` where the name does not say.
        joint: what is left of the name, ``""`` where nothing is.
        unit: the unit in the name, or ``""``.
        words: every word of the name.
    """

    kind: str
    role: str = ""
    joint: str = ""
    unit: str = ""
    words: tuple[str, ...] = ()


@lru_cache(maxsize=4096)
def role_of(name: str, unit: str = "") -> Role:
    """Return the meaning of the name of one column; a unit stated elsewhere may be given."""
    text = name
    bracket = _BRACKET.search(name)
    if bracket and not bracket[1].strip().isdigit() and (bracket[1] == "" or known_unit(bracket[1])):
        text, unit = name[: bracket.start()], unit or bracket[1].strip()
    words = _words(text)
    kind, role, rest = "", "", list(words)
    only_command = False
    for word in words:
        if word in _ROLE and (not role or role == "measured"):
            role = _ROLE[word]
            only_command = word in COMMANDS
            rest.remove(word)
        elif word in _ROLE:
            rest.remove(word)
    # long words outweigh single letters: "v" in "motor_v_position" names a motor
    # and the end of a path outweighs its beginning: "q" in "arm/state.q" is what a topic's message calls it
    tail = _words(re.split(r"[/.:]", text.rstrip("/.:"))[-1])
    for word in sorted(
        (w for w in rest if w in _KIND),
        # "state" is a position where nothing else is said: "motor_state_0_q", "motor_state_0_tau_est"
        key=lambda w: (w not in tail, w == _STATE, w in _SHORT, rest.index(w)),
    ):
        kind = _KIND[word]
        rest = [w for w in rest if w not in (word, _STATE)]
        if not unit and spelled(word, kind):  # "rpm" says both
            unit = word
        break
    unit, rest = _unit_at_end(rest, kind, unit, words)
    if not kind and unit:
        kind = _kind_of_unit(unit)
    if kind == "torque" and not role and _INPUT in rest:
        role, rest = "reference", [w for w in rest if w != _INPUT]
    if not kind and only_command:
        kind = "command"
    joint = "_".join(rest)
    return Role(kind, role, joint, unit, tuple(words))


def _words(text: str) -> list[str]:
    """Lower-case words: split at marks, at capitals and between letters and digits; known pairs apart."""
    text = text.replace("τ", " tau ").replace("θ", " theta ").replace("ω", " omega ").replace("φ", " phi ")
    text = text.replace("°", " deg ")
    text = re.sub(r"([a-z])([A-Z])", r"\1 \2", text)
    out: list[str] = []
    for part in re.split(r"[^A-Za-z0-9]+", text):
        for word in re.findall(r"[A-Za-z]+|\d+", part):
            out += _split(word.lower())
    return out


def _split(word: str) -> list[str]:
    if word in _KIND or word in _ROLE or len(word) < 3:
        return [word]
    for i in range(len(word) - 1, 0, -1):
        head, tail = word[:i], word[i:]
        if (head in _KIND and tail in _ROLE) or (head in _ROLE and tail in _KIND and len(tail) > 1):
            return [head, tail]
    return [word]


def _unit_at_end(rest: list[str], kind: str, unit: str, words: Sequence[str]) -> tuple[str, list[str]]:
    """A unit written as the last words of a name, as in ``speed_deg_s``, and the words without it.

    In the name they stand side by side: ``m_soll_s`` is no speed in m/s.
    """
    if unit:
        tail = _words(unit)
        if rest[-len(tail) :] == tail:
            rest = rest[: -len(tail)]
        return unit, rest
    if len(rest) > 1 and rest[-1].isdigit():  # "torque_Nm_1"
        unit, body = _unit_at_end(rest[:-1], kind, unit, words)
        return unit, [*body, rest[-1]]
    for count in (3, 2, 1):
        tail = rest[-count:]
        if len(tail) < count or (count == 1 and len(tail[0]) == 1 and kind != "time"):
            continue
        if not any(list(words[i : i + count]) == tail for i in range(len(words))):
            continue
        for text in ("/".join(tail), "".join(tail), " ".join(tail)):
            if spelled(text, kind) if kind else text in _TELLING:
                return text, rest[:-count]
    return "", rest


def _kind_of_unit(unit: str) -> str:
    # torque before position: nobody logs nanometres
    for kind in ("time", "velocity", "torque", "position", "current", "voltage", "temperature"):
        if fits(unit, kind):
            return kind
    return ""


def name_joints(roles: Sequence[Role]) -> list[Role]:
    """Return short joint names, without words that all columns of a kind share, or that mean nothing."""
    out = list(roles)
    groups: dict[tuple[str, str], list[int]] = {}
    for i, role in enumerate(roles):
        groups.setdefault((role.kind, role.role), []).append(i)
    for members in groups.values():
        split = [roles[i].joint.split("_") for i in members]
        shared = set.intersection(*map(set, split)) if len(members) > 1 else set()
        own = [[w for w in words if w and w not in shared and w not in _NOISE] for words in split]
        for i, words, named in zip(members, split, own, strict=True):
            # among joints with names, one is called "motor"
            rest = named or [w for w in words if w and w not in shared and any(own)]
            out[i] = replace(roles[i], joint="_".join(rest))
    return out
