from __future__ import annotations

from workbench import load_model
from workbench.core import EffectKey, Estimate
from workbench.models import AppliedEffect, Model
from workbench.ui.history import History


def with_friction(model: Model, torque: float) -> Model:
    friction = AppliedEffect(EffectKey("coulomb_friction", "knee"), {"torque": Estimate(torque, 0, "N*m")})
    return model.with_effect(friction)


def test_back_and_forth() -> None:
    given = load_model("leg")
    history = History(given)
    assert history.before is None and history.after is None and not history.changed
    history.change("a", with_friction(given, 0.1))
    history.change("b", with_friction(given, 0.2))
    history.undo()
    assert history.current.effects[-1].values == {"torque": 0.1}
    assert (history.before, history.after) == ("a", "b")
    history.undo()
    history.undo()
    assert history.current is given and not history.changed
    history.redo()
    history.redo()
    history.redo()
    assert history.current.effects[-1].values == {"torque": 0.2}


def test_a_change_forgets_what_was_undone() -> None:
    given = load_model("leg")
    history = History(given)
    history.change("a", with_friction(given, 0.1))
    history.undo()
    history.change("b", with_friction(given, 0.3))
    assert history.after is None and history.current.effects[-1].values == {"torque": 0.3}


def test_moves_of_a_slider_are_one_step_until_it_is_let_go() -> None:
    given = load_model("leg")
    history = History(given)
    history.change("add", with_friction(given, 0.1))
    for torque in (0.2, 0.3, 0.4):
        history.change("torque", with_friction(given, torque), knob="torque")
    assert len(history.steps) == 2
    history.settle()
    history.change("torque", with_friction(given, 0.5), knob="torque")
    assert len(history.steps) == 3
    history.undo()
    assert history.current.effects[-1].values == {"torque": 0.4}
    history.undo()
    assert history.current.effects[-1].values == {"torque": 0.1}
