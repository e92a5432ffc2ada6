"""Names, signs and resolutions as published logs have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.proposing.make import imported, log, put, text
from workbench.core import InputError
from workbench.proposing import Answers, open_table, propose
from workbench.proposing.match import held_share
from workbench.proposing.names import role_of

LOG = log()


def numbered(position: str, velocity: str, torque: np.ndarray) -> dict[str, np.ndarray]:
    """A log without a reference, columns numbered from one."""
    out = {"t": LOG.t}
    for name, values in ((position, LOG.q), (velocity, LOG.v), ("tau", torque)):
        out |= {f"{name}{i + 1}": values[:, i] for i in range(2)}
    return out


@pytest.mark.parametrize(("position", "velocity"), [("q", "dq"), ("th", "dth"), ("th", "thdot")])
def test_symbols_of_an_angle_and_its_derivative(tmp_path: Path, position: str, velocity: str) -> None:
    _, recording = imported(put(tmp_path, text(numbered(position, velocity, LOG.tau))))
    assert not recording.derived and np.allclose(recording.signals["torque_measured"], LOG.tau)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("Input Torque [Nm]", "reference"),
        ("Torque Measurement [Nm]", "measured"),
        ("input_torque", "reference"),
    ],
)
def test_what_goes_into_a_drive_and_what_a_sensor_measures(name: str, role: str) -> None:
    found = role_of(name)
    assert (found.kind, found.role, found.joint) == ("torque", role, "")


def test_an_encoder_on_the_input_side_is_no_reference() -> None:
    assert role_of("input_position").role == ""


def test_torques_of_a_drive_by_input_and_measurement(tmp_path: Path) -> None:
    names = "Time [s]", "Position [rad]", "Velocity [rad/s]", "Input Torque [Nm]", "Torque Measurement [Nm]"
    values = LOG.t, LOG.q[:, 0], LOG.v[:, 0], LOG.cmd[:, 0], LOG.tau[:, 0]
    _, recording = imported(put(tmp_path, text(dict(zip(names, values, strict=True)))))
    assert np.allclose(recording.signals["torque_command"][:, 0], LOG.cmd[:, 0])
    assert np.allclose(recording.signals["torque_measured"][:, 0], LOG.tau[:, 0])


def test_a_coarse_sensor_repeats_rows_and_holds_none(tmp_path: Path) -> None:
    step = 2.5 * float(np.median(np.abs(np.diff(LOG.cmd, axis=0))))
    slow = np.round(LOG.cmd / step) * step
    assert float(np.mean(np.diff(slow, axis=0) == 0)) > 0.4
    proposal, _ = imported(put(tmp_path, text(numbered("q", "dq", slow))))
    assert "torque_measured" in proposal.description["columns"]


@pytest.mark.parametrize("rows", [2, 5])
def test_a_held_command_is_one_however_coarse_it_is(rows: int) -> None:
    held = np.repeat(LOG.cmd[::rows, 0], rows)
    coarse = np.round(held / (0.01 * np.ptp(held)))
    ramp = np.repeat(np.arange(200.0), rows)
    for values in (held, coarse, ramp):
        assert held_share(values) > 0.4


def test_a_motor_constant_may_be_negative(tmp_path: Path) -> None:
    answers = Answers(units={"torque": "-8.7*N*m,2*N*m"})
    data = numbered("q", "dq", LOG.tau / np.array([-8.7, 2.0]))
    proposal, recording = imported(put(tmp_path, text(data)), answers)
    assert proposal.description["units"]["torque"] == ["-8.7*N*m", "2*N*m"]
    assert np.allclose(recording.signals["torque_measured"], LOG.tau)


def test_so_may_a_position_and_then_its_velocity_follows(tmp_path: Path) -> None:
    file = put(tmp_path, text(numbered("q", "dq", LOG.tau)))
    for units in ({"position": "-1*rad"}, {"position": "-1*rad", "velocity": "-1*rad/s"}):
        _, recording = imported(file, Answers(units=units))
        assert np.allclose(recording.position, -LOG.q) and np.allclose(recording.velocity, -LOG.v)


@pytest.mark.parametrize("unit", ["0*N*m", "-*N*m", "nan*N*m", "-inf*N*m"])
def test_what_is_no_factor(tmp_path: Path, unit: str) -> None:
    table = open_table(put(tmp_path, text(numbered("q", "dq", LOG.tau))))
    with pytest.raises(InputError, match="is not a unit of torque"):
        propose(table, Answers(units={"torque": unit}))


def test_torque_that_stays_zero_is_said_to(tmp_path: Path) -> None:
    file = put(tmp_path, text(numbered("q", "dq", np.zeros_like(LOG.tau))))
    notes = " ".join(propose(open_table(file)).notes)
    assert "tau1, tau2 are zero in every row" in notes and 'kind = "none"' in notes
    assert "--column torque_command=tau1,tau2" in notes
