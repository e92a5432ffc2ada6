"""A network learns the lacking torque of each drive; permutation importance says what it goes with.

Inputs are angle, speed, direction and acceleration of all drives (A. Fisher, C. Rudin and F. Dominici, All
models are wrong, but many are useful, JMLR 20, 2019, on the importance). The most important inputs of a drive
are read as the effect that is a plain function of them, with its size by least squares. Needs `pip install
torch`.
"""

from __future__ import annotations

import numpy as np
import torch
from columns import way
from dynamics import regression
from stepwise import estimates, goes_with
from workbench_exam.answers import Answer, Named
from workbench_exam.cases import Case

_LEARNS = 0.1  # of the variance on rows kept back, that a network must explain to speak
_MATTERS = 0.1  # importance: share of variance that is lost where one input is shuffled
#: Input -> effects that are functions of it.
_MEANS = {
    "angle": ("parallel_spring", "cogging", "first_moment_error", "payload_mass", "encoder_offset"),
    "speed": ("viscous_damping", "quadratic_drag"),
    "direction": ("coulomb_friction", "stribeck_friction"),
    "acceleration": ("reflected_inertia", "link_inertia_error"),
}


def solve(case: Case) -> Answer:
    """Names one effect for each input that matters of each drive that lacks something."""
    rows = regression(case)
    m = rows.motion
    driven = np.flatnonzero(case.driven)
    inputs = np.concatenate([m["q"], m["w"], way(m["w"]), m["a"]], axis=1)
    inputs = (inputs - inputs.mean(0)) / (inputs.std(0) + 1e-12)
    n = len(case.drives)
    named: list[Named] = []
    unexplained = False
    for i in driven:
        y = m["lacks"][:, i] / max(float(m["lacks"][:, i].std()), 1e-12)
        if (
            float(m["lacks"][:, i].std()) < 2.0 * m["scale"][i]
            and abs(m["lacks"][:, i].mean()) < m["scale"][i]
        ):
            continue
        if abs(m["lacks"][:, i].mean()) > 3.0 * m["scale"][i] and float(np.std(y)) < 0.3:
            named.append(Named("torque_bias", case.drives[i]))
            continue
        explained, lost = _importance(inputs, y)
        if explained < _LEARNS:
            unexplained = True
            continue
        matter = {name: lost[k * n + i] for k, name in enumerate(_MEANS) if lost[k * n + i] > _MATTERS}
        if not matter:
            unexplained = True
        for name in matter:
            pool = [
                c for c in rows.candidates if c.effect in _MEANS[name] and c.place in (case.drives[i], None)
            ]
            best = goes_with(rows.y, pool)
            if (best.effect, best.place) not in {(each.effect, each.place) for each in named}:
                named += estimates(rows.y, [best])
    verdict = "partly_explained" if named and unexplained else "missing_effect" if named else "consistent"
    return Answer("unexplained" if unexplained and not named else verdict, tuple(named))


def _importance(x: np.ndarray, y: np.ndarray) -> tuple[float, np.ndarray]:
    """Share of variance that is explained on rows kept back, and what shuffling each input costs of it."""
    torch.manual_seed(0)
    torch.set_num_threads(1)
    block = (np.arange(len(y)) // 100) % 4 == 3  # blocks of two seconds
    t = [torch.tensor(v, dtype=torch.float32) for v in (x[~block], y[~block], x[block], y[block])]
    net = torch.nn.Sequential(
        torch.nn.Linear(x.shape[1], 64),
        torch.nn.Tanh(),
        torch.nn.Linear(64, 64),
        torch.nn.Tanh(),
        torch.nn.Linear(64, 1),
    )
    steps = torch.optim.AdamW(net.parameters(), lr=3e-3, weight_decay=1e-3)
    for _ in range(600):
        steps.zero_grad()
        loss = torch.mean((net(t[0])[:, 0] - t[1]) ** 2)
        loss.backward()
        steps.step()
    draw = np.random.default_rng(0)

    def error(inputs: torch.Tensor) -> float:
        with torch.no_grad():
            return float(torch.mean((net(inputs)[:, 0] - t[3]) ** 2)) / float(torch.var(t[3]))

    whole = error(t[2])
    lost = []
    for k in range(x.shape[1]):
        mixed = t[2].clone()
        mixed[:, k] = mixed[draw.permutation(len(mixed)), k]
        lost.append(error(mixed) - whole)
    return 1.0 - whole, np.array(lost)
