"""Bounds of every parameter of every effect hold, from a file and from the command line alike."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from tests.cli.here import run
from workbench.core import EffectKey, Estimate, InputError
from workbench.effects import EFFECTS, Parameter, check_effect, load_model, model_value, places
from workbench.models import AppliedEffect, Placement

LEG = load_model("leg")
PLACES = {key.effect: key for key in reversed(places(LEG))}
ASKED = [(e, p) for e in EFFECTS if e.name in PLACES for p in e.parameters]


def inside(parameter: Parameter) -> float:
    """A value that a body can have."""
    low, high = parameter.lower, parameter.upper
    if math.isfinite(low) and math.isfinite(high):
        return 0.5 * (low + high)
    return low + 0.5 if math.isfinite(low) else min(0.01, high)


def applied(key: EffectKey, **changed: float) -> AppliedEffect:
    effect = next(e for e in EFFECTS if e.name == key.effect)
    values = {p.name: inside(p) for p in effect.parameters} | changed
    if "static" in values and "static" not in changed:
        values["static"] = 2.0 * values["coulomb"]
    return AppliedEffect(key, {name: Estimate(value, 0.0, "") for name, value in values.items()})


@pytest.mark.parametrize(("effect", "parameter"), ASKED, ids=[f"{e.name} {p.name}" for e, p in ASKED])
def test_a_value_that_no_body_can_have_is_refused(effect, parameter) -> None:
    key = PLACES[effect.name]
    check_effect(LEG, applied(key))
    beyond = [math.nan, math.inf, -math.inf]
    if math.isfinite(parameter.upper):
        beyond.append(parameter.upper + 1.0)
    own = model_value(effect, LEG, Placement.of(LEG, key), {})
    lower = parameter.lower if own is None or parameter.lower < 0.0 else -own
    if math.isfinite(lower):
        beyond.append(lower - 1.0)
    for value in beyond:
        with pytest.raises(InputError):
            check_effect(LEG, applied(key, **{parameter.name: value}))


@pytest.mark.parametrize("words", ["damping=-1", "damping=nan", "damping=inf", "damping=much", "dampening=1"])
def test_the_command_refuses_in_one_line_and_writes_nothing(words: str, tmp_path: Path) -> None:
    ended = run("add", "leg", "joint_compliance@knee", "stiffness=100", words, "-o", "new.toml", cwd=tmp_path)
    assert ended.returncode == 2 and ended.stderr.startswith("error: ") and not list(tmp_path.iterdir())


def test_a_file_refuses_as_well(tmp_path: Path) -> None:
    file = tmp_path / "new.toml"
    words = ("add", "leg", "joint_compliance@knee", "stiffness=100", "damping=0.5", "-o", file)
    assert run(*words).returncode == 0
    file.write_text(file.read_text().replace("0.5", "-0.5"))
    with pytest.raises(InputError, match=r"damping = -0\.5"):
        load_model(str(file))


def test_a_spring_may_rest_elsewhere_and_friction_lie_below(tmp_path: Path) -> None:
    added = run(
        "add", "leg", "parallel_spring@knee", "stiffness=1", "rest=-0.4", "-o", "new.toml", cwd=tmp_path
    )
    assert added.returncode == 0
    model = tmp_path / "m.xml"
    model.write_text(
        '<mujoco><worldbody><body><joint name="j" frictionloss="0.08"/><geom size="0.1"/></body></worldbody>'
        "</mujoco>"
    )
    words = ("add", "m.xml", "stribeck_friction@j", "coulomb=-0.03", "static=0.08", "speed=0.3")
    assert run(*words, "-o", "less.toml", cwd=tmp_path).returncode == 0
    load_model(str(tmp_path / "less.toml"))
    words = ("add", "m.xml", "stribeck_friction@j", "coulomb=-0.09", "static=0.08", "speed=0.3")
    assert run(*words, "-o", "none.toml", cwd=tmp_path).returncode == 2
