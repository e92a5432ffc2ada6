"""PPO of rsl_rl on our environment: tensors in single precision on one device."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from rsl_rl.algorithms import PPO
from rsl_rl.models import MLPModel
from rsl_rl.storage import RolloutStorage
from tensordict import TensorDict

from .environment import Environment, Step
from .settings import Learning

_GROUPS = {"actor": ["policy"], "critic": ["policy", "privileged"]}


class Side:
    """The environment with the interface of rsl_rl.

    Args:
        environment: ours.
        device: of the learner.
    """

    def __init__(self, environment: Environment, device: str) -> None:
        self.environment, self.device = environment, device

    def observe(self) -> TensorDict:
        """Return the groups ``policy`` and ``privileged``, (W, k) each."""
        return self._pack(*self.environment.observe())

    def step(self, action: torch.Tensor) -> tuple[TensorDict, torch.Tensor, torch.Tensor, torch.Tensor, Step]:
        """Return observation, reward (W,), ended (W,), timed out (W,), and the original result of the
        environment.
        """
        numeric = self.environment.xp is np
        step = self.environment.step(action.cpu().numpy().astype(float) if numeric else action)
        packed = self._pack(step.observation, step.privileged)
        reward, ended, late = (self._tensor(x) for x in (step.reward, step.ended, step.timed_out))
        return packed, reward, ended, late, step

    def _pack(self, seen: Any, privileged: Any) -> TensorDict:
        groups = {"policy": self._tensor(seen), "privileged": self._tensor(privileged)}
        return TensorDict(groups, batch_size=[self.environment.count], device=self.device)

    def _tensor(self, x: Any) -> torch.Tensor:
        out = torch.as_tensor(x).to(self.device)
        return out.float() if out.is_floating_point() else out


def make_ppo(
    side: Side, settings: Learning, hidden: tuple[int, ...], distributed: dict[str, int] | None = None
) -> PPO:
    """Return the PPO algorithm with actor and critic, both with running normalisation."""
    seen, n = side.observe(), side.environment.machine.size
    common = {"hidden_dims": list(hidden), "activation": "elu", "obs_normalization": True}
    noise = {"class_name": "GaussianDistribution", "init_std": settings.std, "std_type": "log"}
    actor = MLPModel(seen, _GROUPS, "actor", n, distribution_cfg=noise, **common)
    critic = MLPModel(seen, _GROUPS, "critic", 1, **common)
    count = side.environment.count
    storage = RolloutStorage("rl", count, settings.rollout, seen, [n], side.device)
    return PPO(
        actor,
        critic,
        storage,
        num_learning_epochs=settings.epochs,
        num_mini_batches=settings.batches,
        clip_param=settings.clip,
        gamma=settings.gamma,
        lam=settings.lam,
        value_loss_coef=settings.value_weight,
        entropy_coef=settings.entropy,
        learning_rate=settings.rate,
        max_grad_norm=settings.gradient_norm,
        schedule="adaptive",
        desired_kl=settings.kl,
        device=side.device,
        multi_gpu_cfg=distributed,
    )
