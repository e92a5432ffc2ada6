"""A transmission that depends on the posture: our closed chain against Drake's, by term and in motion."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from workbench.core import Check, InputError, SimulationError
from workbench.mechanism.linear import linearise
from workbench.mechanism.simulate import simulate
from workbench.s3n.posture import MOST_DRIVES, PostureDependent
from workbench.s3n.posture_chain import PostureChain
from workbench.s3n.posture_closure import workspace
from workbench.s3n.posture_fitted import fit_native

from .states import moving, relative
from .structure import EXACT
from .subject import Subject

_POSTURES = 3
_OMEGA = 2.0 * np.pi * np.logspace(-1, 2, 40)  # 0.1 to 100 Hz, as in the paper
_TINY = 1e-4  # rad, rad/s or N m: central differences of accelerations err by its square
_BALANCE = 2e-6  # s, the same for the power balance
_ROWS, _PERIOD = 50, 0.002  # 0.1 s: short, since a workspace may be small
_SWING = 15.0  # rad/s^2, what the torques of the swing would do at rest

_SERIES = "MuJoCo (series)"  # terms in MuJoCo, kept as smooth functions of the posture

Facts = dict[str, tuple[float, str, str]]


def posture_checks(subject: Subject, seed: int) -> list[Check]:
    """Return every term in our engine and in Drake; then motion and responses by the series of these terms.

    Raises:
        InputError: our engine cannot read the mechanism's file, or it has no limits.
    """
    terms = _terms(subject)
    if not all(check.passed for check in terms):
        return terms
    checks = [*terms, _balance(subject)]
    workspace(subject.model)
    if subject.model.size > MOST_DRIVES:
        return checks
    try:
        series = PostureDependent(subject.model)
    except InputError as error:
        return [
            *checks,
            Check("posture_workspace", float("nan"), 0.0, "", "[closed_chain] limits", str(error)),
        ]
    return [*checks, _frf(subject, series), _motion(subject, series, seed)]


def fitted_facts(subject: Subject) -> Facts:
    """What the mechanism is off by as plain MJCF: how good is good enough is the user's to say."""
    error = fit_native(subject.model, allow=None).error

    def told(share: float, what: str) -> tuple[float, str, str]:
        return 100.0 * share, "%", f"As plain MJCF (workbench normalize), {what} is"

    facts: Facts = {
        "fitted_inertia_max": told(error.inertia_max, "the largest error of the inertia"),
        "fitted_inertia_rms": told(error.inertia_rms, "the RMS error of the inertia"),
        "fitted_gravity_rms": told(error.gravity_rms, "the RMS error of gravity"),
        "fitted_velocity_rms": told(error.velocity_rms, "the RMS error of the velocity terms"),
    }
    if error.torque_max is not None:
        facts["fitted_torque_max"] = told(error.torque_max, "the largest error of a drive's torque")
    return facts


def _terms(subject: Subject) -> list[Check]:
    """Mass, velocity terms, gravity, J and drive positions at every state, rotors included."""
    chain, model = subject.chain, subject.model
    assert chain is not None
    q, v = subject.states.position, subject.states.velocity
    try:
        ours = PostureChain(model).dynamics(q, v)
    except SimulationError as error:
        hint = f"Drake closes the loops where MuJoCo does not: {error}"
        return [Check("posture_closure", float("nan"), EXACT, "", "MuJoCo, Drake", hint)]
    j = np.array([chain.jacobian(row) for row in q])
    rates = np.array([chain.jacobian_bias(*state) for state in zip(q, v, strict=True)])
    rotor = np.array(model.actuators.inertia)
    mass = np.array([r.mass for r in subject.real]) + np.einsum("nai,a,naj->nij", j, rotor, j)
    bias = np.array([r.bias for r in subject.real]) + np.einsum("nai,a,na->ni", j, rotor, rates)
    gravity = np.array([r.gravity for r in subject.real])
    drives = np.array([chain.drive_position(row) for row in q])
    pairs = {
        "posture_drives": (ours.drives, drives),
        "posture_jacobian": (ours.jacobian, j),
        "posture_mass_matrix": (ours.mass, mass),
        "posture_coriolis": (ours.bias, bias),
        "posture_gravity": (ours.gravity, gravity),
    }
    # where the mass does not change there are no velocity terms, but what they are rounding of
    scales = {name: other for name, (_, other) in pairs.items()}
    scales["posture_coriolis"] = np.append(bias, moving(mass, v))
    return [
        Check(name, relative(one - other, scales[name]), EXACT, "", "MuJoCo, Drake")
        for name, (one, other) in pairs.items()
    ]


