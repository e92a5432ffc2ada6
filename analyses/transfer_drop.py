"""How hard the ground of the virtual quadruped damps: it is let down on it, and so is the simulation.

    python analyses/transfer_drop.py

The hardware states 100 kN/m and 150 N s/m for each foot. Drake takes the force at the end of its step, which
damps more by the stiffness times the step: 50 N s/m in steps of 0.5 ms. The simulation that has these too is
nearest.
"""

from __future__ import annotations

import numpy as np
from transfer_floor import ON_PLATE
from transfer_robot import RobotPlant
from transfer_worlds import IdentifiedLaw, world_of

from workbench.models import read_model
from workbench.training.machine import Machine, make_machine
from workbench.training.plant import Plant, begin
from workbench.training.plants import TrainedPlant

_DAMPINGS = 100.0, 150.0, 200.0, 261.0, 350.0  # N s/m
_STEPS, _FINE_S = 60, 0.0001  # control steps; s
_KP, _KD = 50.0, 1.5


def drop(machine: Machine, plant: Plant) -> np.ndarray:
    """Return the force on all feet together (T,) [N] while a quadruped is let down 5 mm and held."""
    begin(plant, machine)
    hold, back, out = machine.posture, np.linalg.inv(machine.transmission).T, []
    for _ in range(_STEPS):
        now = plant.state()
        q, v = machine.joint_motion(now.position, now.velocity)
        plant.advance(back @ (_KP * (hold - q) - _KD * v))
        out.append(plant.state().feet[:, 2].sum())
    return np.array(out)


def misses() -> dict[float, float]:
    """Return the RMS difference of the force [N] from the hardware, by the simulation's damping [N s/m]."""
    machine = make_machine("quadruped", read_model("leg"), "exact")
    real = drop(machine, RobotPlant(machine, ON_PLATE))
    found = {}
    for damping in _DAMPINGS:
        law = IdentifiedLaw(1e5, damping, 0.8, _FINE_S)
        made = drop(machine, TrainedPlant(machine, world_of(machine, law, 0.0)))
        found[damping] = float(np.sqrt(np.mean((made - real) ** 2)))
    return found


def main() -> None:
    """Print the differences."""
    for damping, miss in misses().items():
        print(f"simulation with {damping:g} N s/m: force of the feet off by {miss:.1f} N")


if __name__ == "__main__":
    main()
