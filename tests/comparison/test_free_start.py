"""Springs that are wound up where a log begins: their beginning is fitted, and is no error of the model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from tests.data_helpers import data_folder
from workbench.comparison import compare
from workbench.core import Comparison, Controller, EffectKey, Estimate, Recording
from workbench.effects import load_model
from workbench.models import AppliedEffect, Model
from workbench.recordings import load_recording

MOTOR, LOAD = 0.0048, 0.0047  # kg m^2
STIFFNESS, DAMPING = 545.0, 0.11
RATE = 2500.0


@pytest.fixture(scope="module")
def shaft(tmp_path_factory: pytest.TempPathFactory) -> Model:
    """Both inertias as one, rigid."""
    file = tmp_path_factory.mktemp("shaft") / "shaft.xml"
    file.write_text(
        f"""<mujoco model="shaft"><worldbody><body><joint name="motor" axis="0 0 1" armature="{MOTOR}"/>
<inertial pos="0 0 0" mass="1" diaginertia="{LOAD} {LOAD} {LOAD}"/></body></worldbody></mujoco>"""
    )
    return load_model(str(file))


def soft(model: Model, stiffness: float = STIFFNESS) -> Model:
    """With its coupling."""
    values = {"stiffness": Estimate(stiffness, 0.0, ""), "damping": Estimate(DAMPING, 0.0, "")}
    return model.with_effect(AppliedEffect(EffectKey("joint_compliance", "motor"), values))


def test_a_gap_alone_has_no_beginning_to_fit(shaft: Model) -> None:
    """Along a measured motion, where springs have one."""
    t = np.arange(2000) / RATE
    position = 0.5 * np.sin(2 * np.pi * 3.0 * t)[:, None]
    signals = {"position": position, "velocity": np.gradient(position, t, axis=0)}
    signals["torque_measured"] = (MOTOR + LOAD) * np.gradient(signals["velocity"], t, axis=0)
    log = Recording("log", ("motor",), "actuator", t, signals, ("rad",), Controller("unknown"))
    values = {"gap": Estimate(0.01, 0.0, "rad"), "stiffness": Estimate(STIFFNESS, 0.0, "N*m/rad")}
    gap = shaft.with_effect(AppliedEffect(EffectKey("backlash", "motor"), values))
    assert np.isfinite(compare(gap, [log]).error)


def run(first_s: float, amplitude: float = 0.5) -> Recording:
    """A second of two masses on a spring, shaken from rest, logged from `first_s` on; by an ODE solver."""
    lines = np.arange(13.0, 200.0, 4.0)
    phase = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, len(lines))

    def torque(t: np.ndarray) -> np.ndarray:
        return amplitude * np.cos(2.0 * np.pi * np.multiply.outer(t, lines) + phase).sum(axis=-1)

    def rates(t: float, x: np.ndarray) -> list[float]:
        through = STIFFNESS * (x[0] - x[1]) + DAMPING * (x[2] - x[3])
        return [x[2], x[3], (float(torque(np.array(t))) - through) / MOTOR, through / LOAD]

    t = first_s + np.arange(int(RATE)) / RATE
    x = solve_ivp(rates, (0.0, t[-1]), np.zeros(4), "DOP853", t, rtol=1e-9, atol=1e-12, max_step=2e-3).y
    noise = np.random.default_rng(3)
    # a row's torque is the mean over the step behind it
    between = torque(t[:, None] + (np.arange(8) + 0.5) / (8.0 * RATE)).mean(axis=1)
    return Recording(
        name="shaft",
        axes=("motor",),
        coordinates="actuator",
        time=t - t[0],
        signals={
            "position": (x[0] + 2e-6 * noise.normal(size=len(t)))[:, None],
            "torque_measured": (between + 0.02 * noise.normal(size=len(t)))[:, None],
        },
        units=("rad",),
        controller=Controller("unknown"),
    )


def parts(c: Comparison) -> np.ndarray:
    """What is left of the torque in each tenth of the rows that count, (10,); at the ends none do."""
    (e,) = c.recordings
    name = "torque_measured"
    left = (e.recording.signals[name] - e.simulated.signals[name])[:, 0]
    counted = np.flatnonzero(left)
    return np.array([np.sqrt(np.mean(x**2)) for x in np.array_split(left[counted[0] : counted[-1]], 10)])


@pytest.mark.parametrize("first_s", [0.3, 0.4137, 1.0])
def test_a_right_model_is_at_the_noise_wherever_a_log_begins(shaft: Model, first_s: float) -> None:
    r = run(first_s)
    right = compare(soft(shaft), [r])
    assert right.error < 1.1 * right.noise_error
    left = parts(right)
    assert left[0] < 1.3 * np.median(left)


def test_up_to_where_a_row_is_a_twelfth_of_a_period(shaft: Model) -> None:
    """A drive that holds its torque from row to row: the spring's own torque comes no half row late."""
    first = run(0.3)
    count, skipped = len(first), round(0.3 * RATE)
    through = np.array([[-STIFFNESS, STIFFNESS, -DAMPING, DAMPING]])
    change = np.vstack([np.eye(2, 4, 2), through / MOTOR, -through / LOAD])
    push = np.array([[0.0], [0.0], [1.0 / MOTOR], [0.0]])
    whole = expm(np.block([[change, push], [np.zeros((1, 5))]]) / RATE)
    kept, added = whole[:4, :4], whole[:4, 4]
    noise, lines = np.random.default_rng(4), np.arange(13.0, 200.0, 4.0)
    turn = np.outer(np.arange(skipped + count) / RATE, 2.0 * np.pi * lines)
    torque = 0.5 * np.cos(turn + noise.uniform(0.0, 2.0 * np.pi, len(lines))).sum(axis=1)
    x = np.zeros((len(torque), 4))
    for k in range(len(torque) - 1):
        x[k + 1] = kept @ x[k] + added * torque[k]
    held = first.with_signals(
        position=x[skipped:, :1] + 2e-6 * noise.normal(size=(count, 1)),
        torque_measured=torque[skipped:, None] + 0.02 * noise.normal(size=(count, 1)),
    )
    held = replace(held, excitation=replace(held.excitation, f_max_hz=200.0))
    assert compare(soft(shaft), [held]).consistent