def _balance(subject: Subject) -> Check:
    """v (M' v / 2 - bias) = 0 of our closed chain, relative to the power of the velocity terms."""
    chain, q, v = PostureChain(subject.model), subject.states.position, subject.states.velocity
    ahead, behind = (chain.dynamics(q + s * _BALANCE * v).mass for s in (1.0, -1.0))
    at = chain.dynamics(q, v)
    rate = (ahead - behind) / (2.0 * _BALANCE)
    made = np.einsum("ki,kij,kj->k", v, rate, v) / 2.0 - np.einsum("ki,ki->k", v, at.bias)
    # where the mass hardly changes there is next to no such power, and differences leave rounding
    least = 1e-3 * float(np.einsum("ki,kij,kj->k", v, at.mass, v).max())
    scale = max(float(np.abs(v * at.bias).sum(axis=1).max()), least)
    return Check("posture_power", float(np.abs(made).max()) / max(scale, 1e-12), 1e-6, "", "energy, work")


def _frf(subject: Subject, series: PostureDependent) -> Check:
    """Speed over torque in drive coordinates: by the series, and of the closed chain."""
    chain, model = subject.chain, subject.model
    assert chain is not None
    worst = 0.0
    for joints in _well_inside(subject, series)[:_POSTURES]:
        q = chain.drive_position(joints)
        plant = linearise(chain, q, model.actuators.inertia, model.actuators.damping)
        real = plant.frequency_response(_OMEGA)
        ours = _response(series, joints, plant.holding)
        worst = max(worst, float((np.abs(ours - real) / np.abs(real).max(axis=(1, 2), keepdims=True)).max()))
    return Check("posture_frf", worst, 1e-5, "", f"{_SERIES}, Drake, {_POSTURES} postures")


def _response(series: PostureDependent, joints: np.ndarray, holding: np.ndarray) -> np.ndarray:
    """Speed over torque (F, n, n) by the series about a posture, drive coordinates."""
    n = len(joints)
    rest, j = np.zeros(n), series.jacobian(joints[None])[0]

    def slope(way: int) -> np.ndarray:
        columns = []
        for unit in _TINY * np.eye(n):
            ahead, behind = [joints, rest, holding], [joints, rest, holding]
            ahead[way], behind[way] = ahead[way] + unit, behind[way] - unit
            columns.append((_acceleration(series, *ahead) - _acceleration(series, *behind)) / (2.0 * _TINY))
        return np.transpose(columns)

    stiffness, drag, drive = slope(0), slope(1), slope(2)
    s = 1j * _OMEGA[:, None, None]
    return j @ np.linalg.solve(s * np.eye(n) - drag - stiffness / s, np.broadcast_to(drive, (len(s), n, n)))


def _acceleration(series: PostureDependent, q: np.ndarray, v: np.ndarray, torque: np.ndarray) -> np.ndarray:
    """Of the joints (n,) at a state (n,), (n,), with a torque on the drives (n,)."""
    at = series.dynamics(q, v)
    force = at.gravity[0] + at.jacobian[0].T @ torque - at.bias[0] - at.damping[0] @ v
    return np.linalg.solve(at.mass[0], force)


def _motion(subject: Subject, series: PostureDependent, seed: int) -> Check:
    """A swing of 0.1 s under held random torques about the middle of the workspace."""
    chain, model = subject.chain, subject.model
    assert chain is not None
    joints = series.box.mean(axis=1)
    q = chain.drive_position(joints)
    plant = linearise(chain, q, model.actuators.inertia, model.actuators.damping)
    swing = np.random.default_rng(seed).standard_normal((_ROWS // 10, model.size))
    torque = plant.holding + _SWING / np.sqrt(model.size) * np.repeat(swing, 10, axis=0) @ plant.mass
    drives = model.actuators.inertia, model.actuators.damping
    real = simulate(chain, *drives, torque, _PERIOD, q, substeps=2).position
    states = [np.concatenate([joints, np.zeros_like(joints)])]
    for held in torque:

        def change(_: float, state: np.ndarray, held: np.ndarray = held) -> np.ndarray:
            position, velocity = np.split(state, 2)
            return np.concatenate([velocity, _acceleration(series, position, velocity, held)])

        states.append(solve_ivp(change, (0.0, _PERIOD), states[-1], rtol=1e-10, atol=1e-12).y[:, -1])
    path = series.at(np.array(states)[:, : model.size]).drives
    off = relative(path - real, real - real[0])
    return Check("posture_motion", off, 1e-6, "", f"{_SERIES}, Drake, {_ROWS * _PERIOD:g} s")


def _well_inside(subject: Subject, chain: PostureDependent) -> np.ndarray:
    """Postures that differences do not lead out of the limits."""
    q = subject.states.position
    return q[chain.inside(q - _TINY) & chain.inside(q + _TINY)]
