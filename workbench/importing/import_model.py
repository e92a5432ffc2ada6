"""From a mechanism with loops to a model file and its serial tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from workbench.core import Controller, InputError, Mechanism
from workbench.core.files import check_free, write_all
from workbench.mechanism import ClosedChain, constant_transmission, held_rest
from workbench.models import Actuators, Model, model_text

from .linkage import is_all, parallelogram_linkage
from .opened import opened
from .serial_tree import serial_mjcf

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
    """

    gear: tuple[float, ...]
    rotor_inertia: tuple[float, ...]
    rotor_damping: tuple[float, ...]
    torque_limit: tuple[float, ...]
    delay_s: float = 0.0

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
        cut, kept, texts = replace(mechanism, file=source), mechanism.file, dict[Path, str]()
        if converted is not None:
            cut = replace(
                cut,
                loops=(*converted.loops, *mechanism.loops),
                couplings=(*converted.couplings, *mechanism.couplings),
            )
            named = {name for name, _ in mechanism.start}
            cut = replace(
                cut, start=(*mechanism.start, *(e for e in converted.start.items() if e[0] not in named))
            )
            kept = target.with_suffix(converted.suffix)
            _check_written(kept, mechanism.file, force)
            texts[kept] = converted.text
        if hold_rest:
            first = (*converted.motors, *converted.springs) if converted else ()
            cut = replace(cut, couplings=(*cut.couplings, *held_rest(cut, first)))
        chain = ClosedChain(cut)
        begun = _begun(cut, chain)
        if begun is not cut:  # what the file will say is of the posture that the file will say
            cut, chain = begun, ClosedChain(begun)
        transmission = constant_transmission(chain)
        mjcf = serial_mjcf(cut, target.stem)
        model = Model(
            name=target.stem,
            serial=tree.resolve(),
            axes=names,
            joints=cut.joints,
            transmission=transmission.matrix,
            actuators=drives.at_output,
            closed_chain=replace(cut, file=kept.resolve()),
            posture_dependent=not transmission.constant,
            payload_site=cut.foot,
            controller=controller or Controller(),
        )
        with TemporaryDirectory() as folder:
            (Path(folder) / tree.name).write_text(mjcf)
            whole = replace(model, serial=Path(folder) / tree.name)
            linkage = parallelogram_linkage(chain, whole)
            lacks = transmission.constant and linkage is None and not is_all(chain, whole)
    if linkage is not None:
        model = replace(model, linkage=linkage)
    if lacks:  # what hangs on the loops turns otherwise in each posture, though the drives do not
        model = replace(model, posture_dependent=True)
    write_all({tree: mjcf, target: model_text(model, target), **texts}, force=force)
    return model


def _begun(mechanism: Mechanism, chain: ClosedChain) -> Mechanism:
    """The mechanism with the posture that it was assembled in as its start, where that is far from the
    stated one.

    Whoever closes the loops next begins there, and finds the same way to put it together.
    """
    stated = dict(mechanism.start)
    found = chain.tree_position(chain.start[0])
    named = dict(zip(chain.coordinates, map(float, found), strict=True))
    if all(abs(value - stated.get(name, 0.0)) < _STRAYED for name, value in named.items()):
        return mechanism
    return replace(mechanism, start=tuple((name, round(value, 6)) for name, value in named.items()))


def _check_written(file: Path, source: Path, force: bool) -> None:
    """Refuse to write over what is there, and over the mechanism itself whatever is wanted."""
    if file.resolve() == source.resolve():
        raise InputError(
            "it would be written over by the model of it", file=source, remedy="give the model another name"
        )
    check_free(file, force=force)
