from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from workbench.core import InputError
from workbench.report import (
    diagnosis_dict,
    ladder_figure,
    overlay_figure,
    residual_figure,
    save_figure,
    shape_figure,
    spectrum_figure,
)
from workbench.report.residuals import binned, min_max, noise_density, spectrum, worst_window

from . import build


def test_residual_against_speed_shows_the_friction(comparison):
    b = binned(comparison, "knee", "torque_measured", "speed")
    assert np.allclose(b.median[b.centre > 1], 0.25, atol=0.01)
    assert np.allclose(b.median[b.centre < -1], -0.25, atol=0.01)
    assert (b.low <= b.median).all() and (b.median <= b.high).all()


def test_spectrum_of_white_noise_lies_on_the_noise_floor(improvement):
    f, a = spectrum(improvement.after, "knee", "torque_measured")
    floor = noise_density(improvement.after, "knee", "torque_measured")
    assert np.isclose(floor, build.NOISE["torque_measured"] / np.sqrt(250.0), rtol=1e-3)
    assert np.isclose(np.median(a[f > 10]), floor, rtol=0.1)


def test_min_max_keeps_every_peak():
    values = np.zeros(100_003)
    values[54_321], values[77] = 9.0, -3.0
    thin, stride = min_max(values, 500)
    assert thin.max() == 9.0 and thin.min() == -3.0 and len(thin) <= 1000
    assert abs(np.argmax(thin) * stride - 54_321) <= 2 * stride
    same, one = min_max(values[:900], 500)
    assert one == 1.0 and len(same) == 900


def test_worst_window_is_where_the_residual_is(comparison):
    entry = comparison.recordings[0]
    start, stop = worst_window(entry, "knee")
    assert 0 <= start < stop <= entry.recording.time[-1]


@pytest.mark.parametrize("make", [overlay_figure, residual_figure, spectrum_figure])
def test_axes_have_units(comparison, improvement, make):
    figure = make(comparison, "knee", after=improvement.after)
    labels = [a.get_ylabel() for a in figure.axes if a.get_ylabel()] + [figure.axes[-1].get_xlabel()]
    assert labels and all("[" in label and "]" in label for label in labels)


def test_runs_differ_by_more_than_colour(comparison, improvement):
    figure = overlay_figure(comparison, "knee", after=improvement.after, window=(1.0, 2.0))
    styles = {(line.get_linestyle(), line.get_linewidth()) for line in figure.axes[0].lines}
    assert len(styles) == len(figure.axes[0].lines) == 3


def test_figures_are_saved_whole_and_reproducibly(tmp_path, improvement):
    for ending, magic in ((".png", b"\x89PNG"), (".svg", b"<?xml")):
        one = save_figure(ladder_figure(improvement), tmp_path / f"a{ending}")
        two = save_figure(ladder_figure(improvement), tmp_path / f"b{ending}")
        assert one.read_bytes().startswith(magic) and one.read_bytes() == two.read_bytes()
    with pytest.raises(InputError, match="the file exists"):
        save_figure(ladder_figure(improvement), tmp_path / "a.png")
    with pytest.raises(InputError, match=r"name it \.png, \.svg or \.pdf"):
        save_figure(ladder_figure(improvement), tmp_path / "a.bmp")


def test_without_torque_only_position_is_drawn(tmp_path, without_torque):
    assert len(overlay_figure(without_torque, "hip").axes) == 2
    save_figure(residual_figure(without_torque, "hip"), tmp_path / "r.png")
    save_figure(spectrum_figure(without_torque, "hip"), tmp_path / "s.png")


def test_an_unknown_axis_is_named(comparison):
    with pytest.raises(InputError, match="no axis 'ankle'"):
        overlay_figure(comparison, "ankle")


def test_a_missing_inertia_shows_against_acceleration(comparison) -> None:
    entry = comparison.recordings[0]
    velocity = entry.simulated.signals["velocity"][:, 1]
    missing = np.zeros_like(entry.recording.position)
    missing[:, 1] = 0.05 * np.gradient(velocity, entry.recording.period)
    torque = entry.simulated.signals["torque_measured"] + missing
    measured = entry.recording.with_signals(torque_measured=torque)
    heavy = replace(comparison, recordings=(replace(entry, recording=measured),))
    against = binned(heavy, "knee", "torque_measured", "acceleration")
    np.testing.assert_allclose(against.median, 0.05 * against.centre, atol=0.05 * np.ptp(against.centre) / 20)
    load = binned(comparison, "knee", "torque_measured", "load")
    assert np.ptp(load.centre) > 1.0


def test_a_shape_is_drawn_with_units_and_named_as_no_cause(tmp_path):
    result = build.unexplained()
    result = replace(result, shapes=result.shapes[:2])
    figure = shape_figure(result)
    axes = [a for a in figure.axes if a.get_visible()]
    assert [a.get_title(loc="left") for a in axes] == ["position: 97 %", "a tone of 3.7 Hz: 61 %"]
    assert [a.get_xlabel() for a in axes] == ["position [rad]", "time [s]"]
    assert axes[0].get_ylabel() == "missing torque at hip [N m]" and "not causes" in figure.get_suptitle()
    assert save_figure(figure, tmp_path / "shape.png").stat().st_size > 5000
    told = diagnosis_dict(result)["unexplained"]["shapes"]
    assert [t["frequency_hz"] for t in told] == [None, 3.7] and told[0]["of"] == ["position"]
