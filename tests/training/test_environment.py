"""One definition of observation, reward, reset and randomisation, on any array library."""

import numpy as np
import pytest
import torch

from workbench.core import EffectKey, Estimate
from workbench.effects import effect_named, load_model
from workbench.models import AppliedEffect
from workbench.training.draws import Draws
from workbench.training.machine import make_machine
from workbench.training.randomisation import LEG_RANDOMISATION, Randomisation, world_fields
from workbench.training.situation import Constants, Situation
from workbench.training.tasks import TASKS, reach_reference

from .make import actions, environment, machine


@pytest.mark.parametrize("task", TASKS)
def test_episodes_begin_run_and_end(task: str) -> None:
    env = environment(task)
    seen, privileged = env.observe()
    assert seen.shape[0] == privileged.shape[0] == 4 and np.isfinite(seen).all()
    env.steps[:] = env.task.episode_steps - 2
    first = env.step(np.zeros((4, env.machine.size)))
    second = env.step(np.zeros((4, env.machine.size)))
    assert not first.ended.any() and second.ended.all() and second.timed_out.all()
    assert not env.steps.any() and set(second.terms) == {r.name for r in env.task.rewards}
    np.testing.assert_allclose(sum(first.terms.values()) * 0.018, first.reward.mean(), rtol=1e-12)


@pytest.mark.parametrize("task", TASKS)
def test_the_terms_are_the_same_lines_in_numpy_and_in_torch(task: str) -> None:
    env = environment(task, noise=False)
    for action in actions(task, 4, 3):
        env.step(action)
    one = env.situation()
    one.fallen = np.array([False, True, False, False])
    like = torch.zeros(1, dtype=torch.float64)
    fields = {
        name: torch.as_tensor(value) if isinstance(value, np.ndarray) else value
        for name, value in vars(one).items()
    }
    other = Situation(**{**fields, "xp": torch, "machine": Constants(env.machine, torch, like)})
    for term in (*env.task.rewards, *env.task.observations, *env.task.privileged):
        np.testing.assert_allclose(
            term.function(other).numpy(), term.function(one), atol=1e-12, err_msg=term.name
        )


def test_a_torque_reaches_the_drives_one_control_step_late() -> None:
    env = environment("reach", noise=False)
    made, commands, asked = env.machine, [], []
    step = env.worlds.step

    def watched() -> None:
        position, velocity = env.worlds.qpos[:, made.places], env.worlds.qvel[:, made.dofs]
        joint = made.kp * (made.posture + 0.1 * 0.5 - position) - made.kd * velocity
        asked.append(joint @ np.linalg.inv(made.transmission))
        commands.append(env.worlds.ctrl.copy())
        step()

    env.worlds.step = watched  # type: ignore[method-assign]
    env.step(np.full((4, 2), 0.1))
    assert not commands[0].any()
    for late, now in zip(commands[1:], asked[:-1], strict=True):
        np.testing.assert_allclose(late, now, atol=1e-12)


def test_a_saved_environment_goes_on_the_same() -> None:
    way = actions("circular", 4, 12)
    one, other = environment("circular"), environment("circular", seed=9)
    other.worlds = environment("circular").worlds  # the drawn worlds are the run's, not the state's
    for action in way[:6]:
        one.step(action)
    other.restore(one.state())
    for action in way[6:]:
        a, b = one.step(action), other.step(action)
    np.testing.assert_array_equal(a.observation, b.observation)
    np.testing.assert_array_equal(a.reward, b.reward)


@pytest.mark.parametrize("name", [name for name, links in LEG_RANDOMISATION.items() if links])
def test_links_are_drawn_within_the_paper_s_table(name: str) -> None:
    made, links = machine("quadruped"), LEG_RANDOMISATION[name]
    assert links is not None
    fields = world_fields(made, Randomisation(legs=name), 400, seed=1)
    shank, trunk, m = made.mujoco.body("rl_shank").id, made.mujoco.body("trunk").id, made.mujoco
    for field, (low, high) in (("body_mass", links.mass), ("body_inertia", links.inertia)):
        ratio = fields[field][:, shank] / getattr(m, field)[shank]
        assert (
            low <= ratio.min() < low + 0.05 * (high - low)
            and high - 0.05 * (high - low) < ratio.max() <= high
        )
    offset = fields["body_ipos"][:, shank] - m.body_ipos[shank]
    assert 0.9 * links.centre < np.abs(offset).max() <= links.centre
    assert np.ptp(fields["body_mass"][:, trunk]) > 1.0
    again = world_fields(made, Randomisation(legs=name), 400, seed=1)
    np.testing.assert_array_equal(fields["body_mass"], again["body_mass"])


def test_what_identification_left_open_differs_by_world() -> None:
    key = EffectKey("viscous_damping", "knee")
    name = effect_named(key.effect).parameters[0].name
    found = AppliedEffect(key, {name: Estimate(0.05, 0.01, "N*m*s/rad")})
    made = make_machine("leg", load_model("leg").with_effect(found), "s3n_full")
    damping = world_fields(made, Randomisation(), 64, seed=0)["tendon_damping"].reshape(64, -1)[:, 0]
    nominal = made.mujoco.tendon_damping.ravel()[0]
    assert 0.006 < damping[:32].std() < 0.014 and abs(damping[:32].mean() - nominal) < 0.01
    assert "tendon_damping" not in world_fields(made, Randomisation(intervals=False), 8, seed=0)


def test_draws_are_even_in_both_libraries() -> None:
    for xp, like in ((np, np.zeros(1)), (torch, torch.zeros(1, dtype=torch.float64))):
        drawn = Draws(xp, 0, like).uniform((-1.0, 2.0), (1.0, 3.0), (4000, 2))
        mean = drawn.mean(0)
        np.testing.assert_allclose(np.asarray(mean), [0.0, 2.5], atol=0.05)
        assert float(drawn[:, 1].min()) >= 2.0 and float(drawn[:, 1].max()) <= 3.0


def test_the_speed_of_a_reach_is_the_derivative_of_its_angle() -> None:
    command = TASKS["reach"].command(Draws(np, 0, np.zeros(1)), 5, machine("leg"))
    step = 1e-6
    ahead, behind = (reach_reference(np, command, np.full(5, 0.7 + s))[0] for s in (step, -step))
    _, speed = reach_reference(np, command, np.full(5, 0.7))
    np.testing.assert_allclose((ahead - behind) / (2 * step), speed, rtol=1e-6)


def test_a_state_is_restored_in_the_library_of_the_worlds() -> None:
    """A checkpoint holds tensors, whatever the worlds compute with."""
    env = environment("circular")
    env.step(actions("circular", 4, 1)[0])
    state = env.state()
    env.restore({**state, **{k: torch.as_tensor(v) for k, v in state.items() if isinstance(v, np.ndarray)}})
    assert all(isinstance(x, np.ndarray) for x in (env.action, env.steps, env.command, *env.waiting))
