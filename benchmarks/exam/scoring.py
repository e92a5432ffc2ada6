"""What an answer is worth, against what was hidden."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from math import inf, pi, remainder, sqrt
from typing import NamedTuple

from workbench.core import EffectKey

from .answers import Answer, Named

#: From best to worst. `extra`: all that was hidden, and something that was not. `part`: only some of it, and
#: nothing else. `disagreeing` and `refused`: said of recordings that do not go together.
OUTCOMES = (
    "right", "look-alike", "disagreeing", "refused", "part", "consistent", "unexplained", "extra", "wrong"
)  # fmt: skip

#: A model is as good as the true one on data that judge if its error is at most this times the true one's.
AS_GOOD = 1.05

#: Names that catalogues and textbooks list as hard or impossible to tell apart, either way round.
ALIKE: frozenset[frozenset[str]] = frozenset(
    frozenset(pair)
    for pair in (
        ("reflected_inertia", "linkage_inertia"),
        ("reflected_inertia", "link_inertia_error"),
        ("reflected_inertia", "payload_mass"),
        ("linkage_inertia", "payload_mass"),
        ("linkage_inertia", "link_length_error"),
        ("linkage_gravity", "link_length_error"),
        ("linkage_gravity", "payload_mass"),
        ("payload_mass", "link_length_error"),
        ("parallel_spring", "linkage_gravity"),
        ("parallel_spring", "torque_bias"),
        ("linkage_gravity", "torque_bias"),
        ("linkage_gravity", "cogging"),
        ("torque_constant_error", "reflected_inertia"),
        ("torque_constant_error", "thermal_derating"),
        ("torque_constant_error", "controller_gain_error"),
        ("viscous_damping", "quadratic_drag"),
        ("command_delay", "sensor_delay"),
        ("command_delay", "current_loop_lag"),
        ("sensor_delay", "velocity_filter_lag"),
        ("presliding_hysteresis", "coulomb_friction"),
        ("presliding_hysteresis", "backlash"),
        ("presliding_hysteresis", "joint_compliance"),
        ("joint_compliance", "backlash"),
        ("joint_compliance", "reflected_inertia"),
        ("joint_compliance", "base_compliance"),
        ("encoder_eccentricity", "encoder_offset"),
        ("encoder_eccentricity", "encoder_scale"),
        ("torque_saturation", "speed_torque_limit"),
        ("stribeck_friction", "coulomb_friction"),
        ("load_dependent_friction", "coulomb_friction"),
        ("asymmetric_friction", "coulomb_friction"),
    )
)
#: An effect that is the sum of others: naming only these instead is a look-alike where they do as well.
SUMS: Mapping[str, frozenset[str]] = {
    "asymmetric_friction": frozenset({"coulomb_friction", "torque_bias", "viscous_damping"}),
    "link_length_error": frozenset({"linkage_inertia", "linkage_gravity"}),
    "payload_mass": frozenset({"linkage_inertia", "linkage_gravity"}),
    "linkage_inertia": frozenset({"reflected_inertia"}),
}


def canonical(key: EffectKey) -> EffectKey:
    """The key with the hip joint as the hip's drive: the same pin."""
    return EffectKey(key.effect, key.axis) if key.axis == "hip" else key


class Match(NamedTuple):
    """What a named effect is, ``right``, ``look-alike`` or ``false``, and for which hidden one it stands."""

    how: str = "false"
    of: EffectKey | None = None


def matches(truth: Collection[EffectKey], answer: Answer, floor: float | None) -> list[Match]:
    """What each named effect is, best first as the answer has them.

    A look-alike names the truth beside it, and is a real one: listed as such, or as good as the truth on the
    data that judge. Of each thing hidden one name counts, or the several that sum up to it.

    Args:
        truth: what was hidden.
        answer: what was named.
        floor: error of the true model on the data that judge, None if not known.
    """
    left = {canonical(key) for key in truth}
    found = [Match()] * len(answer.named)
    for i, named in enumerate(answer.named):
        key = canonical(named.key)
        if key in left:
            found[i] = Match("right", key)
            left.discard(key)
    level = as_good(answer.error_after, floor)
    for i, named in enumerate(answer.named):
        real = [key for key in sorted(left, key=str) if _beside(named, key, level)]
        if real and found[i].how == "false":
            found[i] = Match("look-alike", real[0])
            left.discard(real[0])
    for key in (key for key in left if level and key.effect in SUMS):
        for i, named in enumerate(answer.named):
            if found[i].how == "false" and _is_part(named.key, key):
                found[i] = Match("look-alike", key)
    return found


def _beside(named: Named, truth: EffectKey, level: bool) -> bool:
    listed = truth in {canonical(key) for key in named.also}
    return listed and (level or frozenset({named.key.effect, truth.effect}) in ALIKE)


def _is_part(named: EffectKey, truth: EffectKey) -> bool:
    return named.effect in SUMS[truth.effect] and (
        named.axis == truth.axis or None in (named.axis, truth.axis)
    )


def as_good(error: float | None, floor: float | None) -> bool:
    """Whether an error is that of the true model."""
    return error is not None and floor is not None and error <= AS_GOOD * floor


def outcome(
    truth: Collection[EffectKey],
    answer: Answer,
    found: Sequence[Match],
    asked: Collection[EffectKey] | None = None,
) -> str:
    """One of `OUTCOMES`; `found` as `matches` gives it, `asked` what has to be named (all, if not said)."""
    if not answer.named:
        return answer.verdict
    missing = {canonical(key) for key in (truth if asked is None else asked)} - {m.of for m in found}
    if any(match.how == "false" for match in found):
        return "wrong" if missing or not truth else "extra"
    if missing:
        return "part"
    return "look-alike" if any(match.how == "look-alike" for match in found) else "right"


def good(kind: str, result: str, visible: bool) -> bool:
    """Whether an outcome is what an honest and able judge would have said.

    Of several hidden effects all that are visible beside the others have to be named. What is not visible may
    be called consistent. Nothing may be named where nothing of the catalogue is hidden.
    """
    if kind == "clean":
        return result == "consistent"
    if kind == "outsider":
        return result == "unexplained" or (result == "consistent" and not visible)
    return result in ("right", "look-alike") or (result == "consistent" and not visible)


def removed(before: float | None, after: float | None, floor: float | None) -> float | None:
    """Share of the removable error that is gone, (before - after) / (before - floor); None where none is."""
    if before is None or after is None or floor is None or not before > 1.02 * floor:
        return None
    return (before - after) / (before - floor)


def covered(name: str, truth: float, value: float, std: float) -> bool | None:
    """Whether a 95 % interval holds the truth; angles modulo a turn; None where there is no interval."""
    if not 0.0 < std < inf:
        return None
    apart = remainder(value - truth, 2 * pi) if name == "phase" else value - truth
    return abs(apart) <= 1.96 * std


def wilson(good_ones: int, of: int) -> tuple[float, float]:
    """95 % interval of a share (E. B. Wilson, J. Am. Stat. Assoc. 22, 1927)."""
    if not of:
        return 0.0, 1.0
    z, share = 1.959964, good_ones / of
    centre, scale = share + z * z / (2 * of), 1 + z * z / of
    half = z * sqrt(share * (1 - share) / of + z * z / (4 * of * of))
    return max(0.0, (centre - half) / scale), min(1.0, (centre + half) / scale)
