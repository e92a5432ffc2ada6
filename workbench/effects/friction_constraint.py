"""How MuJoCo's friction constraint is made to act like friction with a small creep before sliding."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from workbench.models import Model, friction_lead, own_constraints

from .chain import FrictionTerm, TorqueChain

_LOAD = 0.05  # share of the torque limit that loads a drive at least
_UNLIMITED = 100.0  # N m: what a drive without a limit is taken to have
_SLIDE = mujoco.mjtJoint.mjJNT_SLIDE
_STABLE = 1.5  # largest product of rate and step; Runge-Kutta 4 needs less than 2.78


def set_friction_constraints(m: mujoco.MjModel, chain: TorqueChain, model: Model) -> None:
    """Choose the constraint's parameters of every tendon and joint that has dry friction.

    Below its bound f the constraint acts like a damper: force = (b d / ((1 - d) A)) w, with A the inverse
    inertia that the tendon feels, d its impedance and b its reference damping (MuJoCo, "Computation",
    solver parameters). The damper is set to f / w_s, so that sliding starts at the model's sliding speed
    w_s; d is taken as small as a stable step allows, where the constraint answers without lag.

    Args:
        m: compiled model, changed in place.
        chain: friction that depends on the state.
        model: for the sliding speed.
    """
    h, as_stated = m.opt.timestep, model.friction_as_in_mjcf
    stated = own_constraints(model) if as_stated else {}
    for ident in range(m.ntendon):
        name = m.tendon(ident).name
        if as_stated and (name in stated or name.partition(":")[0] not in ("actuator", "joint")):
            own = m.tendon_solref_fri[ident], m.tendon_solimp_fri[ident]
            m.tendon_solref_fri[ident], m.tendon_solimp_fri[ident] = stated.get(name, own)
            continue
        slow = model.sliding_speed * (0.1 if _slides(m, ident) else 1.0)
        laws = [t for t in chain.friction if t.tendon == name]
        loss = float(m.tendon_frictionloss[ident]) + _most(laws, slow, model)
        if loss > 0.0:
            rate = loss / slow * float(m.tendon_invweight0[ident])
            m.tendon_solref_fri[ident], m.tendon_solimp_fri[ident] = _rigid(rate, h)
    for dof in np.flatnonzero(m.dof_frictionloss * (not as_stated)):  # of joints that are no axis
        slow = model.sliding_speed * (0.1 if m.jnt_type[m.dof_jntid[dof]] == _SLIDE else 1.0)
        rate = float(m.dof_frictionloss[dof] / slow * m.dof_invweight0[dof])
        m.dof_solref[dof], m.dof_solimp[dof] = _rigid(rate, h)


def tendon_leads(model: Model, m: mujoco.MjModel) -> dict[str, float]:
    """Return how long before a reversal dry friction turns [s], by the tendon it acts on.

    The constraint pulls the speed w to ``a = -b w``: it gives way where w + a / b changes sign.

    Args:
        model: none has a lead where its friction is rigid.
        m: compiled from it, for the steps.
    """
    stated = own_constraints(model) if model.friction_as_in_mjcf else {}
    return {name: friction_lead(*constraint, m.opt.timestep) for name, constraint in stated.items()}


def rigid_in_steps(timestep: float) -> tuple[tuple[float, float], tuple[float, ...]]:
    """``solreffriction`` and ``solimpfriction`` of friction as rigid as steps of this length [s] allow.

    The shortest time constant that MuJoCo takes is two steps: a joint below its friction stops within one.
    """
    return (2.0 * timestep, 1.0), (0.99, 0.99, 0.001, 0.5, 2.0)


def _rigid(rate: float, timestep: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Reference and impedance of a constraint that acts as a damper of this rate [1/s]."""
    give = min(0.9, _STABLE / (rate * timestep))
    return (-1.0, -rate * give), (1.0 - give, 1.0 - give, 0.001, 0.5, 2.0)


def _most(laws: Sequence[FrictionTerm], slow: float, model: Model) -> float:
    """Sum of what laws give at most about the sliding speed."""
    total = 0.0
    for law in laws:
        # a law may differ by direction, or be nothing but damping, which the constraint must not soften
        around = 10.0 * slow * np.array([-1.0, 0.0, 1.0])
        # one that grows with the load sets in at the sliding speed under a small one, above it later
        limit = float(model.actuators.torque_limit[int(law.tendon.partition(":")[2])])
        load = np.full(3, _LOAD * min(limit, _UNLIMITED))
        total += float(np.max(law.law(around, load, *law.parameters)))
    return total


def _slides(m: mujoco.MjModel, tendon: int) -> bool:
    """Whether a tendon's length is one [m], rather than an angle."""
    part = slice(m.tendon_adr[tendon], m.tendon_adr[tendon] + m.tendon_num[tendon])
    if not np.all(m.wrap_type[part] == int(mujoco.mjtWrap.mjWRAP_JOINT)):
        return True
    first = m.wrap_objid[part][int(np.argmax(np.abs(m.wrap_prm[part])))]
    return bool(m.jnt_type[first] == _SLIDE)
