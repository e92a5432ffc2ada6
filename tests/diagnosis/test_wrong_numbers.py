"""Numbers of an arm's file that are wrong are told with what they are, from positions alone too."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from workbench.core import Diagnosis, EffectKey
from workbench.diagnosis import diagnose
from workbench.effects import load_model


def told(
    folder: Path,
    positions_alone: bool = False,
    resisting=None,
    true: Mapping[str, float] = {},
    **wrong: float,
) -> Diagnosis:
    """A diagnosis of a model with these numbers, of logs of the arm as it is."""
    machine, model = bench_arm(folder, "arm", **true), load_model(bench_arm(folder, "model", **wrong))
    slow = {"log_s": 0.01, "loop_s": 0.001, "positions_alone": True} if positions_alone else {}
    logs = [
        logged(machine, tones, seconds=5.0, resisting=resisting, seed=seed, **slow)
        for seed, tones in enumerate((SLOW, FAST))
    ]
    return diagnose(model, logs)


def test_damping_where_current_was_logged_and_no_speed(tmp_path: Path) -> None:
    """The current tells that the loop read a sensor; else each axis would lack a rotor of kd T / 2."""
    logs = []
    for seed, tones in enumerate((SLOW, FAST)):
        log = logged(bench_arm(tmp_path), tones, seconds=8.0, seed=seed)
        signals = {name: x for name, x in log.signals.items() if name != "torque_command"}
        signals["velocity"] = np.gradient(log.position, log.period, axis=0)
        logs.append(replace(log, signals=signals, derived=("velocity",)))
    (finding,) = diagnose(load_model(bench_arm(tmp_path, "model", lift_damping=1.2)), logs).findings
    assert (finding.key.effect, finding.key.axis) == ("viscous_damping", "lift")
    assert finding.parameters["damping"].value == pytest.approx(-0.4, rel=0.02)


def test_a_spring_that_is_too_stiff(tmp_path: Path) -> None:
    found = told(tmp_path, true={"bend_stiffness": 2.0, "bend_rest": 0.4}, bend_stiffness=6.0, bend_rest=0.4)
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis, finding.model_value) == ("parallel_spring", "bend", 6.0)
    assert finding.total is not None and finding.total.value == pytest.approx(2.0, rel=0.03)
    assert finding.parameters["rest"].value == pytest.approx(0.4, abs=0.02)


def test_a_spring_that_rests_elsewhere(tmp_path: Path) -> None:
    """A constant torque, which is said to be perhaps that."""
    found = told(tmp_path, true={"bend_stiffness": 6.0, "bend_rest": 0.5}, bend_stiffness=6.0, bend_rest=0.4)
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis) == ("torque_bias", "bend")
    assert finding.parameters["torque"].value == pytest.approx(0.6, rel=0.05)
    assert any("rest position of the model's spring there: 0.1" in note for note in found.notes)


def patch(position: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Friction that no effect is: at one angle of the yaw."""
    return np.array([-3.0 * np.exp(-(((position[0] - 0.3) / 0.08) ** 2)) * np.sign(speed[0]), 0.0, 0.0])


def test_a_rotor_from_positions_alone(tmp_path: Path) -> None:
    """How the loop got its reference and its speed is not taken for damping or inertia of the others."""
    (finding,) = told(tmp_path, positions_alone=True, lift_armature=0.15).findings
    assert (finding.key.effect, finding.key.axis) == ("reflected_inertia", "lift")
    assert finding.total is not None and finding.total.value == pytest.approx(0.0868, rel=0.03)
    assert finding.model_value == pytest.approx(0.15)


def test_a_centre_of_mass_from_positions_alone(tmp_path: Path) -> None:
    """It hides how the loop got its speed; each way is tried, and no rotor of half a tick is left."""
    (finding,) = told(tmp_path, positions_alone=True, fore_centre=0.07).findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "bend")
    assert finding.parameters["along"].value == pytest.approx(1.3 * (0.14 - 0.07), rel=0.05)


def test_a_centre_of_mass(tmp_path: Path) -> None:
    (finding,) = told(tmp_path, fore_centre=0.07).findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "bend")
    assert finding.parameters["along"].value == pytest.approx(1.3 * (0.14 - 0.07), rel=0.03)
    assert abs(finding.parameters["across"].value) < 0.003


