"""State-dependent torques, computed once per step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import mujoco
import numpy as np

from workbench.core.compiled import compiled
from workbench.effects import LONGEST, FlankTerm, FrictionTerm, Plant, TorqueTerm, call_law, tendon_row


class Terms(NamedTuple):
    """L laws on tendons: address of their code, (L,); tendon and drive, (L,); row over joints (L, nv)."""

    address: np.ndarray
    tendon: np.ndarray
    axis: np.ndarray
    row: np.ndarray
    parameters: np.ndarray


class Springs(NamedTuple):
    """Hysteresis on S tendons: number (S,), row over joints (S, nv), torque, ratio of stiffness to it.

    State: `place` where the axes were last, and Dahl's `state` there, (S,).
    """

    tendon: np.ndarray
    row: np.ndarray
    torque: np.ndarray
    ratio: np.ndarray
    place: np.ndarray
    state: np.ndarray


class Flanks(NamedTuple):
    """Dampers of F gaps: tendon (F,), row over joints (F, nv), half the gap, damping while flanks touch."""

    tendon: np.ndarray
    row: np.ndarray
    half: np.ndarray
    damping: np.ndarray


class Laws(NamedTuple):
    """All laws of one run.

    Attributes:
        present: whether there are any.
        step: of MuJoCo's [s].
        torques, friction, springs, flanks: the laws.
        loss, stiffness, rest, damping: views into the run's own MuJoCo model, per tendon.
        constant: friction loss without laws, per tendon.
        before: speeds of the joints a step ago, (nv,).
    """

    present: bool
    step: float
    torques: Terms
    friction: Terms
    springs: Springs
    flanks: Flanks
    loss: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    damping: np.ndarray
    constant: np.ndarray
    before: np.ndarray


def laws_of(plant: Plant, model: mujoco.MjModel, state: np.ndarray) -> Laws:
    """Return the laws of a plant for a run that starts at `state` (2, nv) and has its own MuJoCo model."""
    chain = plant.chain
    tendons = [t.spring for t in chain.hysteresis]
    rows = np.array([tendon_row(model, name) for name in tendons]).reshape(-1, model.nv)
    torque = np.array([max(t.torque, 1e-12) for t in chain.hysteresis])
    springs = Springs(
        tendon=np.array([model.tendon(name).id for name in tendons], np.intp),
        row=rows,
        torque=torque,
        ratio=np.array([t.stiffness for t in chain.hysteresis]) / torque,
        place=rows @ state[0],
        state=np.zeros(len(tendons)),
    )
    return Laws(
        present=chain.follows_state,
        step=float(model.opt.timestep),
        torques=_terms(chain.torques, model),
        friction=_terms(chain.friction, model),
        springs=springs,
        flanks=_flanks(chain.flanks, model),
        loss=model.tendon_frictionloss,
        stiffness=model.tendon_stiffness,
        rest=model.tendon_lengthspring,
        damping=model.tendon_damping,
        constant=model.tendon_frictionloss.copy(),
        before=state[1].copy(),
    )


def _terms(terms: Sequence[FrictionTerm | TorqueTerm], model: mujoco.MjModel) -> Terms:
    table = np.zeros((len(terms), LONGEST))
    for k, term in enumerate(terms):
        table[k, : len(term.parameters)] = term.parameters
    return Terms(
        address=np.array([t.law.address for t in terms], np.intp),
        tendon=np.array([model.tendon(t.tendon).id for t in terms], np.intp),
        axis=np.array([int(t.tendon.partition(":")[2]) for t in terms], np.intp),
        row=np.array([tendon_row(model, t.tendon) for t in terms]).reshape(-1, model.nv),
        parameters=table,
    )


def _flanks(terms: Sequence[FlankTerm], model: mujoco.MjModel) -> Flanks:
    return Flanks(
        tendon=np.array([model.tendon(t.spring).id for t in terms], np.intp),
        row=np.array([tendon_row(model, t.spring) for t in terms]).reshape(-1, model.nv),
        half=np.array([t.half for t in terms]),
        damping=np.array([t.damping for t in terms]),
    )


@compiled()
def act(laws: Laws, position: np.ndarray, speed: np.ndarray, shaft: np.ndarray, force: np.ndarray) -> None:
    """Set friction limits and add torques for the coming step.

    Everything is taken at the middle of the step, by extrapolating the speed half a step.

    Args:
        laws: of the run.
        position, speed: of all joints at the start of the step, (nv,).
        shaft: motor torque on the drives, (n,).
        force: on the joints, (nv,); added to.
    """
    count = len(speed)
    middle = np.empty(count)
    for j in range(count):
        middle[j] = 1.5 * speed[j] - 0.5 * laws.before[j]
        laws.before[j] = speed[j]
    own = laws.torques
    for k in range(len(own.address)):
        row, rate, place = own.row[k], 0.0, 0.0
        for j in range(count):
            rate += row[j] * middle[j]
            place += row[j] * (position[j] + 0.5 * laws.step * middle[j])
        torque = call_law(own.address[k], place, rate, own.parameters[k])
        for j in range(count):
            force[j] += torque * row[j]
    _bend(laws, position, middle, force)
    _meet(laws, position, middle)
    own = laws.friction
    for k in range(len(own.address)):
        laws.loss[own.tendon[k]] = laws.constant[own.tendon[k]]
    for k in range(len(own.address)):
        rate = 0.0
        for j in range(count):
            rate += own.row[k, j] * middle[j]
        pulled = shaft[own.axis[k]]
        bound = call_law(own.address[k], rate, pulled, own.parameters[k])  # pyright: ignore[reportArgumentType]
        laws.loss[own.tendon[k]] = max(laws.loss[own.tendon[k]] + bound, 0.0)  # less than none is none


@compiled()
def _bend(laws: Laws, position: np.ndarray, middle: np.ndarray, force: np.ndarray) -> None:
    """Hysteresis as a force and a spring about where the axis is, right at the end of the step too."""
    own = laws.springs
    for k in range(len(own.tendon)):
        place, rate = 0.0, 0.0
        for j in range(len(middle)):
            place += position[j] * own.row[k, j]
            rate += middle[j] * own.row[k, j]
        own.state[k] = _wound(own.state[k], place - own.place[k], own.ratio[k])
        own.place[k] = place
        way = laws.step * rate
        way = 1e-12 if way == 0.0 else way
        bent = _wound(own.state[k], way, own.ratio[k]) - own.state[k]
        laws.stiffness[own.tendon[k]] = own.torque[k] * bent / way
        laws.rest[own.tendon[k], 0] = laws.rest[own.tendon[k], 1] = place
        for j in range(len(middle)):
            force[j] -= own.torque[k] * own.state[k] * own.row[k, j]


@compiled()
def _meet(laws: Laws, position: np.ndarray, middle: np.ndarray) -> None:
    """Set the dampers of gaps, by the share of the coming step in which flanks touch."""
    own = laws.flanks
    for k in range(len(own.tendon)):
        wind, way = 0.0, 0.0
        for j in range(len(middle)):
            wind += own.row[k, j] * position[j]
            way += own.row[k, j] * laws.step * middle[j]
        low, high = min(wind, wind + way), max(wind, wind + way)
        apart = min(high, own.half[k]) - max(low, -own.half[k])
        share = 1.0 - min(max(apart, 0.0) / max(high - low, 1e-15), 1.0)
        laws.damping[own.tendon[k]] = share * own.damping[k]


@compiled()
def _wound(state: float, moved: float, ratio: float) -> float:
    """Dahl's state after a way without a reversal, exact."""
    side = np.sign(moved)
    return side - (side - state) * np.exp(-ratio * abs(moved))
