"""What recordings of one leg on the force plate tell: the law of the ground, and torque constants.

    python analyses/transfer_floor.py

The law: the model of the leg knows none at first, MuJoCo's default of 20 ms. `improve` finds two effects,
`contact_compliance` and `ground_friction`. Stiffness and damping are then taken from how the foot sinks under
the measured force (`transfer_sinking.py`), which tells them closer. The ground of the quadruped is then that
of the plate.

Torque constants: a hip gives 94 % of the torque that it reports. In the air nothing shows it: the identified
inertia is larger by as much. Under load it is named.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from transfer_identification import identify_plant
from transfer_plants import EFFECTS
from transfer_plants import Plant as Leg
from transfer_robot import Robot
from transfer_sinking import Sinking, sinking
from transfer_worlds import IdentifiedLaw

from workbench import improve
from workbench.core import EffectKey, Estimate, Improvement, Recording
from workbench.models import AppliedEffect, Ground, Model, read_model, write_model
from workbench.rigs import HiddenEffect, Plate, VirtualLeg, plate_experiments

_PLATE = Plate()
#: The hardware on the ground of the plate.
ON_PLATE = Robot(friction=_PLATE.friction, ground_stiffness=_PLATE.stiffness, ground_damping=_PLATE.damping)
_ON = Ground(("foot",), radius=_PLATE.radius, height=_PLATE.height)
_SECONDS, _SEED = 0.8, 5000
_SEEDS = range(5)


def identified_law(leg: Path, folder: Path, seed: int) -> IdentifiedLaw:
    """The law that recordings press, step, slide and walk give; kept in the folder.

    Args:
        leg: model of the leg in the air.
        folder: of the models.
        seed: of the sensors' noise.
    """
    file = folder / f"{leg.stem}_on_plate.toml"
    if not file.exists():
        write_model(improved(read_model(leg), seed)[1], file, force=True)
    return IdentifiedLaw.of(with_law(read_model(file), sinks(read_model(leg), seed)))


def improved(leg: Model, seed: int, *hidden: HiddenEffect, law: bool = False) -> tuple[Improvement, Model]:
    """What `improve` adds to a leg from recordings on the plate.

    Args:
        leg: the model.
        seed: of the sensors' noise.
        hidden: in the leg that is recorded.
        law: whether the model knows the law of the ground.
    """
    ground = _ON
    if law:
        known = _PLATE.friction, _PLATE.stiffness, _PLATE.damping
        ground = replace(ground, friction=known[0], stiffness=known[1], damping=known[2])
    *training, judge = recorded(seed, *hidden)
    return improve(replace(leg, ground=ground), training, [judge], seed=seed)


def recorded(seed: int, *hidden: HiddenEffect) -> list[Recording]:
    """The leg on the plate: press, step, slide, and walk for tests."""
    rig = VirtualLeg(hidden, seed=_SEED + seed, plate=_PLATE)
    return rig.run(plate_experiments(_SEED + seed, _SECONDS))


def sinks(leg: Model, seed: int) -> Sinking:
    """How the foot sinks into the plate under the measured force."""
    return sinking(replace(leg, ground=_ON), recorded(seed), _PLATE.noise)


def with_law(found: Model, sunk: Sinking) -> Model:
    """A model whose `contact_compliance` has the stiffness and damping of how its foot sinks."""
    values = {
        "stiffness": Estimate(sunk.stiffness, sunk.stiffness_half / 1.96, "N/m"),
        "damping": Estimate(sunk.damping, sunk.damping_half / 1.96, "N*s/m"),
    }
    law = AppliedEffect(EffectKey("contact_compliance", None), values)
    return replace(found, effects=tuple(law if e.key == law.key else e for e in found.effects))


def main() -> None:
    """Print what is found of the ground, and of a weak hip."""
    print(improved(read_model("leg"), 0)[0])
    print("\nHow the foot sinks under the measured force, five recordings of other noise:")
    for seed in _SEEDS:
        law = sinks(read_model("leg"), seed)
        print(
            f"  {1e-3 * law.stiffness:.2f} ± {1e-3 * law.stiffness_half:.2f} kN/m, "
            f"{law.damping:.0f} ± {law.damping_half:.0f} N s/m"
        )
    [weak] = [e for e in EFFECTS if e.effect == "torque_constant_error"]
    leg = identify_plant(Leg("weak hip", (weak,), 0)).variant("exact")
    print(f"\nIn the air, the inertia of the hip's drive: {1e3 * leg.actuators.inertia[0]:.2f} g m^2 (16.2)")
    print(improved(leg, 0, weak, law=True)[0])


if __name__ == "__main__":
    main()
