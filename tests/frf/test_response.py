"""What is done with a response: a part of it, other coordinates, pooled covariances, python-control."""

from __future__ import annotations

import control
import numpy as np
import pytest

from workbench.core import InputError
from workbench.frf import estimate

from .make import design, loop_recordings, mimo_plant, mimo_recordings
from .sure import distance, within


def test_some_axes_and_several_outputs() -> None:
    plant = mimo_plant(2)
    d = design(axes=["a", "b"], f_max_hz=40)
    frf = estimate(mimo_recordings(d, plant, noise=0.01), output=("velocity", "position"))
    assert [str(c) for c in frf.outputs] == ["velocity_a", "velocity_b", "position_a", "position_b"]
    assert frf.outputs[2].unit == "rad" and frf.inputs[0].unit == "N m"
    one = frf.select(["velocity_b"], ["a"])
    assert one.response[:, 0, 0] == pytest.approx(frf.response[:, 1, 0])
    assert one.std[:, 0, 0] == pytest.approx(frf.std[:, 1, 0])
    with pytest.raises(InputError, match="several"):
        frf.select(["b"], ["a"])
    band = within(frf, 10, 20)
    assert band.frequency[[0, -1]].tolist() == [10, 20] and band.covariance.shape == (11, 8, 8)


def test_the_response_for_python_control() -> None:
    plant = mimo_plant(2)
    frf = estimate(mimo_recordings(design(axes=["a", "b"], f_max_hz=40), plant, noise=0.0))
    theirs = frf.to_control()
    assert isinstance(theirs, control.FrequencyResponseData)
    assert theirs.frdata[0, 1, 7] == frf.response[7, 0, 1]
    assert theirs.omega == pytest.approx(2 * np.pi * frf.frequency)
    assert theirs.input_labels == ["torque_measured_a", "torque_measured_b"]


def test_other_coordinates() -> None:
    plant = mimo_plant(2)
    d = design(axes=["a", "b"], f_max_hz=40)
    frf = estimate(mimo_recordings(d, plant, noise=0.1))
    j = np.array([[1.0, 0.0], [1.0, 1.0]])
    there = frf.transformed(j, j.T, outputs=frf.outputs, inputs=frf.inputs)
    assert there.response[5] == pytest.approx(j @ frf.response[5] @ j.T)
    back = there.transformed(np.linalg.inv(j), np.linalg.inv(j.T), outputs=frf.outputs, inputs=frf.inputs)
    assert back.covariance == pytest.approx(frf.covariance, abs=1e-12)
    # distances do not depend on coordinates
    model = 1.01 * frf.response
    assert distance(there, j @ model @ j.T)[0] == pytest.approx(distance(frf, model)[0])


def test_smoothing_pools_residuals() -> None:
    (r,) = loop_recordings(design(periods=3), noise=0.1, gain=0.3)
    frf = estimate([r], transient_periods=1)
    smooth = frf.smoothed(5)
    # a line's own residuals and the fresh ones of ten neighbours, less what the level's slope costs
    assert smooth.dof[50] == pytest.approx(9 + 10 * 2, rel=0.2) and smooth.dof[0] < 9 + 5 * 2
    assert np.std(np.log(smooth.std[5:95])) < 0.8 * np.std(np.log(frf.std[5:95]))
    assert np.mean(smooth.std**2) == pytest.approx(np.mean(frf.std**2), rel=0.25)