def test_a_centre_of_mass_beside_something_unknown(tmp_path: Path) -> None:
    """A rough patch at one angle of the yaw takes nothing from what is certain of the fore-arm."""
    found = told(tmp_path, resisting=patch, fore_centre=0.07)
    assert found.verdict == "partly_explained"
    named = {(f.key.effect, f.key.axis): f for f in found.findings}
    moment = named["first_moment_error", "bend"].parameters["along"]
    assert moment.value == pytest.approx(1.3 * 0.07, rel=0.05)
    assert not any(f.key.axis == "yaw" and f.probability > 0.5 for f in found.findings)


def test_a_payload_beside_something_unknown(tmp_path: Path) -> None:
    """0.2 kg at the tip are one number; errors of all the links' masses would explain no more."""
    bare = {"fore_mass": 1.1, "fore_centre": (1.3 * 0.14 - 0.2 * 0.3) / 1.1}
    bare["fore_inertia"] = 0.032 - 1.1 * (bare["fore_centre"] - 0.14) ** 2 - 0.2 * (0.3 - 0.14) ** 2
    found = told(tmp_path, resisting=patch, **bare)
    assert found.verdict == "partly_explained"
    (payload,) = (f for f in found.findings if f.key.effect == "payload_mass")
    assert payload.parameters["mass"].value == pytest.approx(0.2, rel=0.05)
    assert not any(f.key.axis == "yaw" for f in found.findings)


def test_the_mass_of_a_link_in_the_middle_is_one_number(tmp_path: Path) -> None:
    """Its weight rests on the upper arm too, whose own numbers are right."""
    found = told(tmp_path, fore_mass=2.0)
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "bend")
    assert finding.parameters["along"].value == pytest.approx(-0.7 * 0.14, rel=0.02)
    assert (finding.number, finding.model_value) == ("mass", 2.0)
    assert finding.total is not None and finding.total.value == pytest.approx(1.3, rel=0.02)


def test_a_mass_with_its_inertia_is_one_number(tmp_path: Path) -> None:
    """Of a wrong density; a constant torque of the axis before it would stand in for the inertia."""
    found = told(tmp_path, upper_mass=3.6, upper_inertia=0.033, upper_roll=0.006)
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "lift")
    assert finding.parameters["inertia"].value == pytest.approx(-0.011, rel=0.05)
    assert (finding.number, finding.model_value) == ("mass", 3.6)
    assert finding.total is not None and finding.total.value == pytest.approx(2.4, rel=0.02)


def test_the_mass_of_the_first_link_is_one_number(tmp_path: Path) -> None:
    """Its centre elsewhere and another rotor explain the same with two."""
    level = {"yaw_x": 1.0, "yaw_z": 0.0, "turret_centre": 0.2}
    found = told(tmp_path, true=level, **level, turret_mass=5.0)
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "yaw")
    assert (finding.number, finding.model_value) == ("mass", 5.0)
    assert finding.total is not None and finding.total.value == pytest.approx(3.0, rel=0.02)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_centre_of_mass_that_is_far_off(tmp_path: Path, factor: float) -> None:
    """Its inertia changes by the square of its lever; a linearisation would rather have another mass."""
    found = told(tmp_path, upper_centre=0.17 * factor)
    (finding,) = found.findings
    assert (finding.key.effect, finding.key.axis) == ("first_moment_error", "lift")
    assert finding.number == "first moment"
    assert finding.parameters["along"].value == pytest.approx(2.4 * 0.17 * (1.0 - factor), rel=0.02)


def test_all_inertia_of_a_link_is_one_number(tmp_path: Path) -> None:
    """Two rotors would do nearly the same: the link's own and that of the axis which swings it."""
    (finding,) = told(tmp_path, fore_inertia=0.08, fore_roll=0.035).findings
    assert (finding.key.effect, finding.key.axis) == ("link_inertia_error", "bend")
    assert finding.total is not None and finding.total.value == pytest.approx(0.032, rel=0.05)


def test_friction_from_positions_alone_of_an_arm_that_rests(tmp_path: Path) -> None:
    """A reference that rests is not one that waits for rows: else six numbers beside it come out wrong."""
    machine, model = bench_arm(tmp_path, yaw_friction=2.0), bench_arm(tmp_path, "model", yaw_friction=0.8)
    kind = {"seconds": 6.0, "log_s": 0.01, "loop_s": 0.001, "positions_alone": True}
    logs = [
        logged(machine, tones, held=False, pauses=True, seed=seed, **kind)
        for seed, tones in enumerate((SLOW, FAST))
    ]
    (finding,) = diagnose(load_model(model), logs).findings
    assert finding.key == EffectKey("coulomb_friction", "yaw")
    assert finding.parameters["torque"].value == pytest.approx(1.2, abs=0.012)
