"""What cannot be estimated is refused in one line that says where and what to do."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from workbench.core import Excitation, InputError
from workbench.frf import estimate, find_period

from .make import design, loop_recordings, mimo_plant, mimo_recordings


def one(**changes):
    (r,) = loop_recordings(design(), noise=0.05)
    return replace(r, **changes)


MADE = one()


def refused(recordings, **options) -> InputError:
    with pytest.raises(InputError) as caught:
        estimate(recordings, **options)
    assert caught.value.remedy
    return caught.value


def test_nothing_and_too_little() -> None:
    assert "no recordings" in refused([]).problem
    short = one()
    short = replace(
        short, time=short.time[:900], signals={k: v[:900] for k, v in short.signals.items()}, valid=None
    )
    assert "1 whole period of" in refused([short]).problem
    assert "leave fewer than two" in refused([one()], transient_periods=6).problem


def test_gaps_and_missing_numbers_name_the_row() -> None:
    r = one()
    error = refused([replace(r, valid=np.arange(len(r)) != 1234)])
    assert error.row == 1235 and "masked" in error.problem
    # rows that are not used may be missing
    early = replace(r, valid=np.arange(len(r)) > 20)
    trimmed = replace(early, time=r.time[:3400], signals={k: v[:3400] for k, v in r.signals.items()},
                      valid=early.valid[:3400])  # fmt: skip
    assert estimate([trimmed]).periods >= 5
    hurt = np.array(r.velocity)
    hurt[2000, 0] = np.nan
    error = refused([r.with_signals(velocity=hurt)])
    assert (error.row, error.column) == (2001, "velocity")


@given(row=st.integers(0, 3499), bad=st.sampled_from([np.nan, np.inf, -np.inf]))
@settings(max_examples=25, deadline=None)
def test_a_missing_number_is_named_or_not_used(row, bad) -> None:
    r = MADE
    hurt = np.array(r.signals["torque_measured"])
    hurt[row] = bad
    try:
        frf = estimate([r.with_signals(torque_measured=hurt)], transient_periods=0)
    except InputError as error:
        assert error.row == row + 1 and error.column == "torque_measured"
    else:
        assert np.isfinite(frf.response).all()


def test_signals_axes_and_clocks_that_do_not_fit() -> None:
    r = one()
    assert refused([r], input="torque_command").column == "columns.torque_command"
    assert "not a signal" in refused([r], output="speed").problem
    assert refused([r], axes=["z"]).column == "axes"
    assert refused([r], axes=[]).column == "axes"
    assert refused([r, replace(r, axes=("b",))]).column == "axes"
    assert refused([r, replace(r, time=r.time * 2)]).column == "time"
    assert refused([r, replace(r, excitation=Excitation(period_s=2.0))]).column == "excitation.period_s"
    assert refused([r], period_s=-1.0).column == "period_s"
    assert refused([r], period_s=float("nan")).column == "period_s"
    noise = np.random.default_rng(0).normal(size=(len(r), 1))
    bare = {"position": noise, "velocity": noise, "torque_measured": noise[::-1]}
    assert "no period" in refused([replace(r, signals=bare, excitation=Excitation())]).problem


@pytest.mark.parametrize("lines", [[0], [250], [1000], []])
def test_lines_that_do_not_exist(lines) -> None:
    assert refused([one()], lines=lines).column == "lines"


def test_inputs_that_cannot_be_told_apart() -> None:
    d = design(axes=["a", "b"], f_max_hz=40)
    both = mimo_recordings(d, mimo_plant(2), noise=0.0, gain=0.0)
    assert "1 experiment for 2 inputs" in refused(both[:1]).problem
    assert "not independent" in refused([both[0], both[0]]).problem


@given(
    period=st.floats(20.0, 300.0),
    repeats=st.integers(3, 8),
    noise=st.sampled_from([0.0, 0.01, 0.1]),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=40, deadline=None)
def test_the_period_is_found(period, repeats, noise, seed) -> None:
    generator = np.random.default_rng(seed)
    t = np.arange(int(period * repeats) + 7)
    lines = np.arange(1, max(4, int(period / 6)))
    phase = generator.uniform(0, 2 * np.pi, len(lines))
    # a line in common would make a shorter period true as well
    wave = np.cos(2 * np.pi * np.outer(t, lines) / period + phase).sum(axis=1) / np.sqrt(len(lines))
    found = find_period(wave + noise * generator.normal(size=len(t)))
    assert found is not None
    assert found == pytest.approx(period, abs=0.3 + 2 * noise)


def test_what_does_not_repeat_has_no_period() -> None:
    generator = np.random.default_rng(0)
    assert find_period(generator.normal(size=2000)) is None
    assert find_period(np.zeros(100)) is None
    assert find_period(np.arange(4.0)) is None
    assert find_period(np.linspace(0, 1, 500)) is None
