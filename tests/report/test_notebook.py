from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure

from workbench import compare, inspect, load_model
from workbench.core import Check, Recording, Recordings, Verification
from workbench.gait import Gait, Interval, Measure

from .browser import NASTY, Page


def test_results_say_their_verdict_and_numbers(comparison, diagnosis) -> None:
    words = Page(comparison._repr_html_()).text
    assert "The model does not explain the data" in words and "chirp_hip" in words and "mrad" in words
    words = Page(diagnosis._repr_html_()).text
    assert "0.254 ± 0.003 N m" in words and "97 %" in words and "Coulomb friction at the knee joint" in words
    words = Page(comparison.recordings[0].recording._repr_html_()).text
    assert "12.0 s at 500 Hz" in words and "torque measured" in words


def test_strangers_strings_stay_strings(comparison) -> None:
    recording = replace(comparison.recordings[0].recording, name=NASTY, axes=(NASTY, "knee"))
    model = replace(load_model("leg"), name=NASTY)
    for value in (
        recording,
        replace(comparison, recordings=(replace(comparison.recordings[0], recording=recording),)),
        model,
    ):
        assert "script" not in {tag for tag, _ in Page(value._repr_html_()).tags}
        assert "img" not in {tag for tag, _ in Page(value._repr_html_()).tags}
    assert isinstance(recording.plot(), Figure)


def test_each_has_a_picture(comparison, diagnosis) -> None:
    figure = comparison.plot()
    assert figure.axes[0].get_ylabel() == "position [rad]"
    assert comparison.plot(axis="hip", recording=1).axes
    assert diagnosis.plot().axes[0].get_xscale() == "log"
    assert len(comparison.recordings[0].recording.plot().axes) == 4


def test_parts_of_results_have_the_picture_that_says_most(comparison, diagnosis, improvement) -> None:
    entry, finding, step = comparison.recordings[0], diagnosis.findings[0], improvement.steps[0]
    quiet = replace(entry, position_rmse=np.array([1.0, 5.0]), torque_rmse=np.array([1.0, 1.0]))
    quiet = replace(quiet, position_noise=np.ones(2), torque_noise=np.full(2, np.nan))
    assert "knee" in _head(quiet.plot()) and "hip" in _head(quiet.plot(axis="hip"))
    for value in (finding, step):
        labels = [ax.get_ylabel() for ax in value.plot().axes]
        assert labels == ["torque [N m]", "error"] and "Coulomb friction" in _head(value.plot())
    [bar] = finding.plot().axes[0].containers
    assert bar.lines[0].get_xdata()[0] == finding.parameters["torque"].value
    corrected = replace(finding, number="dry friction", model_value=0.1, total=finding.parameters["torque"])
    assert len(corrected.plot().axes[1].containers) == 2, "the corrected number, and the model's"


def test_a_verification_and_a_gait_have_pictures() -> None:
    checks = Check("mass_matrix", 2e-9, 1e-8), Check("frf", 3.0, 1.0), Check("jacobian", 0.0, 0.0)
    axes = Verification("leg $1", checks).plot().axes[0]
    assert list(axes.collections[0].get_offsets()[:, 0]) == pytest.approx([0.2, 3.0, 1e-8])
    assert len({tuple(c) for c in axes.collections[0].get_facecolors()}) == 2, "what failed stands out"
    gap, wide = Interval(1.0, 0.5, 1.5), Interval(0.2, -np.inf, np.inf)
    gait = Gait("a", "b", "c", (0.3, 0.0), (Measure("stride frequency", "%", gap, wide),), ())
    assert gait.plot().axes[0].get_ylabel() == "stride frequency [%]"
    assert [t.get_text() for t in gait.plot().legends[0].texts] == ["gap (95 %)", "hardware again"]


def _head(figure: Figure) -> str:
    return figure.legends[0].get_title().get_text()


def test_a_model_shows_its_drives_effects_and_links() -> None:
    model = load_model("leg")
    words = Page(model._repr_html_()).text
    assert "linkage_inertia" in words and "M11 = 0.00967 kg m²" in words and "hip" in words
    assert "N m s/rad" in words and "*" not in words
    lines = model.plot().axes[0].lines
    assert len(lines) == 2, "thigh and shank"


def test_numbers_of_a_model_s_picture_stand_apart_and_inside_it() -> None:
    figure = load_model("leg").plot()
    figure.draw_without_rendering()
    axes = figure.axes[0]
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        low, high = sorted(axis.get_view_interval())
        shown = [tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
        boxes = [label.get_window_extent() for label in [*shown, axis.label]]
        assert all(figure.bbox.x0 <= b.x0 and b.x1 <= figure.bbox.x1 and b.y0 >= 0 for b in boxes)
        assert not any(a.overlaps(b) for a, b in pairwise(boxes[:-1]))


def test_a_shell_prints_a_few_lines_and_no_arrays(comparison, diagnosis, improvement) -> None:
    recordings = Recordings(c.recording for c in comparison.recordings)
    model = load_model("leg")
    for value in (comparison, diagnosis, improvement, recordings, recordings[0], model, inspect(recordings)):
        text = repr(value)
        assert "array(" not in text and text.count("\n") < 25
        assert Page(value._repr_html_()).text.startswith(text.splitlines()[0])
        assert isinstance(value.plot(), Figure)
    parts = (comparison.recordings[0], diagnosis.findings[0], improvement.steps[0], recordings[:1])
    for value in parts:
        assert isinstance(value.plot(), Figure)
        text = repr(value)
        assert "array(" not in text and "EffectKey" not in text and text.count("\n") < 10
        assert Page(value._repr_html_()).text.startswith(text.splitlines()[0])
    assert "chirp_hip" in repr(parts[0]) and "97 % probable" in repr(parts[1])
    assert isinstance(recordings[1:], Recordings) and isinstance(recordings[0], Recording)
    assert "Coulomb friction" in repr(improvement) and "0.254 ± 0.003 N m" in repr(diagnosis)


def test_one_recording_needs_no_list(comparison) -> None:
    recording = comparison.recordings[0].recording
    assert [r.recording for r in inspect(recording).recordings] == [recording.name]
    [entry] = compare(load_model("leg"), recording, draws=2).recordings
    assert entry.recording.name == recording.name


def test_a_model_s_lines_have_what_its_file_states(tmp_path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(
        """<mujoco><worldbody><body><joint name="lift" axis="0 1 0" armature="0.087" damping="0.8"
        frictionloss="0.9"/><geom type="capsule" size="0.03" fromto="0 0 0 0 0 0.3"/></body></worldbody>
        </mujoco>"""
    )
    text = repr(load_model(file))
    assert "0.087 kg m²" in text and "0.8 N m s/rad" in text and "0.9 N m" in text and "0 kg m²" not in text
