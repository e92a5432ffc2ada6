"""Residual evidence: lines under a finding, from responses and residuals, independent of the search."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from workbench.core import EffectKey, Shape, Share
from workbench.effects import SignalStage, effect_named, kinds
from workbench.models import AppliedEffect, Model, rotors
from workbench.report.wording import effect_phrase

from ..adequacy.adequacy import Adequacy
from ..checks.torque_log_offset import torque_offset_lines
from ..data import Data
from ..hypothesis import Fit
from ..policy import POLICY
from ..removed_share import HeldOutFall, removes, shown
from ..search_result import AcceptedStep
from .frequency_response import Responses, distortion_lines, resonance_lines, response_lines, responses
from .missing_torque import Missing, missing_torque
from .relations import relation_lines, relations
from .shape import shapes


@dataclass(frozen=True)
class ResidualEvidence:
    """Differences of the training recordings and the runs of a model, computed when first used."""

    data: Data
    fit: Fit

    @property
    def model(self) -> Model:
        """Return the model whose residual is examined."""
        return self.fit.hypothesis.model

    @cached_property
    def responses(self) -> Responses | None:
        """Measured and modelled frequency response, if the recordings give one; None for short windows."""
        if not self.data.replay.machine_alone:
            return None
        count = self.data.training
        return responses(self.data.recordings[:count], self.fit.simulated[:count])

    @cached_property
    def missing(self) -> Missing | None:
        """The residual torque in actuator coordinates; on the ground, it would contain the ground's force."""
        if not self.data.replay.machine_alone:
            return None
        count = self.data.training
        levels = self.data.replay.noise.levels
        return missing_torque(self.model, self.data.recordings[:count], self.fit.simulated[:count], levels)

    @cached_property
    def shapes(self) -> tuple[Shape, ...]:
        """Return the smooth functions that remove much of each axis's residual torque, the best for each
        axis.

        Of one quantity where a second adds nothing.
        """
        if self.missing is None:
            return ()
        best = []
        for axis in self.missing.axes:
            found = [s for s in shapes(self.missing, axis) if s.share >= POLICY.shape_share]
            close = [s for s in found if s.share > found[0].share - POLICY.shape_same]
            best += sorted(close, key=lambda s: (len(s.quantities), -s.share))[:1]
        return tuple(sorted(best, key=lambda s: -s.share))

    @property
    def following_positions(self) -> frozenset[str]:
        """Return the axes whose residual torque is a smooth function of positions alone."""
        return frozenset(
            s.axis for s in self.shapes if s.frequency is None and all("position" in q for q in s.quantities)
        )

    def of_finding(self, key: EffectKey) -> list[str]:
        """Return lines that concern one effect."""
        effect, lines = effect_named(key.effect), []
        if effect.search.frf_signature is not None and self.responses is not None:
            lines += response_lines(self.responses, key)
        if effect.stage in kinds.TORQUES and self.missing is not None:
            missing = self.missing
            if key.location == "joint":
                missing = missing.in_joints(self.model.transmission)
            found = relations(missing, key.axis or _worst(missing))
            if found and found[0].share >= POLICY.relation_beside:
                lines += relation_lines(key.axis or _worst(missing), found)
        return lines

    def of_rest(self, where: Sequence[Share]) -> tuple[str, ...]:
        """Return lines on what no effect explains, on the axis with most of it.

        Args:
            where: shares of the rest, largest first.
        """
        lines = []
        if self.data.replay.machine_alone:
            delay = self.model.actuators.delay_s
            found = [a.key for a in self.fit.hypothesis.added]
            late = [k.axis for k in found if effect_named(k.effect).stage is SignalStage.COMMAND]
            lines += torque_offset_lines(self.data.recordings[: self.data.training], delay, late)
        if self.responses is not None:
            soft = resonance_lines(self.responses, None)
            lines += [*soft, *(_without_rotor(self.model) if soft else ())]
            lines += distortion_lines(self.responses, None)
        if self.missing is not None:
            known = [s.axis for s in where if s.axis in self.missing.axes]
            axis = known[0] if known else _worst(self.missing)
            lines += relation_lines(axis, relations(self.missing, axis))
            lines += [
                f"{s.name} predicts {100 * s.share:.0f} % of the residual torque at {s.axis} on data that "
                "were not fitted: a description, not a cause"
                for s in self.shapes
            ]
        return tuple(lines)


