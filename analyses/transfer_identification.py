"""From recordings of a plant to its models: drives on a bench, the leg's responses, Algorithm 1, findings.

Nothing else is known of a plant but the CAD tree of the reference leg and the loop's gains.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from transfer_drives import UsedDriveBench
from transfer_plants import Plant

from workbench import improve
from workbench.core import Excitation, Improvement
from workbench.identification import (
    ActuatorIdentification,
    LegIdentification,
    identify_actuator,
    identify_leg,
    with_actuator,
    with_leg,
)
from workbench.models import Model, read_model
from workbench.rigs import VirtualLeg, multisine, slow_sweep, validation
from workbench.s3n import with_variant

AXES = ("hip", "knee")
CONTROL_S = 0.003
_BENCH_MEAN, _BENCH_RMS, _BENCH_HZ = 1.5, 3.0, 100  # N m, N m, Hz
_LEG_RMS, _LEG_HZ = (6.0, 3.6), 15.0  # N m a motor; below what a soft knee adds
_FOUND_RMS = (3.0, 1.8)  # N m a motor, to 60 Hz
_PERIOD, _PERIODS = 5.0, 3  # s


@dataclass(frozen=True)
class Identified:
    """What recordings gave.

    Attributes:
        drives: one per drive, from the bench.
        leg: total inertia, from sum and difference modes at alpha = 60 degrees.
        model: Kin-Only with these drives, and with the linkage identified but in no variant yet.
    """

    drives: tuple[ActuatorIdentification, ...]
    leg: LegIdentification
    model: Model

    def variant(self, name: str) -> Model:
        """The model as ``kin_only``, ``s3n_act``, ``s3n_full`` or ``exact``."""
        return with_variant(self.model, name)


def identify_plant(plant: Plant) -> Identified:
    """Steps 1 and 2 of Algorithm 1 (paper, Sec. IV), blind."""
    drives = tuple(
        identify_actuator(
            UsedDriveBench(plant.hidden, axis, seed=1000 + 10 * plant.seed + k).run(
                {"multisine": _bench_command()},
                Excitation("multisine", "single", _PERIOD, 1 / _PERIOD, _BENCH_HZ, "full"),
            )
        )
        for k, axis in enumerate(AXES)
    )
    length = _PERIODS * _PERIOD + 1.0
    modes = [multisine(m, rms=_LEG_RMS, duration=length, f_max=_LEG_HZ) for m in ("sum", "difference")]
    leg = identify_leg(VirtualLeg(plant.hidden, seed=2000 + plant.seed).run(modes))
    nothing = replace(read_model("leg_kin_only"), linkage=None, closed_chain=None)
    full = with_leg(with_actuator(nothing, *drives), leg)
    # the command path delays by whole control steps, as it does in the simulators that train policies
    delay = CONTROL_S * round(full.actuators.delay_s / CONTROL_S)
    prompt = replace(full, actuators=replace(full.actuators, delay_s=delay))
    return Identified(drives, leg, replace(prompt, name="identified", variant="kin_only", effects=()))


def find_effects(plant: Plant, known: Identified, quick: bool = False) -> tuple[Improvement, Model]:
    """What `improve` adds to S3N-Full from four recordings of the plant, judged on a fifth; none is a chirp.

    The linkage's weight comes from these too: where dry friction bends the response at low frequency, its
    stiffness says little of gravity. They push harder than friction holds. What comes near is added too where
    no cause can be named; the improvement says so.
    """
    base = known.variant("s3n_full")
    assert base.linkage is not None
    base = replace(base, linkage=replace(base.linkage, g1=0.0, g2=0.0, identified=False))
    runs = [slow_sweep(6.0), multisine("sum", duration=6.0)] if quick else [
        *(multisine(mode, rms=_FOUND_RMS, duration=6.0) for mode in ("sum", "difference")),
        slow_sweep(8.0),
        replace(validation(plant.seed + 500, 5.0), name="motion"),
    ]  # fmt: skip
    training = VirtualLeg(plant.hidden, seed=3000 + plant.seed).run(runs)
    judge = VirtualLeg(plant.hidden, seed=4000 + plant.seed).run([validation(plant.seed)])
    return improve(base, training, judge, seed=plant.seed, nearest=True)


def found_words(improvement: Improvement) -> tuple[str, ...]:
    """What was found, for tables; marked where it is near and cannot be named."""
    near = " (near, not named)" if improvement.nearest else ""
    return tuple(f"{step.key}{near}" for step in improvement.steps)


def _bench_command() -> np.ndarray:
    """Torque (N,) at 1 kHz: a Schroeder multisine over all lines from 0.2 Hz about a constant.

    The shaft never turns back, so that dry friction is constant too and is not taken for damping.
    """
    t, count = np.arange(round(_PERIODS * _PERIOD * 1e3)) * 1e-3, round(_BENCH_HZ * _PERIOD)
    order = np.arange(1, count + 1)
    phases = -np.pi * order * (order - 1) / count
    tone = np.cos(2 * np.pi * np.outer(t, order) / _PERIOD + phases).sum(axis=1)
    return _BENCH_MEAN + _BENCH_RMS * tone / tone.std()
