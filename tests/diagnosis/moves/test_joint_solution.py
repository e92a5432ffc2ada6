"""What is certain of slides although something else is missing: solved for all axes along the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import FAST, SLOW, bench_arm, logged
from tests.diagnosis.moves.test_shared_effects import gantry, played
from tests.diagnosis.rig import applied, asked
from workbench.core import Controller, Diagnosis, EffectKey, Recording
from workbench.diagnosis import diagnose, improve
from workbench.diagnosis.hypothesis import Hypothesis
from workbench.diagnosis.moves.joint_fit import like_others
from workbench.diagnosis.moves.joint_solution import confirmed
from workbench.diagnosis.screening.selection import selection_of
from workbench.diagnosis.screening.stepwise_regression import selected
from workbench.effects import load_model

_LOOP_UNKNOWN = Controller()


def recorded(
    coulomb: Sequence[float], damping: Sequence[float], hum: np.ndarray, *, loop: bool = True
) -> list[Recording]:
    runs = [played(f"r{k}", k, coulomb, damping, hum) for k in range(3)]
    return runs if loop else [replace(r, controller=_LOOP_UNKNOWN) for r in runs]


def diagnosed(coulomb: Sequence[float], hum: np.ndarray, *, loop: bool = True) -> Diagnosis:
    runs = recorded(coulomb, [0.0] * len(coulomb), hum, loop=loop)
    return diagnose(gantry(len(coulomb)), runs[:2], runs[2:])


@pytest.mark.parametrize("loop", [True, False], ids=["loop known", "loop unknown"])
def test_friction_is_certain_though_a_hum_stays_on_all_axes(loop: bool) -> None:
    true = {"x": 1.5, "y": 0.8, "z": 0.4}
    told = diagnosed(tuple(true.values()), 0.5 * np.array([1.5, 0.8, 0.4]), loop=loop)
    assert told.verdict == "partly_explained"
    assert {str(f.key) for f in told.findings} == {f"coulomb_friction@{a}" for a in true}
    for finding in told.findings:
        torque = finding.parameters["torque"]
        assert torque.value == pytest.approx(true[str(finding.key.axis)], rel=0.1)
    assert 0.05 < told.unexplained_fraction < 0.5


def test_a_larger_stranger_on_one_axis_takes_nothing_elsewhere() -> None:
    told = diagnosed((1.5, 0.8, 0.4, 0.2), np.array([0.0, 0.0, 0.0, 2.0]))
    assert told.verdict == "partly_explained"
    assert {f"coulomb_friction@{a}" for a in "xyz"} <= {str(f.key) for f in told.findings}
    assert {f.key.effect for f in told.findings} == {"coulomb_friction"}
    assert told.where[0].axis == "u"


def test_a_hum_alone_has_no_name() -> None:
    told = diagnosed((0.0, 0.0, 0.0), np.array([1.5, 0.8, 0.4]))
    assert (told.verdict, told.findings) == ("unexplained", ())


def test_friction_and_damping_are_solved_together_and_once() -> None:
    coulomb, damping = (1.5, 0.8, 0.4, 0.2), (6.0, 3.0, 1.5, 0.8)
    runs = recorded(coulomb, damping, np.array([0.3, 0.1, 0.0, 0.0]), loop=False)
    result, better = improve(gantry(4), runs[:2], runs[2:])
    values = {str(s.key): next(iter(s.parameters.values())).value for s in result.steps}
    for axis, torque, rate in zip("xyzu", coulomb, damping, strict=True):
        assert values[f"coulomb_friction@{axis}"] == pytest.approx(torque, rel=0.1)
        assert values[f"viscous_damping@{axis}"] == pytest.approx(rate, rel=0.1)
    assert len(values) == 8
    again, _ = improve(better, runs[:2], runs[2:])
    assert again.steps == ()


def test_what_moves_the_machine_otherwise_is_left_out() -> None:
    model, runs = gantry(2), recorded((1.5, 0.8), (0.0, 0.0), np.zeros(2))
    problem = asked(model, runs[:2], runs[2:])
    friction = [
        applied(model, EffectKey("coulomb_friction", axis), torque=size)
        for axis, size in (("x", 1.4), ("y", 0.85))
    ]
    spring = applied(model, EffectKey("parallel_spring", "y"), stiffness=400.0, rest=0.0)
    both = Hypothesis(model, tuple(friction))
    assert confirmed(both, problem, certain=True) is both
    with_spring = replace(both, free=(friction[0], spring, friction[1]))
    assert confirmed(with_spring, problem, certain=True).free == both.free


def test_of_what_explains_the_torque_only_what_helps_stays() -> None:
    """What is certain by itself stays as long as all of it together lowers the error."""
    model, runs = gantry(2), recorded((1.5, 0.8), (0.0, 0.0), np.zeros(2))
    problem = asked(model, runs[:2], runs[2:])
    friction = tuple(
        applied(model, EffectKey("coulomb_friction", axis), torque=size)
        for axis, size in (("x", 1.5), ("y", 0.8))
    )
    weak = applied(model, EffectKey("parallel_spring", "y"), stiffness=3.0, rest=0.0)
    all_three = Hypothesis(model, (friction[0], weak, friction[1]))
    assert confirmed(all_three, problem, certain=True) is all_three
    assert confirmed(all_three, problem, certain=False).free == friction


def test_a_body_at_a_link_s_centre_is_not_told_from_its_mass(tmp_path: Path) -> None:
    """So it is not certain beside something unknown."""
    file = bench_arm(tmp_path, fore_centre=0.3)  # where the payload sits
    model = load_model(bench_arm(tmp_path, "model", fore_centre=0.3, fore_mass=1.0))
    logs = [logged(file, tones, seconds=4.0, seed=k) for k, tones in enumerate((SLOW, FAST))]
    inverse_dynamics = asked(model, logs, ()).inverse_dynamics
    assert inverse_dynamics is not None
    (*_, regression) = inverse_dynamics
    (entry, _) = [e for e in regression.entries if e.key.effect == "payload_mass"]  # the point comes first
    assert like_others(regression, selection_of((entry,), regression)) == {entry.key}


@pytest.mark.parametrize("friction", [0.0, 3.0])
def test_torque_constants_of_drives_of_one_make_are_several(friction: float, tmp_path: Path) -> None:
    """All give 0.85 of what is measured: no masses, rotors and frictions of all axes stand for it."""

    def resisting(_: np.ndarray, speed: np.ndarray) -> np.ndarray:
        return -friction * np.array([0.0, 1.0, 0.0]) * np.tanh(speed / 0.002)

    machine, model = bench_arm(tmp_path), load_model(bench_arm(tmp_path, "model"))
    logs = [
        logged(machine, tones, seconds=4.0, seed=k, resisting=resisting)
        for k, tones in enumerate((SLOW, FAST))
    ]
    scaled = [
        replace(r, signals=r.signals | {"torque_measured": r.signals["torque_measured"] / 0.85}) for r in logs
    ]
    inverse_dynamics = asked(model, scaled, ()).inverse_dynamics
    assert inverse_dynamics is not None
    (*_, regression) = inverse_dynamics
    chosen = {(e.key.effect, e.key.axis) for e in selected(regression).chosen}
    assert {("torque_constant_error", axis) for axis in model.axes} <= chosen
    others = {(effect, axis) for effect, axis in chosen if effect != "torque_constant_error"}
    assert {axis for _, axis in others} == ({"lift"} if friction else set())


@pytest.mark.parametrize(
    ("size", "seconds", "verdict"), [(0.1, 10.0, "missing_effect"), (0.4, 6.0, "partly_explained")]
)
def test_certain_effects_keep_their_names_beside_a_ripple(
    size: float, seconds: float, verdict: str, tmp_path: Path
) -> None:
    """Friction on all axes and cogging, each found, beside a torque of the position that no effect has.

    What stays follows the position of one axis. That once took the names off all of them, or let the search
    look for bold pairs and merge them for a quarter of an hour. A bias that comes near to it has no name.
    """
    dry = np.array([0.5, 0.9, 0.4])

    def resisting(q: np.ndarray, w: np.ndarray) -> np.ndarray:
        out = -dry * np.tanh(w / 0.01)
        out[1] += size * np.tanh((q[1] - 0.1) / 0.1)
        out[2] += 0.15 * np.sin(12.0 * q[2] + 0.5)
        return out

    machine = bench_arm(tmp_path)
    logs = [
        logged(machine, tones, resisting=resisting, seconds=seconds, seed=k)
        for k, tones in enumerate((SLOW, FAST))
    ]
    result = diagnose(load_model(machine), logs)
    assert result.verdict == verdict
    assert {str(f.key) for f in result.findings} == {
        *(f"coulomb_friction@{axis}" for axis in ("yaw", "lift", "bend")), "cogging@bend",
    }  # fmt: skip
    for finding in result.findings:
        true = {"cogging": 0.15}.get(finding.key.effect) or dict(
            zip(("yaw", "lift", "bend"), dry, strict=True)
        )[finding.key.axis]
        assert finding.parameters["torque"].value == pytest.approx(true, rel=0.02)
    assert result.work < 1e8  # the search ends by itself


def test_friction_alone_is_named_in_a_log_slower_than_its_loop(tmp_path: Path) -> None:
    """A reference that stands still between rows once looked like damping and a rotor on every axis."""
    dry, machine = np.array([0.5, 0.9, 0.4]), bench_arm(tmp_path)

    def resisting(q: np.ndarray, w: np.ndarray) -> np.ndarray:
        return -dry * np.tanh(w / 0.01)

    log = logged(machine, FAST, resisting=resisting, seconds=8.0, log_s=0.004, loop_s=0.002)
    found = {str(f.key): f.parameters["torque"].value for f in diagnose(load_model(machine), log).findings}
    names = (f"coulomb_friction@{axis}" for axis in ("yaw", "lift", "bend"))
    assert found == {name: pytest.approx(size, rel=0.02) for name, size in zip(names, dry, strict=True)}
