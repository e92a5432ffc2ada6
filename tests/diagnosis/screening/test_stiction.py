"""A hobby servo whose friction grows with its load: weak loops, in which it stands still for a good part."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from tests.simulation.make import having
from workbench.comparison import followed
from workbench.core import Controller, EffectKey, Recording
from workbench.diagnosis.data import gather
from workbench.diagnosis.problem import starting_fit
from workbench.diagnosis.screening.compliance import compliance_candidates
from workbench.diagnosis.screening.screen import screen
from workbench.diagnosis.screening.sensitivity import Linearisation
from workbench.diagnosis.screening.stiction import candidates, has_long_standstill
from workbench.models import Model

_TICK, _FINE = 0.004, 20  # s; steps of the simulation in one
_DAMPING, _WEIGHT = 0.02, 0.48  # N m s/rad, N m
_SERVO = f"""<mujoco><worldbody><body>
<joint name="m" axis="0 -1 0" armature="0.0016" damping="{_DAMPING}"/>
<inertial pos="0 0 -0.1" mass="{_WEIGHT / 0.981}" diaginertia="1e-6 1e-6 1e-6"/>
</body></worldbody></mujoco>"""


def lifted(gain: float, reference: np.ndarray, name: str) -> Recording:
    """The pendulum along a reference (N,), friction of 0.01 N m and 0.3 of the motor's torque in it."""
    q = w = 0.0
    inertia = 0.0016 + _WEIGHT / 9.81 * 0.1 + 1e-6
    rows = []
    for r in reference:
        at = 2 * np.pi / 4096 * np.round(q * 4096 / (2 * np.pi))
        u = gain * (r - at)
        rows.append((at, u, r))
        h = _TICK / _FINE
        for _ in range(_FINE):
            w += h * (u - _DAMPING * w - _WEIGHT * np.sin(q)) / inertia
            w = np.sign(w) * max(abs(w) - h * (0.01 + 0.3 * abs(u)) / inertia, 0.0)
            q += h * w
    names = ("position", "torque_command", "position_reference")
    signals = {n: column[:, None] for n, column in zip(names, np.array(rows).T, strict=True)}
    loop = Controller("pd", "actuator", kp=(gain,), kd=(0.0,), period_s=_TICK)
    time = np.arange(len(reference)) * _TICK
    return Recording(name, ("m",), "actuator", time, signals, ("rad",), controller=loop)


@pytest.fixture
def servo(tmp_path: Path) -> Model:
    (tmp_path / "servo.xml").write_text(_SERVO)
    return wb.load_model(str(tmp_path / "servo.xml"))


@pytest.fixture(scope="module")
def logs() -> list[Recording]:
    t = np.arange(1000) * _TICK
    slow, fast = np.sin(1.6 * t) + 0.7 * np.sin(4.1 * t), 1.2 * np.sin(1.1 * t * t)
    return [lifted(g, r, f"{g:g} {n}") for g in (0.2, 0.4, 0.8) for n, r in (("slow", slow), ("fast", fast))]


def test_friction_is_plain_along_the_motion_and_not_in_the_loop(servo: Model, logs: list[Recording]) -> None:
    data, runs = gather(servo, [*logs[:2], *logs[4:]], logs[2:4], seed=0)
    start = starting_fit(servo, data, runs.clean)
    linearisation = Linearisation.of(servo, data, runs.clean, len(data.recordings))
    in_loop = {c.key.effect: c.test_loss for c in screen(linearisation, data)}
    found = {c.key.effect: c.test_loss for c in candidates(linearisation, start, data, 0)}
    assert in_loop["load_dependent_friction"] > 0.04 * start.test_loss
    assert found["load_dependent_friction"] < 0.01 * start.test_loss
    assert found["viscous_damping"] == in_loop["viscous_damping"], "what is not dry is asked in the loop"


def test_derivatives_of_runs_that_stick_are_differences_of_runs(servo: Model) -> None:
    key = EffectKey("load_dependent_friction", "m")
    sticky = having(servo, key, torque=0.01, ratio=0.3)
    held = np.clip(2.0 * np.sin(1.1 * np.arange(1000) * _TICK), -1.0, 1.0)
    logs = [lifted(0.15, held, "held")]
    for model, has_stiction in ((servo, False), (sticky, True)):
        data, runs = gather(model, logs, (), seed=0)
        assert Linearisation.of(model, data, runs.clean, len(logs)).has_stiction is has_stiction


def test_friction_that_holds_is_read_where_it_slides(servo: Model, logs: list[Recording]) -> None:
    assert has_long_standstill(logs)
    found = wb.diagnose(servo, [*logs[:2], *logs[4:]], logs[2:4])
    assert found.verdict == "missing_effect" and found.findings[0].key.effect == "load_dependent_friction"
    friction = found.findings[0].parameters
    assert friction["torque"].value == pytest.approx(0.01, abs=0.003)
    assert friction["ratio"].value == pytest.approx(0.3, rel=0.05)


def test_a_motion_that_only_turns_round_does_not_stand() -> None:
    t = np.arange(2000) * 0.002
    position = np.sin(5 * t)[:, None]
    assert not has_long_standstill([Recording("r", ("m",), "actuator", t, {"position": position}, ("rad",))])
    position[600:1400] = position[600]
    assert has_long_standstill([Recording("r", ("m",), "actuator", t, {"position": position}, ("rad",))])


def test_what_follows_any_slow_torque_is_no_gap(servo: Model, logs: list[Recording]) -> None:
    """Friction of a slow servo: a state drawn to the torque that passes has nothing to say of a gap."""
    along = followed(logs)
    data, runs = gather(servo, along, (), seed=0)
    made = Linearisation.of(servo, data, runs.clean, len(along))
    assert not [c for c in compliance_candidates(made, 1.0) if c.key.effect == "backlash"]
    soft = having(servo, EffectKey("backlash", "m"), gap=0.05, stiffness=0.4)
    assert not np.isfinite(data.replay.run([soft])[0][0].signals["torque_command"]).any()
    found = wb.diagnose(servo, along[:4], along[4:])
    assert "backlash" not in {f.key.effect for f in found.findings}
