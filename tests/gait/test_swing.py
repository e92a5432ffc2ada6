"""A leg in the air is predicted exactly by its own model, and a wrong one misses by what is wrong."""

from dataclasses import replace

import numpy as np
import pytest

from tests.gait.make import FEET, JOINTS, flight, toy
from workbench.core import InputError
from workbench.gait import limbs_of, predict_swing


def limbs(armature: float = 0.01, motors: np.ndarray | None = None):
    return limbs_of(toy(armature), JOINTS, np.eye(4) if motors is None else motors, FEET)


def test_its_own_model_predicts_it() -> None:
    made = predict_swing(limbs(), flight(toy()))
    assert made is not None and set(made.error) == {"hip", "knee"} and made.count > 40
    for error in made.error.values():  # the base's acceleration is a difference over a row
        assert error.value < 0.004 and error.high < 0.01


def test_a_rotor_that_is_missing_shows_where_it_is() -> None:
    made = predict_swing(limbs(0.0001), flight(toy()))
    assert made is not None
    inertia = 0.004 + 0.4 * 0.1**2  # the knee's link about its joint
    share = (0.01 - 0.0001) / (inertia + 0.0001)  # by which its change of speed is too large
    assert made.error["knee"].value == pytest.approx(share, rel=0.35)
    assert made.error["knee"].low > 0.3 and made.error["hip"].value < 0.5 * made.error["knee"].value


def test_drives_that_are_not_on_the_joints() -> None:
    """A knee driven from the hip: q_p = J q_s, tau_s = J^T tau_p."""
    one = np.array([[1.0, 0.0], [1.0, 1.0]])
    j = np.kron(np.eye(2), one)
    log = flight(toy())
    back = np.linalg.inv(j)
    turned = replace(
        log,
        signals={
            "position": log.position @ j.T, "velocity": log.velocity @ j.T,
            "torque_measured": log.signals["torque_measured"] @ back,
        },
    )  # fmt: skip
    made = predict_swing(limbs(motors=j), turned)
    assert made is not None and max(e.value for e in made.error.values()) < 0.004


def test_without_forces_heights_of_feet_tell_who_is_in_the_air() -> None:
    log = flight(toy())
    blind = replace(log, extra={k: v for k, v in log.extra.items() if k != "ground_force"})
    both, one = predict_swing(limbs(), log), predict_swing(limbs(), blind)
    assert both is not None and one is not None and 0 < one.count < both.count
    assert one.error["knee"].value < 0.01


def test_what_is_lacking_is_named() -> None:
    log = flight(toy(), 0.1)
    blind = replace(log, extra={k: v for k, v in log.extra.items() if k != "base_velocity"})
    with pytest.raises(InputError, match="prediction needs base_velocity"):
        predict_swing(limbs(), blind)
    standing = replace(log, extra={**log.extra, "ground_force": np.ones((len(log), 6)) * 9.0})
    assert predict_swing(limbs(), standing) is None
