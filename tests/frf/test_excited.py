"""Which lines were excited: found from the spectrum, where distortion and noise stand on the others."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from two_mass_fit import fit_two_mass, two_mass_numbers

from workbench.core import Excitation, InputError, Recording
from workbench.frf import estimate, find_resonances, lines_of
from workbench.recordings import load_recording, save_recording

from ..data_helpers import data_folder
from .make import RATE, recording, siso_loop, truth

ROWS, PERIODS = 1000, 10  # two seconds a period
LINES = {
    "every_2": np.arange(6, 200, 2),
    "every_4": np.arange(9, 200, 4),
    "a list": np.array([3, 7, 8, 20, 21, 50, 90, 91, 140, 199]),
    "full": np.arange(4, 200),
    "few a decade": np.unique(np.geomspace(4, 200, 18).astype(int)),
}


def played(
    lines: np.ndarray, *, bend: float = 0.0, noise: float = 0.0, shape: float = 0.0, stated: object = None
) -> Recording:
    """A plant behind a drive that bends its command by `bend`; amplitudes fall with k**shape."""
    generator = np.random.default_rng(1)
    angle = 2 * np.pi * np.outer(np.arange(ROWS) / ROWS, lines) + generator.uniform(0, 2 * np.pi, len(lines))
    command = np.tile(np.cos(angle) @ (lines / lines[0]) ** -shape, PERIODS + 1)
    size = command.std()
    drive = command + bend * size * ((command / size) ** 2 + 0.5 * (command / size) ** 3)
    _, y = siso_loop(drive, noise * size * generator.normal(size=len(drive)), 0.0)
    seen = drive + noise * size * generator.normal(size=len(drive))
    said = Excitation("multisine", period_s=ROWS / RATE, lines=stated)  # type: ignore[arg-type]
    return recording(y, seen, excitation=said)


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize(("bend", "noise"), [(0.0, 0.0), (0.03, 0.0), (0.0, 0.1), (0.03, 0.02)])
def test_lines_are_found_in_a_measured_input(name: str, bend: float, noise: float) -> None:
    lines = LINES[name]
    assert lines_of(played(lines, bend=bend, noise=noise)).tolist() == lines.tolist()


@pytest.mark.parametrize("shape", [0.5, 1.0, 2.0])
def test_small_lines_of_a_falling_excitation_stay(shape: float) -> None:
    lines = np.arange(9, 70, 4)
    assert lines_of(played(lines, bend=0.01, shape=shape)).tolist() == lines.tolist()


def test_distortion_taken_for_excitation_would_show() -> None:
    lines = LINES["every_4"]
    r = played(lines, bend=0.03, noise=0.002)
    right = estimate([r])
    assert np.abs(right.response[:, 0, 0] / truth(right.frequency) - 1).max() < 0.05
    silent = played(lines, bend=0.0, noise=0.002)
    wrong = estimate([silent], lines=range(9, 198))
    assert np.abs(wrong.response[:, 0, 0] / truth(wrong.frequency) - 1).max() > 0.3


def test_one_sharp_top_of_the_input_does_not_hide_the_rest() -> None:
    r = played(LINES["full"])
    angle = 2 * np.pi * 50 * np.arange(len(r)) / ROWS
    lifted = r.signals["torque_measured"] + 30.0 * np.cos(angle)[:, None]
    assert len(lines_of(r.with_signals(torque_measured=lifted))) > 100


def test_the_command_says_it_where_there_is_one() -> None:
    """Distortion as large as the excitation: the input alone cannot tell, a logged command can."""
    lines = LINES["every_4"]
    r = played(lines, bend=0.6)
    assert len(lines_of(r)) > len(lines)
    clean = played(lines).signals["torque_measured"]
    both = r.with_signals(torque_command=clean)
    assert estimate([both], input="torque_measured").frequency == pytest.approx(lines * RATE / ROWS)


@pytest.mark.parametrize("name", ["every_2", "every_4", "a list"])
def test_a_recording_may_say_it(name: str, tmp_path: Path) -> None:
    """Distortion as large as the excitation again, and a file that says which lines were excited."""
    lines = LINES[name]
    stated = tuple(lines.tolist()) if name == "a list" else name
    made = played(lines, bend=0.6, stated=stated)
    save_recording(made, tmp_path / "made.toml")
    read = load_recording(tmp_path / "made.toml")
    assert read.excitation.lines == stated
    found = lines_of(read)
    if name == "a list":
        assert found.tolist() == lines.tolist()
    else:
        assert set(lines) <= set(found) and len(set(found % int(name[-1]))) == 1


@pytest.mark.parametrize("wrong", ["every4", "every_0", [], [0, 3], [2.5], ["odd"], 4])
def test_other_words_are_refused_in_one_line(wrong: object, tmp_path: Path) -> None:
    save_recording(played(LINES["every_4"]), tmp_path / "made.toml")
    text = (tmp_path / "made.toml").read_text()
    line = tomli_w.dumps({"lines": wrong}).replace("\n", "")
    (tmp_path / "made.toml").write_text(text.replace("[excitation]", f"[excitation]\n{line}"))
    with pytest.raises(InputError, match=r"excitation\.lines.*'every_N'.*list of line numbers") as caught:
        load_recording(tmp_path / "made.toml")
    assert "\n" not in str(caught.value)


def test_lines_above_half_the_rate_are_refused(tmp_path: Path) -> None:
    r = played(LINES["every_4"], stated=(3, 700))
    with pytest.raises(InputError, match=r"excitation\.lines.*between 1 and 499"):
        lines_of(r)
    save_recording(r, tmp_path / "made.toml")
    with pytest.raises(InputError, match=r"too low.*excitation\.lines"):
        load_recording(tmp_path / "made.toml")


def test_a_grid_without_a_line_is_refused() -> None:
    r = played(LINES["every_2"])
    with pytest.raises(InputError, match=r"on the lines that it states \(odd\)"):
        lines_of(replace(r, excitation=replace(r.excitation, lines="odd")))


@pytest.mark.parametrize("commanded", [True, False])
@pytest.mark.parametrize("band", [{}, {"f_min_hz": 11.0, "f_max_hz": 250.0}])
def test_every_fourth_line_of_a_measured_machine(band: dict, commanded: bool, tmp_path: Path) -> None:
    """The drive's distortion is a fiftieth of the excitation and repeats: silent lines are silent."""
    table = data_folder("two_mass") / "MultisineTypeB.mat"
    columns: dict = {"time": {"column": "time", "scale": 1e-6}, "position": "theta_mx", "current": "iq_adx"}
    columns |= {"torque_command": "iq_refx"} if commanded else {}
    content = {"format": 1, "name": "b", "table": str(table.resolve()), "axes": ["motor"], "columns": columns}
    content["excitation"] = {"kind": "multisine", "period_s": 1.0, **band}
    (tmp_path / "b.toml").write_text(tomli_w.dumps(content))
    frf = estimate([load_recording(tmp_path / "b.toml")], input="current", output="position")
    assert frf.frequency == pytest.approx(np.arange(13.0, 250.0, 4.0))
    dip, top = find_resonances(frf)
    assert (dip.kind, top.kind) == ("antiresonance", "resonance")
    assert dip.frequency.value == pytest.approx(54.3, abs=0.5)
    assert top.frequency.value == pytest.approx(76.4, abs=0.3)
    assert two_mass_numbers(fit_two_mass(frf))["resonance_hz"].value == pytest.approx(76.4, abs=0.5)
