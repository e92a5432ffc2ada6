"""Hardware as it is drawn adds nothing, and training's contact is what it is called."""

import numpy as np

from workbench.effects import load_model
from workbench.training.machine import STEP_S, STIFF_S, make_machine
from workbench.training.robot import IDEAL

FEET = [f"{leg}_sphere" for leg in ("fl", "fr", "rl", "rr")]


def test_training_s_contact_is_as_stiff_as_its_step_allows() -> None:
    m = make_machine("quadruped", load_model("leg"), stiff=True).mujoco
    assert m.opt.timestep == STEP_S and STIFF_S == 2.0 * STEP_S
    assert (m.geom_solref[[m.geom(foot).id for foot in FEET], 0] == STIFF_S).all()


def test_hardware_as_it_is_drawn_adds_nothing() -> None:
    torque, down, still = np.full(2, 20.0), np.array([[0.0, 0.0, -1.0]]), np.zeros((1, 3))
    assert IDEAL.delivered(torque, np.full(2, 30.0), np.full(2, 24.0)) is torque
    gravity, angular = IDEAL.felt(down, still, [(down, np.ones((1, 3)))])
    assert gravity is down and angular is still and not IDEAL.latency_steps
