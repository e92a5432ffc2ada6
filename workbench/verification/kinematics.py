"""Kinematics: the foot in every engine, and the transmission found from the loop."""

from __future__ import annotations

import mujoco
import numpy as np

from workbench.core import Check
from workbench.simulation import joint_columns

from .subject import Subject

LENGTH = 1e-9  # m: a nanometre, a million times less than a leg is built to


def kinematic_checks(subject: Subject) -> list[Check]:
    """Foot position and Jacobian in MuJoCo, Pinocchio and Drake; J of the loop against the model's."""
    return [*_foot(subject), *_transmission(subject)]


def _foot(subject: Subject) -> list[Check]:
    site, q = subject.foot, subject.states.position
    if site is None:
        return []
    positions, jacobians = _mujoco_foot(subject, site)
    others = [(subject.tree.site_position(site, q), subject.tree.site_jacobian(site, q))]
    names = "MuJoCo, Pinocchio"
    chain = subject.chain
    if chain is not None and chain.mechanism.foot:
        others.append(
            (
                np.array([chain.foot_position(row) for row in q]),
                np.array([chain.foot_jacobian(row) for row in q]),
            )
        )
        names += ", Drake"
    away = max(float(np.abs(p - positions).max()) for p, _ in others)
    slope = max(float(np.abs(j - jacobians).max()) for _, j in others)
    hint = (
        f"the foot is up to {away:.3g} m from where the closed chain has it: a length, an axis or a zero "
        "of the serial tree differs"
    )
    return [
        Check("forward_kinematics", away, LENGTH, "m", names, hint),
        Check("jacobian", slope, LENGTH, "m/rad", names),
    ]


def _mujoco_foot(subject: Subject, site: str) -> tuple[np.ndarray, np.ndarray]:
    m = subject.plants["kin_only"].mujoco
    data, index = mujoco.MjData(m), m.site(site).id
    places, dofs = joint_columns(m, subject.model.joints)
    positions, jacobians = [], []
    full = np.zeros((3, m.nv))
    for q in subject.states.position:
        data.qpos[places] = q
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        mujoco.mj_jacSite(m, data, full, None, index)
        positions.append(data.site_xpos[index].copy())
        jacobians.append(full[:, dofs].copy())
    return np.array(positions), np.array(jacobians)


def _transmission(subject: Subject) -> list[Check]:
    chain, model = subject.chain, subject.model
    if chain is None:
        return []
    found = np.array([chain.jacobian(q) for q in subject.states.position])
    spread = float(np.abs(found - found.mean(axis=0)).max())
    if model.posture_dependent:
        start = chain.jacobian(chain.start[1])
        away = np.abs(start - model.transmission)
        about, known = "Drake, [transmission]", start
    else:
        away = np.abs(found - model.transmission).max(axis=0)
        about, known = "Drake, [transmission]", found.mean(axis=0)
    i, j = np.unravel_index(int(np.argmax(away)), away.shape)
    hint = (
        f"drive '{model.axes[i]}' moves {known[i, j]:+.6g} per unit of joint '{model.joints[j]}' in the "
        f"closed chain, and {model.transmission[i, j]:+.6g} in the model"
    )
    if not model.posture_dependent and spread > LENGTH:
        hint += f"; J changes by {spread:.3g} over the postures: state posture_dependent = true"
    # what changes with the posture is stated for people, to some digits; the engines compute their own
    allowed = 1e-5 if model.posture_dependent else 1e-9
    return [Check("transmission", float(away.max()), allowed, "", about, hint)]
