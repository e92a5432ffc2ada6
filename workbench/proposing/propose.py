"""From a file's columns to a recording's description, with what was assumed and what has to be asked."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from workbench.core import AXIS_SIGNALS, InputError

from .axes import named_axes
from .clean import Clean, clean
from .clock import find_time, rate_question, time_weights
from .match import Relation, derivative
from .names import Role, name_joints, role_of
from .proposal import ASK, Answers, Assumption, Proposal, Question
from .scales import Told, weigh
from .signals import Signals, read_signals
from .table import Table
from .units import by_size, is_linear, pint_unit, scale

_POSITION_KINDS = ("position", "position_reference", "link_position")
_FALLBACK_RATE = 100.0  # rows a second, for looking at the rest while the question is open


def propose(table: Table, answers: Answers | None = None) -> Proposal:
    """What the table seems to hold.

    Args:
        table: the columns.
        answers: what the user says already.

    Returns:
        A description with the likeliest reading; nothing that is a question has been settled in silence.

    Raises:
        InputError: no position is among the columns, or an answer names what is not there.
    """
    answers = answers or Answers()
    _check_answers(table, answers)
    return _Draft(table, answers).proposal()


def _check_answers(table: Table, answers: Answers) -> None:
    for signal, names in answers.columns.items():
        if signal not in (*AXIS_SIGNALS, "time", "valid"):
            known = ", ".join(("time", *AXIS_SIGNALS))
            raise InputError(f"there is no signal '{signal}'", file=table.file, remedy=f"one of {known}")
        for name in names:
            if name not in table.columns:
                shown = ", ".join(list(table.columns)[:20])
                raise InputError(
                    "there is no such column", file=table.file, column=name, remedy=f"it has: {shown}"
                )
    for kind, unit in answers.units.items():
        if not pint_unit(unit, kind):
            raise InputError(
                f"'{unit}' is no unit of {kind}", file=table.file, remedy=f"e.g. --unit {kind}=..."
            )


class _Draft:
    """One proposal in the making."""

    def __init__(self, table: Table, answers: Answers) -> None:
        self.table, self.answers = table, answers
        self.assumed: list[Assumption] = []
        self.questions: list[Question] = []
        self.notes: list[str] = list(table.notes)
        names = list(table.columns)
        self.roles: dict[str, Role] = dict(
            zip(names, name_joints([role_of(n, table.units.get(n, "")) for n in names]), strict=True)
        )

    def proposal(self) -> Proposal:
        time = self._time()
        signals = read_signals(self.table, self.roles, time)
        self._stated_columns(signals)
        axes, columns = named_axes(signals, self.answers, self.table, self)
        rows = self._rows(time, columns)
        period_raw = float(np.median(np.diff(rows.columns[time or "t"])))
        relations = self._derivatives(rows, columns)
        columns = self._uncross(rows, columns, axes, relations)
        if "velocity" in columns:
            relations = [derivative(*self._pair(rows, columns, i)) for i in range(len(axes))]
        units = self._units(rows, columns, time, period_raw, relations)
        scales = self._signs(columns, axes, relations, units)
        description = self._description(axes, columns, units, scales, rows, time)
        unused = [n for n in self.table.columns if n not in self._named(columns) and n != time]
        if unused:
            shown = ", ".join(unused[:8]) + (f" and {len(unused) - 8} more" if len(unused) > 8 else "")
            self.notes.append(f"Not used: {shown}.")
        rewritten = not self.table.plain or rows.changed or time is None
        data = dict(rows.columns) if rewritten else None
        if data is not None:
            if rows.valid is not None:
                data["valid"] = rows.valid.astype(float)
            data, description["columns"] = _writable(data, description["columns"])
        return Proposal(description, data, tuple(self.assumed), tuple(self.questions), tuple(self.notes))

    # -- columns

    def _time(self) -> str | None:
        time, because, sure = find_time(self.table, self.roles, self.answers)
        if time is not None:
            self.assume("time", time, sure, because)
        elif self.answers.rate_hz is None:
            self.questions.append(rate_question())
        else:
            guessed = "rate" in self.answers.guessed
            because = "velocity over slope of position" if guessed else "you said so"
            self.assume("time", f"{self.answers.rate_hz:g} rows a second", 0.8 if guessed else 1.0, because)
        return time

    def _stated_columns(self, signals: Signals) -> None:
        for signal, names in self.answers.columns.items():
            if signal in AXIS_SIGNALS:
                before = signals.columns.get("position", {})
                joints = (
                    list(before) if len(before) == len(names) else [self.roles[n].joint or n for n in names]
                )
                for other in signals.columns.values():
                    for joint in [j for j, c in other.items() if c in names]:
                        del other[joint]
                signals.columns[signal] = dict(zip(joints, names, strict=True))
                signals.sure[signal], signals.because[signal] = 1.0, "you said so"
        signals.columns = {s: c for s, c in signals.columns.items() if c}

    def _rows(self, time: str | None, columns: dict[str, list[str]]) -> Clean:
        used = list(dict.fromkeys(n for names in columns.values() for n in names if n != time))
        data = dict(self.table.columns)
        if time is None:
            data["t"] = np.arange(len(self.table)) / (self.answers.rate_hz or _FALLBACK_RATE)
        dead = [n for n in used if not np.isfinite(data[n]).any()]
        for name in dead:
            raise InputError("has no numbers", file=self.table.file, column=name, remedy="leave it out")
        rows = clean(data, time or "t", used)
        if len(next(iter(rows.columns.values()))) < 8:
            remedy = "record more, or mend the time column"
            raise InputError("has fewer than eight usable rows", file=self.table.file, remedy=remedy)
        self.notes += rows.notes
        return rows

    def _pair(self, rows: Clean, columns: dict[str, list[str]], i: int, j: int | None = None) -> tuple:
        """Position of axis i and velocity of axis j, empty cells bridged."""
        q = _bridged(rows.columns[columns["position"][i]])
        return q, _bridged(rows.columns[columns["velocity"][i if j is None else j]])

    def _derivatives(self, rows: Clean, columns: dict[str, list[str]]) -> list[Relation]:
        if "velocity" not in columns:
            return []
        return [derivative(*self._pair(rows, columns, i)) for i in range(len(columns["position"]))]

    def _uncross(
        self, rows: Clean, columns: dict[str, list[str]], axes: Sequence[str], straight: list[Relation]
    ) -> dict[str, list[str]]:
        """Velocities that belong to another joint's position, put where they belong or asked about."""
        if len(axes) < 2 or "velocity" in self.answers.columns or not straight:
            return columns
        n = len(axes)
        likeness = np.array(
            [[derivative(*self._pair(rows, columns, i, j)).likeness for j in range(n)] for i in range(n)]
        )
        best = likeness.argmax(axis=1)
        bad = [i for i in range(n) if best[i] != i and likeness[i, best[i]] > 0.95 and likeness[i, i] < 0.8]
        if len(bad) < 2 or sorted(best[bad]) != bad:
            return columns
        order = list(range(n))
        for i in bad:
            order[i] = int(best[i])
        pair = " and ".join(f"'{axes[i]}'" for i in bad)
        moved = [columns["velocity"][k] for k in order]
        if self._reference_agrees(rows, columns, bad):
            self.notes.append(
                f"The velocity columns of {pair} are swapped: exchanged, they are the derivatives."
            )
            self.assume("swap", f"velocity of {pair}", 0.97, "positions follow their own references")
            return {**columns, "velocity": moved}
        crossed = ",".join(moved)
        self.questions.append(
            Question(
                "column.velocity",
                f"Columns of {pair} are swapped: each velocity is the derivative of the other position. "
                "Which are wrong?",
                (crossed, ",".join(columns["velocity"])),
                "",
                f"--column velocity={crossed} if the velocities are, else --column position="
                + ",".join(columns["position"][order.index(k)] for k in range(n)),
            )
        )
        return {**columns, "velocity": moved}

    def _reference_agrees(self, rows: Clean, columns: dict[str, list[str]], bad: list[int]) -> bool:
        if "position_reference" not in columns:
            return False
        alike = [
            np.corrcoef(
                _bridged(rows.columns[columns["position"][i]]),
                _bridged(rows.columns[columns["position_reference"][i]]),
            )[0, 1]
            for i in bad
        ]
        return bool(min(alike) > 0.8)

    # -- units

    def _units(
        self,
        rows: Clean,
        columns: dict[str, list[str]],
        time: str | None,
        step: float,
        relations: list[Relation],
    ) -> dict[str, str]:
        by_time: dict[str, float] = {"s": 1.0}
        why_time = "you said so"
        if time is not None:
            by_time, why_time = time_weights(self.table.columns[time], self.roles[time], self.answers)
        by_position, why_position = self._weights("position", rows, columns["position"])
        by_velocity, why_velocity = {}, ""
        if "velocity" in columns:
            by_velocity, why_velocity = self._weights("velocity", rows, columns["velocity"])
        good = [r for r in relations if r.likeness > 0.9]
        # per row to per unit of time
        factor = float(np.median([abs(r.factor) for r in good])) * step if good else None
        told = weigh(by_time, by_position, by_velocity, factor)
        for kind in ("time", "position"):
            if kind not in told:  # no unit makes such numbers likely
                raise InputError(
                    f"the unit of {kind} cannot be told from such numbers", file=self.table.file,
                    remedy=f"say it: --unit {kind}=UNIT",
                )  # fmt: skip
        if factor and "velocity" in told and told["position"].unit != "counts":
            expected = scale(told["position"].unit, "position") / (
                scale(told["time"].unit, "time") * scale(told["velocity"].unit, "velocity")
            )
            if abs(factor / expected - 1) < 0.1:
                tie = "velocity over slope of position"
                why_position, why_velocity = _and(why_position, tie), _and(why_velocity, tie)
                why_time = _and(why_time, tie)
            elif time is None and self.answers.rate_hz is None:
                self._rate(expected / factor)
            else:
                ratio = factor / expected
                self.notes.append(
                    f"Velocity is {ratio:.4g} times the derivative of position in these units: "
                    "a gear ratio, or a wrong unit?"
                )
        units = {}
        if time is not None:
            units["time"] = self._settle("time", told["time"], why_time)
        units["position"] = self._settle("position", told["position"], why_position)
        if "velocity" in told:
            units["velocity"] = self._settle("velocity", told["velocity"], why_velocity)
        torques = [n for s, names in columns.items() if s.startswith("torque") for n in names]
        if torques:
            weights, why = self._weights(
                "torque", rows, torques, linear=is_linear(_or_rad(units["position"]), "position")
            )
            best = max(weights, key=lambda u: weights[u])
            units["torque"] = self._settle("torque", Told(best, weights[best] / sum(weights.values())), why)
        for kind in ("current", "voltage", "temperature"):
            if kind in columns:
                hint = pint_unit(self.roles[columns[kind][0]].unit, kind)
                units[kind] = hint or {"current": "A", "voltage": "V", "temperature": "degC"}[kind]
        return units

    def _weights(
        self, kind: str, rows: Clean, names: list[str], linear: bool | None = None
    ) -> tuple[dict[str, float], str]:
        stated = self.answers.units.get(kind)
        if stated:
            return {pint_unit(stated, kind): 1.0}, "you said so"
        if kind == "position" and self.answers.counts:
            return {"turn": 1.0}, "you said so"
        hints = {pint_unit(self.roles[n].unit, kind) for n in names if self.roles[n].unit} - {""}
        by = by_size(kind, np.column_stack([rows.columns[n] for n in names]))
        if linear is None:
            linear = bool(self.answers.linear) and all(self.answers.linear)
        if linear:
            by = {
                "position": {"m": 1.0, "mm": 0.03},
                "velocity": {"m/s": 1.0, "mm/s": 0.03},
                "torque": {"N": 1.0},
            }[kind]
        by = {u: w for u, w in by.items() if w > 0}
        if len(hints) == 1:
            hint = hints.pop()
            return {**{u: 1e-4 * w for u, w in by.items()}, hint: 1.0}, "its name says so"
        top = float(np.nanmax(np.abs(np.column_stack([rows.columns[n] for n in names]))))
        return by, f"numbers up to {top:.3g}"

    def _settle(self, kind: str, told: Told, because: str) -> str:
        """Note a unit; where it is not sure, ask."""
        name = f"unit of {kind}"
        if kind in self.answers.units:
            self.assume(name, told.unit, 1.0, "you said so")
            return told.unit
        if told.unit == "counts":
            text = "Positions are whole numbers, encoder counts it seems. How many make a turn?"
            self.questions.append(Question("counts", text, (), "", "--counts N (or --unit position=UNIT)"))
            return "turn"
        self.assume(name, told.unit, told.sure, because)
        if told.sure < ASK:
            choices = {
                "time": ("s", "ms", "us", "ns"),
                "position": ("rad", "deg"),
                "velocity": ("rad/s", "deg/s", "rpm"),
            }
            options = choices.get(kind, ("N*m", "mN*m", "N*mm"))
            text = f"What is the unit of {kind}: {' or '.join(options)} ({because})?"
            self.questions.append(
                Question(f"unit.{kind}", text, options, told.unit, f"--unit {kind}={told.unit}")
            )
        return told.unit

    def _rate(self, period: float) -> None:
        """The rate that makes velocity the derivative of position, offered as an answer."""
        rate = _FALLBACK_RATE / period if period > 0 else 0.0
        self.questions = [q for q in self.questions if q.key != "rate"]
        text = f"No column is time; velocity against position says {rate:.4g} rows a second. Is that so?"
        self.questions.append(Question("rate", text, (), f"{rate:.4g}", f"--rate {rate:.4g}"))

    def _signs(
        self,
        columns: dict[str, list[str]],
        axes: Sequence[str],
        relations: list[Relation],
        units: dict[str, str],
    ) -> dict[str, list[float]]:
        """Factors on columns: velocities counted the other way, counts per turn."""
        scales: dict[str, list[float]] = {}
        if self.answers.counts:
            scales = {s: [1.0 / self.answers.counts] * len(axes) for s in _POSITION_KINDS if s in columns}
        backward = [i for i, r in enumerate(relations) if r.likeness > 0.9 and r.factor < 0]
        if backward:
            scales["velocity"] = [-1.0 if i in backward else 1.0 for i in range(len(axes))]
            which = ", ".join(axes[i] for i in backward)
            self.assume("sign of velocity", f"reversed: {which}", 0.95, "it falls where position rises")
            self.notes.append(
                f"Velocity of {which} has the sign against position; it is turned. Is the encoder?"
            )
        return scales

    # -- the end

    def _description(
        self,
        axes: Sequence[str],
        columns: dict[str, list[str]],
        units: dict[str, str],
        scales: dict[str, list[float]],
        rows: Clean,
        time: str | None,
    ) -> dict[str, Any]:
        out: dict[str, Any] = {"time": time or "t"}
        for signal in AXIS_SIGNALS:
            if signal in columns:
                factors = scales.get(signal, [1.0] * len(axes))
                out[signal] = [
                    name if f == 1.0 else {"column": name, "scale": f}
                    for name, f in zip(columns[signal], factors, strict=True)
                ]
        if rows.valid is not None:
            out["valid"] = "valid"
        coordinates = self.answers.coordinates or "joint"
        if self.answers.transmission is not None and not self.answers.coordinates:
            coordinates = "actuator"
            text = "The model's drives do not turn as its joints do. Where were the signals counted?"
            options = ("actuator", "joint")
            self.questions.append(
                Question("coordinates", text, options, "actuator", "--coordinates actuator")
            )
            self.assume("coordinates", "actuator", 0.7, "drives carry the encoders as a rule")
        return {
            "format": 1,
            "rig": "",
            "coordinates": coordinates,
            "axes": list(axes),
            "columns": out,
            "units": {k: u for k, u in units.items() if u},
        }

    def _named(self, columns: dict[str, list[str]]) -> set[str]:
        return {n for names in columns.values() for n in names}

    def assume(self, what: str, value: str, sure: float, because: str) -> None:
        """Note an assumption."""
        self.assumed.append(Assumption(what, value, sure, because))


def _writable(
    data: dict[str, np.ndarray], columns: dict[str, Any]
) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Names without the marks that separate cells, in the data and where they are named."""
    new = {name: " ".join(re.sub(r'[,;"\t\r\n]', " ", name).split()) for name in data}
    if len(set(new.values())) < len(new):
        new = {name: f"column_{k}" for k, name in enumerate(data)}

    def renamed(value: Any) -> Any:
        if isinstance(value, list):
            return [renamed(v) for v in value]
        if isinstance(value, dict):
            return {**value, "column": new[value["column"]]}
        return new[value]

    return {new[n]: v for n, v in data.items()}, {signal: renamed(value) for signal, value in columns.items()}


def _bridged(values: np.ndarray) -> np.ndarray:
    good = np.isfinite(values)
    if good.all():
        return values
    at = np.arange(len(values))
    return np.interp(at, at[good], values[good]) if good.any() else np.zeros(len(values))


def _and(first: str, second: str) -> str:
    return second if first.startswith("numbers") or first == "rows a second" else f"{first}; {second}"


def _or_rad(unit: str) -> str:
    return unit or "rad"
