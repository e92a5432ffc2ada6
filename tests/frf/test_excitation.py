"""Lines, phases, sets of experiments, chirps, and what is refused."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.core import InputError
from workbench.frf import (
    Design,
    chirp,
    crest_factor,
    detection_lines,
    load_design,
    mixing_matrix,
    multisine,
    save_design,
    select_lines,
)

LEG = {"f_min_hz": 0.2, "f_max_hz": 60.0, "period_s": 5.0, "rate_hz": 1000.0}


def test_lines_of_each_grid() -> None:
    assert select_lines(0.2, 2.0, 5.0).tolist() == list(range(1, 11))
    assert select_lines(0.2, 2.0, 5.0, grid="odd").tolist() == [1, 3, 5, 7, 9]
    some = select_lines(0.2, 60.0, 5.0, grid="odd_random", seed=3)
    assert (some % 2 == 1).all()
    silent = np.setdiff1d(np.arange(1, 301, 2), some)
    # one of every four odd lines is silent, at irregular places
    assert np.array_equal(silent // 8, np.arange(37))
    assert len(set(np.diff(silent))) > 2
    odd, even = detection_lines(some)
    assert np.array_equal(odd, silent[(silent > some[0]) & (silent < some[-1])])
    assert (even % 2 == 0).all() and len(even) == 150
    assert [len(x) for x in detection_lines(np.arange(1, 9))] == [0, 0]


def test_quasi_logarithmic_lines_stay_on_the_grid() -> None:
    lines = select_lines(0.2, 60.0, 5.0, grid="odd", per_decade=10)
    assert (lines % 2 == 1).all() and lines[0] == 1 and lines[-1] == 299
    assert 15 <= len(lines) <= 26
    # equally many in either decade of the upper band
    assert abs(np.sum((lines > 30) & (lines <= 95)) - np.sum(lines > 95)) <= 1


@given(
    f_min=st.floats(0.1, 5.0),
    width=st.floats(1.5, 40.0),
    period=st.sampled_from([0.5, 1.0, 2.0, 7.0]),
    grid=st.sampled_from(["full", "odd", "odd_random"]),
    per_decade=st.one_of(st.none(), st.integers(1, 60)),
)
@settings(max_examples=60, deadline=None)
def test_lines_lie_in_their_band(f_min, width, period, grid, per_decade) -> None:
    try:
        lines = select_lines(f_min, f_min * width, period, grid=grid, per_decade=per_decade)
    except InputError as error:
        assert "no " in error.problem
        return
    assert (np.diff(lines) > 0).all()
    frequency = lines / period
    assert frequency[0] >= f_min * (1 - 1e-6) and frequency[-1] <= f_min * width * (1 + 1e-6)
    assert grid == "full" or (lines % 2 == 1).all()


@pytest.mark.parametrize(
    ("phases", "grid", "highest"),
    [
        ("schroeder", "full", 1.75),
        ("schroeder", "odd", 1.75),
        ("low_crest", "full", 1.5),
        ("low_crest", "odd_random", 1.6),
    ],
)
def test_crest_factors(phases, grid, highest) -> None:
    design = multisine(["hip"], **LEG, phases=phases, grid=grid, rms=0.9)
    assert design.crest_factors.max() < highest
    assert np.sqrt(np.mean(design.experiments**2)) == pytest.approx(0.9)
    noisy = multisine(["hip"], **LEG, phases="random", rms=0.9)
    assert noisy.crest_factors.max() > 2.5
    assert crest_factor(np.sin(2 * np.pi * np.arange(64) / 64)) == pytest.approx(np.sqrt(2))


def test_amplitudes_and_phases_are_those_asked_for() -> None:
    design = multisine(["a"], **LEG, rms=2.0, shape=lambda f: 1 / f, phases="random", seed=4)
    amplitude = np.abs(design.spectrum)[0, :, 0]
    assert amplitude * design.frequency == pytest.approx(amplitude[0] * design.frequency[0])
    assert np.sqrt(np.sum(amplitude**2) / 2) == pytest.approx(2.0)
    t = np.arange(5000) / 1000.0
    phase = np.angle(design.spectrum)[0, :, 0]
    rebuilt = np.cos(2 * np.pi * np.outer(t, design.frequency) + phase) @ amplitude
    assert design.experiments[0, :, 0] == pytest.approx(rebuilt, abs=1e-9)
    # nothing on other lines
    spectrum = np.abs(np.fft.rfft(design.experiments[0, :, 0]))
    spectrum[design.lines] = 0
    assert spectrum.max() < 1e-9


def test_sum_and_difference_of_a_pair() -> None:
    design = multisine(["hip", "knee"], **LEG, rms=[0.9, 0.54])
    both = design.experiments / [0.9, 0.54]
    assert both[0, :, 0] == pytest.approx(both[0, :, 1])
    assert both[1, :, 0] == pytest.approx(-both[1, :, 1])
    assert [t.mode for t in design.trials] == ["sum", "difference"]
    said = design.excitation(1)
    assert (said.kind, said.mode, said.period_s, said.lines) == ("multisine", "difference", 5.0, "full")
    assert (said.f_min_hz, said.f_max_hz) == (0.2, 60.0)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 12])
@pytest.mark.parametrize("own_phases", [False, True])
def test_sets_of_experiments_are_orthogonal_on_every_line(n, own_phases) -> None:
    axes = [f"a{i}" for i in range(n)]
    band = {**LEG, "f_max_hz": 8.0}
    design = multisine(axes, **band, phases="random", own_phases=own_phases, realisations=2)
    assert design.experiments.shape == (2 * n, 5000, n)
    for m in range(2):
        u = design.spectrum[m * n : (m + 1) * n]  # experiment, line, input
        gram = np.einsum("efi,efj->fij", u.conj(), u)
        assert gram == pytest.approx(np.broadcast_to(gram[0, 0, 0] * np.eye(n), gram.shape), abs=1e-9)
    assert np.abs(np.angle(design.spectrum)[0] - np.angle(design.spectrum)[n]).max() > 0.1
    assert len({t.name for t in design.trials}) == 2 * n


def test_mixing_matrices() -> None:
    assert mixing_matrix(2).real.tolist() == [[1, 1], [1, -1]]
    for n in (3, 6):
        w = mixing_matrix(n)
        assert w @ w.conj().T == pytest.approx(n * np.eye(n), abs=1e-12)
        assert np.abs(w) == pytest.approx(1.0)
    assert np.isrealobj(mixing_matrix(4).real) and not mixing_matrix(4).imag.any()
    with pytest.raises(InputError, match="Hadamard"):
        mixing_matrix(3, "hadamard")


@pytest.mark.parametrize("sweep", ["linear", "logarithmic"])
def test_chirps_sweep_through_their_band(sweep) -> None:
    design = chirp(
        ["hip", "knee"], f_min_hz=0.5, f_max_hz=25, duration_s=8, rate_hz=1000, amplitude=0.2, sweep=sweep
    )
    wave = design.experiments[0, :, 0]
    assert not design.experiments[0, :, 1].any() and design.experiments[1, :, 1].any()
    assert np.abs(wave).max() == pytest.approx(0.2, rel=1e-3) and wave[0] == 0
    zeros = np.flatnonzero(np.diff(np.sign(wave[1:])) != 0)
    half_cycles = 8 * 25.5 if sweep == "linear" else 2 * 0.5 * 8 / np.log(50) * 49
    assert len(zeros) == pytest.approx(half_cycles, abs=2)
    assert 500 / np.diff(zeros)[-3:].mean() == pytest.approx(25, rel=0.06)
    power = np.abs(np.fft.rfft(wave)) ** 2
    assert power[design.lines].sum() > 0.95 * power.sum()


def test_play_repeats_fades_in_and_holds() -> None:
    design = multisine(["a"], **LEG, driven="position_reference", hold=[0.3], fade_s=1.0, periods=2)
    time, signals = design.play(0)
    q = signals["position_reference"][:, 0]
    assert len(time) == 15_000 and time[1] == pytest.approx(1e-3)
    assert q[0] == pytest.approx(0.3)
    assert q[5000:10_000] == pytest.approx(q[10_000:])
    pushed = multisine(["a"], **LEG, hold=[0.3]).play(0)[1]
    assert set(pushed) == {"torque_feedforward", "position_reference"}
    assert pushed["position_reference"] == pytest.approx(0.3)


def test_a_design_survives_the_disk(tmp_path: Path) -> None:
    design = multisine(
        ["a", "b"], **LEG, driven="position_reference", hold=[0.3, -1.0], fade_s=0.5, grid="odd_random"
    )
    files = save_design(design, tmp_path / "leg.toml")
    assert [f.name for f in files] == ["multisine_sum.csv.gz", "multisine_difference.csv.gz", "leg.toml"]
    again = load_design(tmp_path / "leg.toml")
    for field in vars(Design).get("__dataclass_fields__", {}):
        a, b = getattr(design, field), getattr(again, field)
        assert a == pytest.approx(b, abs=1e-12) if isinstance(a, np.ndarray) else a == b
    with pytest.raises(InputError, match="--force"):
        save_design(design, tmp_path / "leg.toml")
    files[0].unlink()
    with pytest.raises(InputError, match="missing"):
        load_design(tmp_path / "leg.toml")


def test_malformed_designs_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.toml"):
        load_design(tmp_path / "none.toml")
    file = tmp_path / "bad.toml"
    file.write_text("format = 1\nkind = 'sawtooth'\n")
    with pytest.raises(InputError, match=r"bad\.toml, key"):
        load_design(file)
    file.write_text("format = [")
    with pytest.raises(InputError, match="TOML"):
        load_design(file)


@pytest.mark.parametrize("name", ["rate_hz", "period_s"])
@pytest.mark.parametrize("value", ["1e300", "-1.0", "nan", "inf"])
def test_a_rate_or_period_that_no_experiment_has_is_named(tmp_path: Path, name: str, value: str) -> None:
    save_design(multisine(["hip"], **LEG), tmp_path / "leg.toml")
    text = (tmp_path / "leg.toml").read_text()
    spoilt = re.sub(rf"^{name} = .*$", f"{name} = {value}", text, flags=re.MULTILINE)
    (tmp_path / "leg.toml").write_text(spoilt)
    with pytest.raises(InputError, match=rf"leg\.toml, key '{name}'"):
        load_design(tmp_path / "leg.toml")


@pytest.mark.parametrize(
    ("change", "column"),
    [
        ({"rate_hz": 120.0}, "f_max_hz"),
        ({"rate_hz": 0.0}, "rate_hz"),
        ({"rate_hz": float("nan")}, "rate_hz"),
        ({"period_s": 5.0003}, "period_s"),
        ({"period_s": float("inf")}, "period_s"),
        ({"f_min_hz": 0.0}, "f_min_hz"),
        ({"f_min_hz": 70.0}, "f_min_hz"),
        ({"rms": [1.0, 2.0, 3.0]}, "rms"),
        ({"rms": -1.0}, "rms"),
        ({"rms": float("nan")}, "rms"),
        ({"realisations": 2}, "realisations"),
        ({"own_phases": True}, "own_phases"),
        ({"shape": lambda f: f - 10}, "shape"),
        ({"hold": [0.1]}, "experiments"),
        ({"periods": 0}, "periods"),
    ],
)
def test_what_cannot_be_played_is_refused(change, column) -> None:
    with pytest.raises(InputError) as caught:
        multisine(["hip", "knee"], **{**LEG, **change})
    assert caught.value.column == column and caught.value.remedy


ANY = st.floats(allow_nan=True, allow_infinity=True)


@given(f_min=ANY, f_max=ANY, period=ANY, rate=ANY, rms=ANY)
@settings(max_examples=150, deadline=None)
def test_any_numbers_are_played_or_refused(f_min, f_max, period, rate, rms) -> None:
    # a design of a million rows is nobody's mistake, and takes a while
    if np.isfinite([period, rate]).all() and period * rate > 1e6:
        return
    try:
        design = multisine(
            ["a"], f_min_hz=f_min, f_max_hz=f_max, period_s=period, rate_hz=rate, rms=rms, shape=None
        )
    except InputError as error:
        assert error.remedy
        return
    assert np.isfinite(design.experiments).all() and design.frequency[-1] < rate / 2


@pytest.mark.parametrize(
    "change", [{"f_max_hz": 600.0}, {"duration_s": -1.0}, {"amplitude": 0.0}, {"mixing": "dft"}]
)
def test_chirps_that_cannot_be_played_are_refused(change) -> None:
    good = {"f_min_hz": 0.5, "f_max_hz": 25.0, "duration_s": 8.0, "rate_hz": 1000.0}
    with pytest.raises(InputError):
        chirp(["a", "b", "c"], **{**good, **change})
