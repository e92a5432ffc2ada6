"""On virtual hardware, Table I and the leg's inertia come back, and S3N-Full is built from nothing else."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from workbench.core import Estimate, Excitation, InputError, Recording
from workbench.identification import (
    actuator_figure,
    actuator_sheet,
    check_physical,
    identify_actuator,
    identify_leg,
    leg_sheet,
    serial_form,
    with_actuator,
    with_leg,
)
from workbench.models import read_model
from workbench.rigs import VirtualLeg, multisine
from workbench.rigs.bench import VirtualBench

TOTAL = {"M11": 0.04793, "M12": 0.005413, "M22": 0.02368}


@cache
def bench(seed: int = 0) -> list[Recording]:
    """Five periods of 5 s on the bench, 0.2 to 100 Hz."""
    period, t = 5.0, np.arange(25_000) * 1e-3
    order = np.arange(1, 501)
    tone = np.cos(2 * np.pi * np.outer(t, order) / period - np.pi * order * (order - 1) / 500).sum(axis=1)
    command = 3.0 * tone / tone.std()
    excitation = Excitation("multisine", "single", period, 1 / period, 100.0, "full")
    return VirtualBench(seed).run({"multisine": command}, excitation)


@cache
def leg(seed: int = 0) -> list[Recording]:
    """Sum and difference about alpha = 60 degrees, four periods of 5 s."""
    return VirtualLeg(seed=seed).run(
        [multisine(m, duration=21.0, f_max=100.0) for m in ("sum", "difference")]
    )


def inside(estimate: Estimate, truth: float, deviations: float = 3.5) -> bool:
    return abs(estimate.value - truth) < deviations * estimate.std


def test_the_actuator_is_table_one() -> None:
    found = identify_actuator(bench())
    for estimate, truth in ((found.inertia, 0.0162), (found.damping, 0.0972), (found.delay, 3e-3)):
        np.testing.assert_allclose(estimate.value, truth, rtol=0.01)
        assert inside(estimate, truth)


def test_a_shell_prints_the_numbers_with_intervals() -> None:
    drive, whole = identify_actuator(bench()), identify_leg(leg())
    assert "Inertia    0.0162" in repr(drive) and "delay" in repr(whole) and "M12" in repr(whole)
    for value in (drive, whole):
        assert "array(" not in repr(value) and repr(value).count("\n") < 15
        assert "±" in value._repr_html_() and len(value.plot().axes) >= 2


def test_the_picture_shows_what_each_parameter_would_change() -> None:
    found = identify_actuator(bench())
    f, fit = found.frf.frequency, np.abs(found.fit.responses[0][:, 0, 0])
    magnitude, phase = np.array(actuator_figure(found).axes).reshape(2, 3)
    drawn = [{line.get_label(): line for line in ax.lines} for ax in magnitude]
    ratio = [{k: lines[k].get_ydata() / fit for k in ("half", "twice")} for lines in drawn]
    low, high = f < 0.3, f > 90.0  # 0.0162 kg m^2 and 0.0972 N m s/rad turn at 0.95 Hz
    np.testing.assert_allclose(ratio[0]["half"][high], 1.0, atol=1e-3)
    np.testing.assert_allclose(ratio[0]["twice"][low], 0.5, atol=0.03)
    np.testing.assert_allclose(ratio[1]["half"][high], 2.0, atol=1e-3)
    np.testing.assert_allclose(ratio[1]["twice"][low], 1.0, atol=0.1)
    np.testing.assert_allclose(ratio[2]["twice"], 1.0, atol=1e-9)
    fitted, half, twice = (line.get_ydata()[-1] for line in phase[2].lines[1:])
    assert half - fitted == pytest.approx(360 * 0.0015 * f[-1], rel=0.02)
    assert fitted - twice == pytest.approx(360 * 0.003 * f[-1], rel=0.02)


def test_the_legs_total_inertia() -> None:
    found = identify_leg(leg())
    for name, truth in TOTAL.items():
        np.testing.assert_allclose(getattr(found, name).value, truth, rtol=0.01)
        assert inside(getattr(found, name), truth)
    np.testing.assert_allclose(found.delay.value, 3e-3, rtol=0.01)
    for damping in found.damping:
        np.testing.assert_allclose(damping.value, 0.0972, rtol=0.03)


def test_s3n_full_is_built_without_counting_the_actuator_twice() -> None:
    base = replace(read_model("leg_kin_only"), linkage=None, closed_chain=None)
    base = replace(base, actuators=replace(base.actuators, inertia=(0.1, 0.1), damping=(1.0, 1.0)))
    built = with_leg(with_actuator(base, identify_actuator(bench())), identify_leg(leg()))
    assert built.variant == "s3n_full" and built.linkage is not None
    scale = 0.04793
    for name, truth in (("M11", 0.00967), ("M12", 0.002893), ("M22", 0.00516)):
        assert abs(getattr(built.linkage, name) - truth) < 0.01 * scale
    assert built.actuators.inertia == pytest.approx((0.0162, 0.0162), rel=0.01)


def test_every_drive_has_its_own_numbers() -> None:
    model, found = read_model("leg_kin_only"), identify_actuator(bench())
    heavy = replace(found, inertia=Estimate(0.02, 0.0, "kg m^2"), delay=Estimate(5e-3, 0.0, "s"))
    both = with_actuator(model, found, heavy).actuators
    assert both.inertia == (found.inertia.value, 0.02)
    assert both.delay_s == pytest.approx(4e-3, rel=0.01)
    with pytest.raises(InputError, match="3 drives"):
        with_actuator(model, found, found, found)


def test_links_that_no_body_can_be_are_refused() -> None:
    model = read_model("leg_kin_only")
    fine = np.diag([1e-5, 1e-5, 1e-5]) ** 2
    check_physical(np.array([0.0317, 0.0054, 0.0075]), fine, model)
    with pytest.raises(InputError, match="M22"):
        check_physical(np.array([0.0317, 0.0054, -0.002]), fine, model)
    with pytest.raises(InputError, match="M12"):
        check_physical(np.array([0.0317, 0.02, 0.0075]), fine, model)


def test_an_actuator_that_is_too_heavy_is_noticed() -> None:
    base = read_model("leg_kin_only")
    heavy = replace(base, actuators=replace(base.actuators, inertia=(0.03, 0.03)))
    with pytest.raises(InputError, match="no body has that"):
        with_leg(heavy, identify_leg(leg()))


def test_the_trees_own_share() -> None:
    inertia, gravity = serial_form(read_model("leg_kin_only"))
    np.testing.assert_allclose(inertia, [0.02206, 0.00252, 0.00232], atol=1e-12)
    np.testing.assert_allclose(gravity, [1.68732, 0.141264], atol=1e-9)


def test_the_wrong_machine_is_refused() -> None:
    with pytest.raises(InputError, match="2 axes"):
        identify_actuator(leg())
    with pytest.raises(InputError, match="1 axes"):
        identify_leg(bench())


def test_pages_hold_estimates_fit_residual_and_judgement() -> None:
    found = identify_actuator(bench())
    sheet = actuator_sheet(found)
    assert (
        sheet.tone == "consistent"
        and "delay 3.00" in sheet.sentence
        and "model explains the" in sheet.sentence
    )
    drawing = next(s for s in sheet.sections if s.drawings).drawings[0]
    labels = [row.label for row in drawing.panels[0].rows]
    assert [label.split(" [")[0] for label in labels] == ["magnitude", "phase", "residual"]
    judged = next(s for s in sheet.sections if s.id == "judgement").tables[0]
    assert [row[-1] for row in judged.rows] == ["yes", "yes"]

    of_leg = identify_leg(leg())
    page = leg_sheet(of_leg, with_leg(with_actuator(read_model("leg_kin_only"), found), of_leg))
    rows = {row[0]: row for row in page.sections[0].tables[0].rows}
    assert rows["M11"][1].startswith("0.047") or rows["M11"][1].startswith("0.048")
    assert rows["M22"][2].startswith("0.0162") and rows["M12"][2] == "0 kg m²"
    assert len(next(s for s in page.sections if s.drawings).drawings[0].panels) == 4
