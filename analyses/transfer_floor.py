"""What recordings of one leg on the force plate tell: the law of the ground, and torque constants.

    python analyses/transfer_floor.py

The law: the model of the leg knows none at first, MuJoCo's default of 20 ms. `improve` finds two effects,
`contact_compliance` and `ground_friction`. The ground of the quadruped is then that of the plate.

Torque constants: a hip gives 94 % of the torque that it reports. In the air nothing shows it: the identified
inertia is larger by as much. Under load it is named.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from transfer_identification import identify_plant
from transfer_plants import EFFECTS
from transfer_plants import Plant as Leg
from transfer_worlds import IdentifiedLaw

from workbench import improve
from workbench.core import Improvement
from workbench.models import Ground, Model, read_model, write_model
from workbench.rigs import HiddenEffect, Plate, VirtualLeg, plate_experiments
from workbench.training.robot import Robot

_PLATE = Plate()
#: The hardware on the ground of the plate.
ON_PLATE = Robot(friction=_PLATE.friction, ground_stiffness=_PLATE.stiffness, ground_damping=_PLATE.damping)
_SECONDS, _SEED = 0.8, 5000


def identified_law(leg: Path, folder: Path, seed: int) -> IdentifiedLaw:
    """The law that recordings press, step and slide give, tested on walk; kept in the folder.

    Args:
        leg: model of the leg in the air.
        folder: of the models.
        seed: of the sensors' noise.
    """
    file = folder / f"{leg.stem}_on_plate.toml"
    if not file.exists():
        write_model(improved(read_model(leg), seed)[1], file, force=True)
    return IdentifiedLaw.of(read_model(file))


def improved(leg: Model, seed: int, *hidden: HiddenEffect, law: bool = False) -> tuple[Improvement, Model]:
    """What `improve` adds to a leg from recordings on the plate.

    Args:
        leg: the model.
        seed: of the sensors' noise.
        hidden: in the leg that is recorded.
        law: whether the model knows the law of the ground.
    """
    ground = Ground(("foot",), radius=_PLATE.radius, height=_PLATE.height)
    if law:
        known = _PLATE.friction, _PLATE.stiffness, _PLATE.damping
        ground = replace(ground, friction=known[0], stiffness=known[1], damping=known[2])
    rig = VirtualLeg(hidden, seed=_SEED + seed, plate=_PLATE)
    *training, judge = rig.run(plate_experiments(_SEED + seed, _SECONDS))
    return improve(replace(leg, ground=ground), training, [judge], seed=seed)


def main() -> None:
    """Print what is found of the ground, and of a weak hip."""
    print(improved(read_model("leg"), 0)[0])
    [weak] = [e for e in EFFECTS if e.effect == "torque_constant_error"]
    leg = identify_plant(Leg("weak hip", (weak,), 0)).variant("exact")
    print(f"\nIn the air, the inertia of the hip's drive: {1e3 * leg.actuators.inertia[0]:.2f} g m^2 (16.2)")
    print(improved(leg, 0, weak, law=True)[0])


if __name__ == "__main__":
    main()