def test_a_wrong_spring_is_not_excused(shaft: Model) -> None:
    """Two numbers of the beginning explain little of what a spring does that is 5 % too stiff."""
    r = run(0.3)
    rigid, wrong = compare(shaft, [r]), compare(soft(shaft, 1.05 * STIFFNESS), [r])
    assert not wrong.consistent and wrong.error > 2.0 * wrong.noise_error
    assert rigid.error > 3.0 * wrong.error
    # and a rigid model has nothing to begin with
    left = parts(rigid)
    assert left[0] > 0.5 * np.median(left)


def test_the_beginning_of_a_measured_machine_is_no_worse(shaft: Model, tmp_path: Path) -> None:
    """Five periods from within a measurement in its steady state: the first tenth was worst by far."""
    table = data_folder("two_mass") / "MultisineTypeB.mat"
    columns = {"time": {"column": "time", "scale": 1e-6}, "position": "theta_mx", "torque_measured": "iq_adx"}
    content = {"format": 1, "name": "b", "table": str(table.resolve()), "axes": ["motor"], "columns": columns}
    content["controller"] = {"kind": "none"}
    (tmp_path / "b.toml").write_text(tomli_w.dumps(content))
    whole = load_recording(tmp_path / "b.toml")
    rows = slice(len(whole) // 4, len(whole) // 2)
    middle = replace(
        whole,
        time=whole.time[rows] - whole.time[rows][0],
        signals={name: x[rows] for name, x in whole.signals.items()},
        valid=whole.valid[rows],
    )
    left = parts(compare(soft(shaft), [middle], draws=2))
    assert left[0] < 1.3 * np.median(left)
