"""Where a closed loop hides what is missing, the torque along the measured motion shows it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.diagnosis.rig import asked, recordings
from workbench.core import Controller, EffectKey, Recording
from workbench.diagnosis.moves.restarts import along_the_motion
from workbench.diagnosis.node import Node
from workbench.diagnosis.problem import Problem
from workbench.effects import load_model
from workbench.rigs import HiddenEffect

_CAR, _ROD, _AT, _TURN = 2.8, 0.5, 0.2, 0.007  # kg, kg, m, kg m^2
_KP, _KD, _STEP, _FINE = 1500.0, 90.0, 0.002, 20
_MJCF = f"""<mujoco><worldbody><body name="car">
<joint name="rail" type="slide" axis="1 0 0" damping="4"/>
<inertial pos="0 0 0" mass="{_CAR}" diaginertia="0.01 0.01 0.01"/>
<body name="rod"><joint name="pole" type="hinge" axis="0 -1 0" damping="0.004"/>
<inertial pos="0 0 -{_AT}" mass="{_ROD}" diaginertia="{_TURN} {_TURN} 0.0003"/>
</body></body></worldbody></mujoco>"""


def crane(name: str, friction: float, frequencies: tuple[float, ...], seed: int) -> Recording:
    """A car under PD and a rod that swings freely from it, dry friction in its hinge."""
    generator = np.random.default_rng(seed)
    t = np.arange(3000) * _STEP
    phases = generator.uniform(0.0, 2.0 * np.pi, len(frequencies))
    waves = 2.0 * np.pi * np.outer(t, frequencies) + phases
    reference = np.minimum(t / 1.0, 1.0) ** 2 * 0.02 * np.sin(waves).sum(axis=1)
    state, rows = np.zeros(4), []
    for now in reference:
        seen = state[:2] + 5e-5 * generator.standard_normal(2)
        rate = state[2:] + 5e-3 * generator.standard_normal(2)
        force = _KP * (now - seen[0]) - _KD * rate[0]
        rows.append((*seen, *rate, force))
        for _ in range(_FINE):
            half = state + 0.5 * _STEP / _FINE * _slope(state, force, friction)
            state = state + _STEP / _FINE * _slope(half, force, friction)
    table = np.array(rows)
    push = np.stack([table[:, 4], np.zeros(len(t))], axis=1)
    signals = {
        "position": table[:, :2], "velocity": table[:, 2:4], "torque_command": push,
        "torque_measured": push + np.array([0.05, 0.005]) * generator.standard_normal(push.shape),
        "position_reference": np.stack([reference, np.zeros(len(t))], axis=1),
        "velocity_reference": np.zeros((len(t), 2)),
    }  # fmt: skip
    loop = Controller("pd", "actuator", kp=(_KP, 0.0), kd=(_KD, 0.0), period_s=_STEP)
    return Recording(name, ("rail", "pole"), "actuator", t, signals, ("m", "rad"), controller=loop)


def _slope(state: np.ndarray, force: float, friction: float) -> np.ndarray:
    _, angle, speed, rate = state
    coupling = _ROD * _AT * np.cos(angle)
    mass = np.array([[_CAR + _ROD, coupling], [coupling, _TURN + _ROD * _AT**2]])
    # the hinge turns about -y: a positive angle swings the rod towards +x
    drag = 0.004 * rate + friction * np.tanh(rate / 1e-3)
    weight = 9.81 * _ROD * _AT * np.sin(angle)
    flung = _ROD * _AT * np.sin(angle) * rate**2
    push = np.array([force - 4.0 * speed + flung, -drag - weight])
    return np.concatenate([state[2:], np.linalg.solve(mass, push)])


def problem(folder: Path, friction: float) -> Problem:
    """What is asked of a crane whose model has no dry friction."""
    (folder / "crane.xml").write_text(_MJCF)
    model = load_model(str(folder / "crane.xml"))
    training = [crane("one", friction, (0.4, 0.9, 1.6), 1), crane("two", friction, (0.6, 1.1, 2.3), 2)]
    return asked(model, training, [crane("judge", friction, (0.5, 1.0, 1.9), 3)])


def begun(asked: Problem) -> list[Node]:
    """What the move proposes."""
    return list(along_the_motion(Node(asked.start, asked.data), asked))


def test_friction_of_a_hinge_that_nothing_drives(tmp_path: Path) -> None:
    lacking = problem(tmp_path, 0.01)
    (node,) = begun(lacking)
    assert [s.added for s in node.steps] == [EffectKey("coulomb_friction", "pole")]
    (found,) = node.current.hypothesis.free
    assert found.values["torque"] == pytest.approx(0.01, rel=0.05)
    # fitted in the loop, and judged there
    assert node.current.test_loss < 0.05 * lacking.start.test_loss


def test_nothing_is_asked_of_motion_that_lacks_nothing(tmp_path: Path) -> None:
    assert not begun(problem(tmp_path, 0.0))


def test_a_machine_that_its_loops_hold_is_not_asked() -> None:
    """Its closed loops show the same, and this would be a second search."""
    sticking = HiddenEffect("coulomb_friction", "knee", parameters={"torque": 0.4})
    training, _ = recordings(sticking)

    def told(text: str) -> None:
        raise AssertionError(text)

    held = replace(asked(load_model("leg"), training), progress=told)
    assert not begun(held)
    loose = replace(training[0], controller=replace(training[0].controller, kp=(50.0, 0.0)))
    with pytest.raises(AssertionError, match="measured motion"):
        begun(replace(held, data=replace(held.data, recordings=(loose,))))
