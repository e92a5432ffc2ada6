"""The law of the ground, from recordings of one leg on the force plate: stiffness, damping, friction.

The model of the leg knows no law at first: MuJoCo's default of 20 ms. `improve` finds two effects,
`contact_compliance` and `ground_friction`. The ground of the quadruped is then that of the plate.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from workbench import improve
from workbench.models import Ground, read_model, write_model
from workbench.rigs import Plate, VirtualLeg, plate_experiments
from workbench.training.floor import IdentifiedLaw
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
        known = read_model(leg)
        ground = Ground(("foot",), radius=_PLATE.radius, height=_PLATE.height)
        *training, judge = VirtualLeg((), seed=_SEED + seed, plate=_PLATE).run(
            plate_experiments(_SEED + seed, _SECONDS)
        )
        _, model = improve(replace(known, ground=ground), training, [judge], seed=seed)
        write_model(model, file, force=True)
    return IdentifiedLaw.of(read_model(file))
