"""Step size that MuJoCo needs for stiff springs."""

from __future__ import annotations

import mujoco
import numpy as np

from .chain import TorqueChain
from .ground import contact_rates

_TURN = 0.5  # rad: how far the fastest mode may turn in a step; Runge-Kutta 4 then errs by 3e-4 of it
_MOST = 64  # steps in one of the simulation; what is stiffer still becomes unstable, and is named


def tendon_row(m: mujoco.MjModel, name: str) -> np.ndarray:
    """Return coefficients (nv,) of a fixed tendon: its speed is their product with the joint speeds."""
    ident, row = m.tendon(name).id, np.zeros(m.nv)
    for k in range(m.tendon_adr[ident], m.tendon_adr[ident] + m.tendon_num[ident]):
        row[m.jnt_dofadr[m.wrap_objid[k]]] += m.wrap_prm[k]
    return row


def count_substeps(m: mujoco.MjModel, chain: TorqueChain) -> int:
    """Return the number of steps that the fastest mode of the springs needs in one time step of the model."""
    names = [m.tendon(i).name for i in range(m.ntendon)]
    stiff = [name for name in names if name.partition(":")[0] in _SPRINGS]
    spring, damper = contact_rates(m)
    # what a foot weighs changes with the posture
    touched = np.abs(np.roots([1.0, 2.0 * damper, 2.0 * spring])).max()
    if not stiff:
        return _steps(float(touched), m)
    stiffness, damping = np.zeros((2, m.nv, m.nv))
    for name in stiff:
        ident, row = m.tendon(name).id, tendon_row(m, name)
        # turning back, a hysteresis is twice as stiff as at first
        factor = 2.0 if any(t.spring == name for t in chain.hysteresis) else 1.0
        stiffness += factor * m.tendon_stiffness[ident] * np.outer(row, row)
        damping += m.tendon_damping[ident] * np.outer(row, row)
    data, mass = mujoco.MjData(m), np.zeros((m.nv, m.nv))
    mujoco.mj_forward(m, data)
    mujoco.mj_fullM(m, data, mass)
    give = np.linalg.inv(mass)
    rates = np.block([[np.zeros_like(mass), np.eye(m.nv)], [-give @ stiffness, -give @ damping]])
    fastest = float(np.abs(np.linalg.eigvals(rates)).max())
    return _steps(max(fastest, float(touched)), m)


def _steps(fastest: float, m: mujoco.MjModel) -> int:
    return int(np.clip(np.ceil(fastest * m.opt.timestep / _TURN), 1, _MOST))


_SPRINGS = ("hysteresis", "flex", "base")
