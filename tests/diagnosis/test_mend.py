"""A number that is stated wrongly is said with its file and line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.bench_arm import bench_arm
from tests.report import build
from workbench.core import Controller, Diagnosis, EffectKey, Estimate, Finding, Recording
from workbench.core.toml_line import toml_line
from workbench.diagnosis.mend import mend_lines, mend_recordings, states_gain, with_mended_gains
from workbench.effects import load_model


@pytest.fixture(scope="module")
def diagnosis() -> Diagnosis:
    made = build.improvement(seconds=1.0, rate=100.0).diagnosis
    assert made
    return made


def found(effect: str, axis: str, number: str = "", value: float | None = None, **values: float) -> Finding:
    parameters = {name: Estimate(v, 0.001, "") for name, v in values.items()}
    key = EffectKey(effect, axis)
    return Finding(key, parameters, 0.02, None, None, 0.9, number=number, model_value=value)


def recording(folder: Path, name: str = "run") -> Recording:
    source = folder / f"{name}.toml"
    source.write_text(
        'format = 1\ntable = "run.csv"\n\n[controller]\nkind = "pd"\nkp = [120, 150, 80]\nkd = [6, 8, 3]\n'
    )
    return Recording(
        name=name, axes=("yaw", "lift", "bend"), coordinates="actuator", time=np.arange(3) / 100.0,
        signals={"position": np.zeros((3, 3))}, units=("rad",) * 3, source=source,
        controller=Controller("pd", kp=(120.0, 150.0, 80.0), kd=(6.0, 8.0, 3.0)),
    )  # fmt: skip


def test_wrong_gains_lead_to_the_line_of_the_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    model = load_model(bench_arm(tmp_path))
    gains = found("controller_gain_error", "lift", kp_scale=0.8, kd_scale=1.0004)
    data = [recording(tmp_path, f"run{k}") for k in range(5)]
    lines = mend_lines(model, data, [gains])
    first = "correct run0.toml, line 6 ([controller]): kp of lift is 150 and should be 120"
    assert lines[0] == first and "kd" not in " ".join(lines)
    assert len(lines) == 4 and "2 more recordings" in lines[-1]


def test_gains_belong_into_the_recordings_that_state_them(tmp_path: Path, diagnosis: Diagnosis) -> None:
    model, data = load_model(bench_arm(tmp_path)), [recording(tmp_path)]
    gains = found("controller_gain_error", "lift", kp_scale=0.8, kd_scale=1.5)
    damping = found("viscous_damping", "lift", "damping", 0.5, damping=0.3)
    assert mend_recordings(model, data, [gains, damping]) == (gains.key,)
    silent = replace(data[0], controller=Controller())
    in_memory = replace(data[0], source=None)
    for none in ([silent], [in_memory], []):
        assert mend_recordings(model, none, [gains]) == (), "no recording's file states the gains"
        assert not states_gain(none, gains.key)
    assert states_gain(data, gains.key) and not states_gain(data, damping.key)
    assert mend_recordings(model, data, [replace(gains, probability=0.3)]) == (), "another cause is likelier"
    told = replace(diagnosis, findings=(gains, damping), mend_recordings=(gains.key,))
    [mended, kept] = with_mended_gains([*data, silent], told)
    assert mended.controller.kp == pytest.approx((120.0, 120.0, 80.0))
    assert mended.controller.kd == pytest.approx((6.0, 12.0, 3.0)) and kept is silent
    cascade = Controller("cascade_pv", kp=(10.0,) * 3, kv=(4.0,) * 3)
    [mended] = with_mended_gains([replace(data[0], controller=cascade)], told)
    assert mended.controller.kv == pytest.approx((4.0, 6.0, 4.0)) and mended.controller.kd == ()


def test_a_wrong_number_of_an_mjcf_leads_to_its_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = bench_arm(tmp_path, lift_damping=0.5)
    model = load_model(file)
    line = 1 + next(k for k, text in enumerate(file.read_text().splitlines()) if 'name="lift"' in text)
    damping = found("viscous_damping", "lift", "damping", 0.5, damping=0.3)
    assert mend_lines(model, [], [damping]) == (
        f"correct arm.xml, line {line}: damping of lift is 0.5 and should be 0.8",
    )
    [unsure] = mend_lines(model, [], [replace(damping, probability=0.72)])
    assert unsure.endswith("damping of lift is 0.5 and should be 0.8 (72 % probable)")
    mass = found("first_moment_error", "lift", "first moment", None, along=0.03 * 2.4, across=0.0)
    [told] = mend_lines(model, [], [mass])
    assert told.startswith(
        f"correct arm.xml, line {line + 1}: centre of the body of lift is (0.17 0 0) and should be (0.2 0 0)"
    )


def test_what_is_nothing_beside_the_largest_number_is_not_told(tmp_path: Path) -> None:
    model = load_model(bench_arm(tmp_path))
    [told] = mend_lines(
        model, [], [found("first_moment_error", "lift", "first moment", None, along=0.072, across=4e-5)]
    )
    assert told.endswith("is (0.17 0 0) and should be (0.2 0 0)")


def test_a_number_of_a_toml_leads_to_its_line() -> None:
    model = load_model("leg")
    k, drive = 1, model.axes[1]
    old = model.actuators.inertia[k]
    wrong = found("reflected_inertia", drive, "rotor inertia", old, inertia=0.25 * old)
    [told] = mend_lines(model, [], [wrong])
    assert model.source is not None
    line = toml_line(model.source.read_text(), "actuators", "inertia")
    assert f"leg.toml, line {line} ([actuators]): inertia of {drive} is" in told
    missing = replace(wrong, number="", model_value=None)
    assert mend_lines(model, [], [missing, found("cogging", drive, torque=0.1)]) == ()


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[controller]\nkp = 1", 2),
        ("kp = 3\n[other]\nkp = 2\n[controller]  # ours\n\n  kp=1", 6),
        ("controller = {kind = 'pd', kp = 3}", 1),
        ("controller.kp = 3", 1),
        ("[controller]\nkp_scale = 1\n[[controller.more]]\nkp = 2", None),
    ],
)
def test_the_line_of_a_key(text: str, line: int | None) -> None:
    assert toml_line(text, "controller", "kp") == line
