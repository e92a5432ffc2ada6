"""A model of a machine: one frozen value, independent of any simulator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from workbench.core import Carried, Controller, EffectKey, Estimate, InputError, Mechanism
from workbench.core.provenance import digest
from workbench.core.shown import Shown

from .floating import BASE_AXES
from .mjcf import check_mjcf
from .urdf import is_urdf

#: Structural effects that each S3N variant already contains (paper, Sec. III).
VARIANTS: Mapping[str, tuple[str, ...]] = {
    "kin_only": (),
    "s3n_act": ("actuator_inertia_coupling",),
    "s3n_full": ("actuator_inertia_coupling", "linkage_inertia"),
    "exact": ("actuator_inertia_coupling", "linkage_inertia", "linkage_gravity"),
}


@dataclass(frozen=True)
class Actuators:
    """Drives, one entry per axis: inertia and damping at the output (paper, Eq. 7), limits, delay.

    `inertia` [kg m^2 or kg], `damping` [N m s/rad or N s/m], `torque_limit` [N m or N, inf: none],
    `delay_s` the delay from command to torque [s]. `full_braking` says what a limit that falls with speed
    does to a torque against the motion: it leaves it (a motor's back voltage then helps) or takes as much.
    """

    inertia: tuple[float, ...]
    damping: tuple[float, ...]
    torque_limit: tuple[float, ...]
    delay_s: float = 0.0
    full_braking: bool = False


@dataclass(frozen=True)
class Crank:
    """The parts that turn with the knee's drive even where the pin is soft: crank and coupler.

    M12 (factor of cos alpha), M22 [kg m^2], g2 [N m]: their part of a linkage's increments.
    """

    M12: float = 0.0
    M22: float = 0.0
    g2: float = 0.0


@dataclass(frozen=True)
class Linkage:
    """Increments of a parallelogram over its serial tree, in actuator coordinates (paper, Eq. 18).

    M11, M12 (factor of cos alpha), M22 [kg m^2]; g1, g2 [N m], torque -g sin q. `identified` says
    that the numbers come from identification, so that adding the linkage costs no free parameter.
    `crank`: what of them is not the links', None where that is not known.
    """

    M11: float = 0.0
    M12: float = 0.0
    M22: float = 0.0
    g1: float = 0.0
    g2: float = 0.0
    identified: bool = False
    crank: Crank | None = None


@dataclass(frozen=True)
class Ground:
    """The ground, and the feet that stand on it.

    Attributes:
        feet: sites of the serial tree, where a sphere of `radius` [m] is put, or geoms of its own.
        radius: of the feet at sites [m].
        height: of a plane that is put into the world [m], or None where the MJCF has the ground.
        surface: geom of the world that is the ground, or None where a plane is put there.
        friction: coefficient; None: what MuJoCo takes from both geoms.
        stiffness, damping: of a contact [N/m, N s/m]; None: what MuJoCo takes from both geoms.
    """

    feet: tuple[str, ...]
    radius: float | None = None
    height: float | None = None
    surface: str | None = None
    friction: float | None = None
    stiffness: float | None = None
    damping: float | None = None


@dataclass(frozen=True)
class AppliedEffect:
    """A physical effect that is part of a model: which, where, with which parameters (SI)."""

    key: EffectKey
    parameters: Mapping[str, Estimate] = field(default_factory=dict)

    @property
    def values(self) -> dict[str, float]:
        """Parameter values by name, SI."""
        return {name: estimate.value for name, estimate in self.parameters.items()}


@dataclass(frozen=True, repr=False)
class Model(Shown):
    """A machine as the user believes it to be.

    Attributes:
        name: the model's name.
        serial: MJCF file of the serial tree.
        axes: names of the actuated axes, length n (the drives).
        joints: MJCF joints of the serial coordinates q_s, length n.
        transmission: matrix J (n, n) with q_p = J q_s (paper, Eq. 1).
        actuators: the drives.
        closed_chain: the real mechanism with its loops, if it is known.
        posture_dependent: J changes with the posture, and `transmission` is its value at the start posture.
        linkage: what the serial tree leaves out of a parallelogram, if this is one.
        variant: name in `VARIANTS`; its structural effects stand first in `effects`.
        effects: everything added to the serial tree, in order of addition.
        controller: the loop it usually runs in.
        payload_site: MJCF site that carries a payload.
        ground: what it stands on, where recordings are made on the ground.
        floats: its base is free, and the last six axes (`floating.BASE_AXES`) are those of the base.
        sliding_speed: speed at which dry friction has its full value [rad/s; a tenth of it in m/s];
            below, an axis creeps. Bearings and gears do so, and no log tells 0 from a very small one.
        friction_as_in_mjcf: dry friction that the MJCF states sets in as MuJoCo's constraint has it there, by
            ``solreffriction`` and ``solimpfriction``, rather than at the sliding speed.
        flank_retardation_s: damping of a gap's flanks over their stiffness [s], while they touch.
        carried: what hangs on the drives beside the serial tree, where that is no tree; `payload_site` is
            then one of its links.
        source: file it was read from.
    """

    _shown_by = "workbench.models.notebook"

    name: str
    serial: Path
    axes: tuple[str, ...]
    joints: tuple[str, ...]
    transmission: np.ndarray
    actuators: Actuators
    closed_chain: Mechanism | None = None
    posture_dependent: bool = False
    linkage: Linkage | None = None
    variant: str = "kin_only"
    effects: tuple[AppliedEffect, ...] = ()
    controller: Controller = field(default_factory=Controller)
    payload_site: str | None = None
    sliding_speed: float = 0.0005
    friction_as_in_mjcf: bool = False
    flank_retardation_s: float = 0.0
    ground: Ground | None = None
    floats: bool = False
    carried: Carried | None = None
    source: Path | None = None

    @property
    def files(self) -> list[Path]:
        """Files the model was read from: its own, serial tree, closed chain, and all that the tree names.

        Raises:
            InputError: the serial tree cannot be read any more.
        """
        return [*self._named, *([] if is_urdf(self.serial) else check_mjcf(self.serial)[1:])]

    @property
    def _named(self) -> list[Path]:
        chain = self.closed_chain.file if self.closed_chain else None
        return [path for path in (self.source, self.serial, chain) if path is not None]

    def place(self, file: Path) -> Path:
        """Where one of `files` goes in a folder with all of them, so that the serial tree finds its files."""
        return Path(file.name) if file in self._named else file.relative_to(self.serial.parent)

    def digests(self) -> dict[str, str]:
        """Return the SHA-256 of each of `files`, hexadecimal, by its `place`.

        Raises:
            InputError: a file cannot be read.
        """
        return {self.place(file).as_posix(): digest(file) for file in self.files}

    @property
    def links(self) -> tuple[Path, tuple[str, ...]]:
        """Return the MJCF of the links, and the joint of each axis in it: the serial tree's, or of what
        is carried.
        """
        there = self.carried or self
        return there.serial, there.joints

    @property
    def size(self) -> int:
        """Number of axes n."""
        return len(self.axes)

    @property
    def driven(self) -> tuple[str, ...]:
        """Return the axes that have a drive: all except those of a floating base."""
        return self.axes[: -len(BASE_AXES)] if self.floats else self.axes

    def on_its_stand(self, doing: str) -> Model:
        """Return this model, for functions that need a fixed base.

        Raises:
            InputError: its base floats; `doing` says what cannot be done with it.
        """
        if self.floats:
            raise InputError(
                f"the base of model '{self.name}' floats, and {doing} takes one that is fixed",
                file=self.source,
                remedy="take the <freejoint/> out of a copy of its MJCF",
            )  # fmt: skip
        return self

    def has(self, effect: str, axis: str | None = None) -> bool:
        """Return whether an effect of this name (on this axis, if given) is in the model."""
        return any(e.key.effect == effect and (axis is None or e.key.axis == axis) for e in self.effects)

    def with_effect(self, effect: AppliedEffect) -> Model:
        """Return a new model with this effect added; effects of one key act side by side."""
        return replace(self, effects=(*self.effects, effect))
