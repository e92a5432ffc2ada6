"""Two axes with each other's columns: whole without a model, against its weight and inertia with one."""

from __future__ import annotations

import numpy as np
import pytest

from tests.planar_leg import MOTION, TORQUE, moved, turned, write_leg
from workbench.comparison import swapped_axes
from workbench.core import InputError, Recording
from workbench.diagnosis.checks.sign_check import refuse_wrong_sign_of_torque
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return load_model(str(write_leg(tmp_path_factory.mktemp("leg"))))


def exchanged(recording: Recording) -> Recording:
    return recording.with_signals(**{name: np.fliplr(x) for name, x in recording.signals.items()})


def test_all_columns_of_two_axes_are_exchanged(leg: Model) -> None:
    found = swapped_axes(leg, [exchanged(moved())])
    assert found is not None and set(found.axes) == {"hip", "knee"} and found.after < 0.02
    with pytest.raises(InputError, match="are swapped"):
        refuse_wrong_sign_of_torque(leg, [exchanged(moved())])


@pytest.mark.parametrize("friction", [0.0, 0.2, 1.0])
def test_a_right_log_is_not_swapped_whatever_the_friction(leg: Model, friction: float) -> None:
    assert swapped_axes(leg, [moved(friction=friction)]) is None


def test_a_wrong_sign_is_no_exchange(leg: Model) -> None:
    assert swapped_axes(leg, [turned(moved(), "knee", *TORQUE)]) is None
    assert swapped_axes(leg, [turned(moved(), "hip", *MOTION)]) is None
