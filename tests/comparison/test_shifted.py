"""Axes that count from another zero: by quarters of a turn, told by weight before springs are named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.planar_leg import TORQUE, moved, turned, write_leg
from workbench.comparison import shifted_axes
from workbench.core import InputError, Recording
from workbench.diagnosis.checks.sign_check import refuse_wrong_sign_of_torque
from workbench.effects import load_model
from workbench.models import Model


@pytest.fixture(scope="module")
def leg(tmp_path_factory: pytest.TempPathFactory) -> Model:
    return load_model(str(write_leg(tmp_path_factory.mktemp("leg"))))


def shifted(recording: Recording, *by: float) -> Recording:
    names = ("position", "position_reference")
    return recording.with_signals(**{n: recording.signals[n] + np.array(by) for n in names})


@pytest.mark.parametrize("by", [(np.pi, np.pi), (-np.pi / 2, 0.0), (0.0, np.pi / 2)])
def test_the_zero_of_an_encoder_is_elsewhere(leg: Model, by: tuple[float, float]) -> None:
    log = shifted(moved(), *by)
    found = shifted_axes(leg, [log])
    assert found is not None and found.after < 0.02
    back = np.array([found.by.get(axis, 0.0) for axis in log.axes]) + by
    np.testing.assert_allclose(np.exp(1j * back), 1.0, atol=1e-9)
    with pytest.raises(InputError, match="a different zero"):
        refuse_wrong_sign_of_torque(leg, [log])


def test_neither_a_right_log_nor_a_wrong_sign_is_moved(leg: Model) -> None:
    assert shifted_axes(leg, [moved(friction=1.0)]) is None
    assert shifted_axes(leg, [turned(moved(), "knee", *TORQUE)]) is None


def test_a_slide_has_no_turns(leg: Model) -> None:
    log = shifted(moved(), np.pi, 0.0)
    assert shifted_axes(leg, [replace(log, units=("m", "rad"))]) is None
