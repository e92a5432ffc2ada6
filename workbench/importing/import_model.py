"""From a mechanism with loops to a model file and its serial tree."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from workbench.core import Controller, EffectKey, Estimate, InputError, Mechanism
from workbench.core.files import check_free, write_all
from workbench.mechanism import ClosedChain, constant_transmission, held_rest
from workbench.models import Actuators, AppliedEffect, Model, model_text
from workbench.s3n import reach
from workbench.s3n.posture import MOST_DRIVES

from .linkage import is_all, parallelogram_linkage
from .opened import opened
from .serial_tree import serial_mjcf

_AROUND = 0.5  # rad or m: of joints without limits, to both sides of the start posture
_STRAYED = 0.2  # rad or m between a start posture and that which was assembled


@dataclass(frozen=True)
class Drives:
    """The motors, one value per drive.

    Attributes:
        gear: ratio N from rotor to output.
        rotor_inertia: J_m at the rotor [kg m^2]; N^2 J_m counts at the output (paper, Eq. 7).
        rotor_damping: B_m at the rotor [N m s/rad].
        torque_limit: at the output [N m].
        delay_s: from command to torque [s].
        friction: dry, at the output [N m]; empty for none.
    """

    gear: tuple[float, ...]
    rotor_inertia: tuple[float, ...]
    rotor_damping: tuple[float, ...]
    torque_limit: tuple[float, ...]
    delay_s: float = 0.0
    friction: tuple[float, ...] = ()

    @property
    def at_output(self) -> Actuators:
        """What a model holds."""
        square = np.square(self.gear)
        return Actuators(
            tuple(map(float, square * self.rotor_inertia)),
            tuple(map(float, square * self.rotor_damping)),
            self.torque_limit,
            self.delay_s,
        )


def import_model(
    mechanism: Mechanism,
    drives: Drives,
    output: str | Path,
    *,
    axes: Sequence[str] | None = None,
    controller: Controller | None = None,
    hold_rest: bool = False,
    kept: Sequence[str] = (),
    tell: Callable[[str], object] = lambda line: None,
    tell_start: Callable[[str], object] = lambda line: None,
    force: bool = False,
) -> Model:
    """Write ``output`` (TOML) and the serial tree beside it (MJCF), from a mechanism with loops.

    The transmission is found from the loops and its constancy tested; where the mechanism is a
    parallelogram, so are the linkage's inertia and weight. The model is as normalised as it can be.

    Args:
        mechanism: file, drives, serial joints, loops, foot.
        drives: the motors.
        output: the model file; ``leg.toml`` comes with ``leg.xml``, and of an MJCF with ``leg.sdf``, in which
            its loops are cut open.
        axes: names of the axes; the drives' joints if not given.
        controller: the loop that it usually runs in, if that is known.
        hold_rest: hold every joint that neither drives nor loops move.
        kept: serial joints whose limits are kept; where the transmission changes with the posture, those of
            the others are narrowed to what is reached, free of dead points.
        tell: is told limits that are not the file's, and why.
        tell_start: is told where the loops close near the start posture that `mechanism` asks for.
        force: overwrite.

    Raises:
        InputError: the file cannot be read, its loops do not close or leave other freedoms than the
            drives, the serial joints are not the way to the foot, or an output exists.
        SimulationError: no posture within the limits can be reached.
    """
    target = Path(output)
    if target.suffix != ".toml":
        raise InputError("the model file has to end in .toml", file=target, remedy="e.g. -o leg.toml")
    tree = target.with_suffix(".xml")
    for file in (target, tree):
        _check_written(file, mechanism.file, force)
    names = tuple(axes) if axes else mechanism.drives
    if len(names) != len(mechanism.drives) or len(set(names)) != len(names):
        raise InputError(
            f"{len(names)} axis names for {len(mechanism.drives)} drives", remedy="name each axis once"
        )
    with opened(mechanism.file) as (source, converted):
        cut, kept_file, texts = replace(mechanism, file=source), mechanism.file, dict[Path, str]()
        if converted is not None:
            cut = replace(
                cut,
                loops=(*converted.loops, *mechanism.loops),
                couplings=(*converted.couplings, *mechanism.couplings),
            )
            cut = replace(cut, rest=tuple(converted.start.items()))
            kept_file = target.with_suffix(converted.suffix)
            _check_written(kept_file, mechanism.file, force)
            texts[kept_file] = converted.text
        if hold_rest:
            first = (*converted.motors, *converted.springs) if converted else ()
            cut = replace(cut, couplings=(*cut.couplings, *held_rest(cut, first)))
        cut, chain = _begun(cut)
        if mechanism.start:
            tell_start(_nearest(chain, dict(mechanism.start)))
        transmission = constant_transmission(chain)
        mjcf = serial_mjcf(cut, target.stem)
        model = Model(
            name=target.stem,
            serial=tree.resolve(),
            axes=names,
            joints=cut.joints,
            transmission=transmission.matrix,
            actuators=drives.at_output,
            closed_chain=replace(cut, file=kept_file.resolve()),
            posture_dependent=not transmission.constant,
            payload_site=cut.foot,
            controller=controller or Controller(),
            effects=_dry(names, drives),
        )
        with TemporaryDirectory() as folder:
            (Path(folder) / tree.name).write_text(mjcf)
            whole = replace(model, serial=Path(folder) / tree.name)
            linkage = parallelogram_linkage(chain, whole)
            # what hangs on the loops may turn otherwise in each posture, though the drives do not
            if transmission.constant and linkage is None and not is_all(chain, whole):
                model, whole = (replace(each, posture_dependent=True) for each in (model, whole))
            if model.posture_dependent:
                limits = _reached(replace(whole, closed_chain=cut), chain, kept, tell)
                narrowed = replace(cut, limits=limits)
                if narrowed != cut:  # a start posture outside the limits is none
                    narrowed, chain = _begun(narrowed)
                    matrix = chain.jacobian(chain.start[1])
                    written = replace(narrowed, file=kept_file.resolve())
                    model = replace(model, transmission=matrix, closed_chain=written)
                    mjcf = serial_mjcf(narrowed, target.stem)
    if linkage is not None:
        model = replace(model, linkage=linkage)
    write_all({tree: mjcf, target: model_text(model, target), **texts}, force=force)
    return model


def _dry(axes: Sequence[str], drives: Drives) -> tuple[AppliedEffect, ...]:
    """Dry friction of the drives as effects of a model."""
    return tuple(
        AppliedEffect(EffectKey("coulomb_friction", axis), {"torque": Estimate(value, 0.0, "N*m")})
        for axis, value in zip(axes, drives.friction, strict=bool(drives.friction))
        if value
    )


def _reached(
    model: Model, chain: ClosedChain, kept: Sequence[str], tell: Callable[[str], object]
) -> tuple[tuple[float, float], ...]:
    """Limits of the serial joints in which the mechanism can be used, else its own."""
    own = chain.mechanism.limits
    start = chain.start[1] if not own else np.zeros(0)
    limits = own or tuple((round(float(x) - _AROUND, 3), round(float(x) + _AROUND, 3)) for x in start)
    try:
        found = reach(replace(model, closed_chain=replace(chain.mechanism, limits=limits)), kept)
    except InputError:
        return own  # check says what is wrong with them
    if not own and model.size > MOST_DRIVES:
        return own
    limits = tuple((float(low), float(high)) for low, high in found.box)
    if not own or found.left_out:
        pairs = zip(model.joints, limits, strict=True)
        said = ", ".join(f"{name} {low:.4g} to {high:.4g}" for name, (low, high) in pairs)
        left = f"left out of the file's: {'; '.join(found.left_out)}"
        tell(f"{said}; {left if own else 'the file states none, these are about the start posture'}")
    return limits


def _begun(mechanism: Mechanism) -> tuple[Mechanism, ClosedChain]:
    """The mechanism, started where it is assembled if that is far from the stated posture; and its chain.

    Whoever closes the loops next begins there, and finds the same way to put it together. What a model's file
    says is of the posture that it says, digit by digit.
    """
    chain = ClosedChain(mechanism)
    stated = {**dict(mechanism.rest), **dict(mechanism.start)}
    mechanism = replace(mechanism, start=tuple(stated.items()), rest=())
    found = chain.tree_position(chain.start[0])
    named = dict(zip(chain.coordinates, map(float, found), strict=True))
    if all(abs(value - stated.get(name, 0.0)) < _STRAYED for name, value in named.items()):
        return mechanism, chain if mechanism == chain.mechanism else ClosedChain(mechanism)
    begun = replace(mechanism, start=tuple((name, round(value, 6)) for name, value in named.items()))
    return begun, ClosedChain(begun)


def _nearest(chain: ClosedChain, asked: Mapping[str, float]) -> str:
    """One line that compares a posture that somebody asked for with the closed one that was found."""
    theta = dict(zip(chain.coordinates, chain.assembled, strict=True))
    wanted, has = (", ".join(f"{k} = {of[k]:.3g}" for k in asked) for of in (asked, theta))
    if all(abs(theta[name] - value) < _STRAYED for name, value in asked.items()):
        return f"as asked, the loops are closed near {wanted}: at {has}"
    return f"no closed posture is near {wanted}; the nearest has {has}"


def _check_written(file: Path, source: Path, force: bool) -> None:
    """Refuse to write over what is there, and over the mechanism itself whatever is wanted."""
    if file.resolve() == source.resolve():
        raise InputError("the new file would overwrite it", file=source, remedy="give the model another name")
    check_free(file, force=force)
