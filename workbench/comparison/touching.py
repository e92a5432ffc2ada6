"""Bodies of a model that touch at the measured poses, and whether this is possible for a machine."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np

from workbench.core import InputError, Recording
from workbench.models import Model, base_contacts, load_tree, machine_bodies, warned

_POSES = 200  # over all recordings; a motion shows in fewer what touches


def refuse_overlaps(model: Model, recordings: Sequence[Recording]) -> None:
    """Refuse a model with bodies that overlap at all measured poses: real links do not, and a simulation
    would get stuck.

    Raises:
        InputError: two links touch at every measured pose, and no exclude keeps them apart.
    """
    shares, left_out, machine = _touching(model, recordings)
    wrong = [
        sorted(pair)
        for pair, share in shares.items()
        if share == 1.0 and pair not in left_out and machine.issuperset(pair)
    ]
    if wrong:
        named = ", ".join(f"'{one}' and '{other}'" for one, other in wrong)
        apart = "".join(f'<exclude body1="{one}" body2="{other}"/>' for one, other in wrong)
        raise InputError(
            f"shapes of {named} overlap at every measured pose, and their contact blocks the joints",
            file=model.serial, column="contact", remedy=f"keep them apart: <contact>{apart}</contact>",
        )  # fmt: skip


def contact_notes(model: Model, recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return notes on bodies that touch at the measured poses, except for a stated ground."""
    shares, left_out, _ = _touching(model, recordings)
    notes = []
    for one in sorted({base for base, _ in map(tuple, left_out.values())}):
        links = [link for pair, (base, link) in left_out.items() if base == one and pair in shares]
        if links:
            notes.append(
                f"shapes of '{one}' overlap with {', '.join(links)} at measured poses; these contacts are "
                "left out, as MuJoCo leaves those of parent and child unless the parent is fixed to the world"
            )
    for pair, share in shares.items():
        if pair not in left_out:
            one, other = sorted(pair)
            notes.append(
                f"'{one}' and '{other}' touch at {100 * share:.0f} % of the measured poses; torques "
                "along the measured motion are computed without this contact"
            )
    return tuple(notes)


def _touching(
    model: Model, recordings: Sequence[Recording]
) -> tuple[dict[frozenset[str], float], dict[frozenset[str], tuple[str, str]], set[str]]:
    """Share of the poses at which each pair of bodies touches; pairs left out; the machine's bodies."""
    spec = load_tree(model.serial)
    machine = machine_bodies(spec)
    left_out = {frozenset(pair): pair for pair in base_contacts(spec)}
    stated = {*(() if model.ground is None else (*model.ground.feet, model.ground.surface))}
    with warned():  # said where the model is built
        m = spec.compile()
    if not (m.npair or (m.geom_contype.any() and m.geom_conaffinity.any())):
        return {}, left_out, machine
    data, counts = mujoco.MjData(m), dict[frozenset[str], int]()
    places = [int(m.joint(name).qposadr[0]) for name in model.joints]
    poses = _poses(model, recordings)
    for pose in poses:
        data.qpos[places] = pose
        mujoco.mj_kinematics(m, data)
        mujoco.mj_comPos(m, data)
        mujoco.mj_collision(m, data)
        found = set()
        for contact in data.contact:
            geoms = m.geom(int(contact.geom1)), m.geom(int(contact.geom2))
            if contact.dist < contact.includemargin and not stated & {g.name for g in geoms}:
                found.add(frozenset(m.body(int(g.bodyid[0])).name for g in geoms))
        for pair in found:
            counts[pair] = counts.get(pair, 0) + 1
    return {pair: count / len(poses) for pair, count in counts.items() if len(pair) == 2}, left_out, machine


def _poses(model: Model, recordings: Sequence[Recording]) -> np.ndarray:
    """Positions of the serial joints at some valid rows of each recording, (K, n)."""
    out = []
    for r in recordings:
        rows = np.flatnonzero(r.valid & np.isfinite(r.position).all(axis=1))
        chosen = rows[np.unique(np.linspace(0, len(rows) - 1, max(2, _POSES // len(recordings))).astype(int))]
        back = np.eye(model.size) if r.coordinates == "joint" else np.linalg.inv(model.transmission)
        out.append(r.position[chosen] @ back.T)
    return np.concatenate(out)
