"""A link that came out longer or shorter than drawn."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import EffectKey, Estimate
from workbench.models import AppliedEffect, Model

from .base import Effect, Search, SignalStage, Words
from .chain import Build
from .flexible import rotor_name
from .links import link_ends
from .motion import Motion
from .parameter import Parameter, Parameters, Place, Values
from .response import Response
from .structure import crank_of, is_parallelogram
from .weights import add_gravity, add_inertia, masses_at_the_end, weight_at_the_end

_PROBE = 1e-3  # of the link's length: the change behind the column


def _known(values: Values, position_noise: float, torque_noise: float) -> float:
    """A fifteenth: how well a tree knows what hangs on a link's end (see `weights`)."""
    return abs(values["length"]) / 15.0


class LinkLengthError(Effect):
    """The far end of a link, with all that is attached there, is farther out by `length`; no mass changes.

    The link of an axis is the body of its joint; its far end is the next joint, on the last link the payload
    site; a link that carries several others has no such end. In a parallelogram the thigh (hip) takes the
    coupler along, so that opposite sides stay equal and the transmission stays what it is; a longer shank
    (knee) moves the foot alone, which on a fixed base matters only to a payload.
    """

    name = "link_length_error"
    parameters = Parameters(
        Parameter(
            "length", "m", lower=-np.inf, within=lambda model, place: (-0.1, 0.1), blur=_known, example=0.03
        )
    )
    stage = SignalStage.MECHANISM
    words = Words(
        source="geometric calibration; Hollerbach, Khalil, Gautier, Springer Handbook of Robotics, Ch. 6",
        shows="inertia, coupling and gravity of the axis before the link, in the proportions of a "
        "mass at its end",
        reveal="a measured position of the foot; with torques alone, a payload at the foot",
        mujoco="native: position of the body or the site at the link's end",
        needs="a link that ends at one further joint, or at the payload site",
    )
    search = Search(tier=1)

    def applies(self, model: Model, key: EffectKey) -> bool:
        """To links that have an end: a further joint, or the payload site away from their own joint."""
        if key.axis is None:
            return False
        return link_ends(model)[model.axes.index(key.axis)] is not None

    def response(self, motion: Motion, model: Model, place: Place, shape: Values) -> Response:
        """One column: minus what a link that is a little longer needs more, per metre."""
        key = EffectKey(self.name, model.axes[place.index])
        longer = model.with_effect(AppliedEffect(key, {"length": Estimate(_PROBE, 0.0, "m")}))
        more = (motion.required(longer) - motion.required(model)) / _PROBE
        return Response(-(motion.gain * more)[None])

    def install(self, build: Build, model: Model, place: Place, values: Values) -> None:
        """The end of the link, and every body that sits just there."""
        link, end = build.spec.joint(model.joints[place.index]).parent, link_ends(model)[place.index]
        ends: list[mujoco.MjsBody | mujoco.MjsSite | mujoco.MjsGeom]
        if end:
            ends = [build.spec.joint(end).parent]
            crank = build.spec.body(rotor_name(model.joints.index(end), "joint"))
            ends += [crank] if crank else []
        else:
            site = build.spec.site(model.payload_site)
            feet = {build.spec.pair(name).geomname2 for name in build.contacts}
            ends = [site, *(b for b in link.bodies if np.array_equal(b.pos, site.pos))]
            ends += [geom for geom in link.geoms if geom.name in feet]
        way = np.asarray(ends[0].pos, float).copy()
        length = float(np.linalg.norm(way))
        way /= max(length, 1e-12)
        for end in ends:
            end.pos = np.asarray(end.pos, float) + values["length"] * way
        if place.index == 0 and is_parallelogram(model):
            _hang_the_linkage(build.spec, model, length, values["length"])


def _hang_the_linkage(spec: mujoco.MjSpec, model: Model, length: float, more: float) -> None:
    """Let a longer thigh carry out what the linkage weighs, not what stands for it in the tree.

    The bodies that make a tree's inertia and weight those of a linkage have masses that the increments leave
    open. Of the linkage's weight on the thigh, g1, it is known that a mass at its end would have it.
    """
    linkage, gravity = model.linkage, float(np.linalg.norm(spec.option.gravity))
    if linkage is None or linkage.g1 <= 0.0 or gravity == 0.0:
        return
    mass = linkage.g1 / (gravity * length)
    for applied in model.effects:
        if applied.key.effect == "linkage_inertia":
            v = applied.values
            hung = masses_at_the_end(spec, length, v["M11"], v["M12"], v["M22"], crank_of(model))
            beyond = mass - sum(hung)
            add_inertia(spec, model, beyond * ((length + more) ** 2 - length**2), 0.0, 0.0)
        if applied.key.effect == "linkage_gravity":
            beyond = mass * gravity - weight_at_the_end(applied.values["g2"])
            add_gravity(spec, model, beyond * more, 0.0)