def finding_lines(
    step: AcceptedStep,
    applied: AppliedEffect,
    found: Collection[EffectKey] = (),
    held_out: HeldOutFall | None = None,
) -> tuple[str, ...]:
    """Return lines on what an effect removes, on which data, and on the next best explanation.

    Args:
        step: at which it was accepted.
        applied: the effect.
        found: all effects of the final model, none of which is another explanation.
        held_out: the held-out errors that are told beside it; None where there are none.
    """
    parts = "parts of the recordings, each left out of the fit in turn"
    judges = "held-out recordings" if step.by_holdout else parts
    lines = [] if held_out is None else [held_out.line]
    if held_out is None or not step.by_holdout:
        lines.append(removes(step.removed_share, judges))
    lines.append(_lowers(*step.folds, "held-out recording" if step.by_holdout else "such part"))
    removed = step.removed_share if held_out is None else held_out.share
    known = {applied.key, *step.indistinguishable, *found}
    others = [(k, s) for k, s in step.ranking if k not in known]
    if removed is not None and removed < 0.0 and set(found) - {applied.key}:
        # an effect that others cancel: what it does without them is no reason for it or against it
        lines = ["lowers the error only together with the other effects that were found"]
    elif others:
        key, share = others[0]
        other = effect_phrase(key)
        beside = f"simpler than {other}, which" if share > step.removed_share else f"the next best, {other},"
        theirs, own = shown(share), shown(step.removed_share)
        much = f"{theirs} too" if theirs == own else f"{theirs}; this effect removes {own}"
        lines.append(f"{beside} removes {much} (on {judges}, each signal divided by its noise)")
    effect = effect_named(applied.key.effect)
    words = (s.words(step.fit.hypothesis.model) for s in effect.parameters.settles)
    return (*lines, *filter(None, words), f"typical sign: {effect.words.shows}")


def _lowers(agree: int, of: int, what: str) -> str:
    """Return a clause on how many of the parts that were not fitted an effect makes better."""
    if of == 1:
        return f"{'lowers' if agree else 'does not lower'} the error on the {what}"
    return f"lowers the error on {f'all {of}' if agree == of else f'{agree} of {of}'} {what}s"


def adequacy_lines(key: EffectKey, adequacy: Mapping[EffectKey, Adequacy]) -> list[str]:
    """Lines on why an effect is certain although something else is missing; none if it was not tested."""
    if key not in adequacy:
        return []
    if effect_named(key.effect).stage is SignalStage.COMMAND:
        return ["with this effect, the measured torque follows from the logged command, except for its noise"]
    own, found = " and ".join(kinds.depends_on(effect_named(key.effect)) or ("position",)), adequacy[key]
    share, spread, varies = (100.0 * x for x in (found.share, found.spread, found.variation))
    return [
        f"this law explains {share:.0f} % of what any smooth curve over {own} explains on unseen data",
        f"its value changes by at most {spread:.0f} % if a curve over any other quantity is fitted too, and "
        f"by {varies:.0f} % (rms) along the motion",
    ]


def _worst(missing: Missing) -> str:
    """Return the axis with the largest residual torque."""
    power = (missing.torque**2).sum(axis=0)
    return missing.axes[int(power.argmax())]


def _without_rotor(model: Model) -> list[str]:
    """Return a line on axes without motor inertia, where no spring behind the motor could be tried."""
    inertia = dict(zip(model.axes, rotors(model)[0], strict=True))
    bare = [axis for axis in model.driven if inertia[axis] == 0.0]
    advice = (
        "move the motor's part of the inertia into its joint's armature; then a spring between motor "
        "and link can be tried"
    )
    return [f"the model has no motor inertia at {', '.join(bare)}: {advice}"] if bare else []
