"""Inverse dynamics of a model's file (MuJoCo's), and what each effect adds to the torque of drives."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from workbench_exam.cases import Case

_SLOW = 0.02  # of the largest speed: below it a direction is not sure
#: Value name -> (value, its slope over the columns' factors).
Reading = Callable[[np.ndarray], dict[str, tuple[float, np.ndarray]]]


@dataclass(frozen=True)
class Candidate:
    """An effect at a drive as columns (N, K) of torque, and how its values are read from their factors."""

    effect: str
    place: str | None
    columns: np.ndarray
    reading: Reading


class Inverse:
    """Torques of drives that a model's file needs for a motion."""

    def __init__(self, case: Case) -> None:
        self._case = case
        self._model = mujoco.MjModel.from_xml_path(str(case.folder / "model.xml"))
        for name in (
            "dof_armature",
            "dof_damping",
            "dof_frictionloss",
            "tendon_armature",
            "tendon_frictionloss",
        ):
            getattr(self._model, name)[:] = 0.0
        self._model.tendon_damping[:] = 0.0
        self._data = mujoco.MjData(self._model)
        self.numbers = {key: np.array(values) for key, values in case.known["file_numbers"].items()}
        self._turn = np.linalg.inv(case.couple)

    def links(
        self, m: dict[str, np.ndarray], change: Callable[[mujoco.MjModel], None] | None = None
    ) -> np.ndarray:
        """Of the links alone (N, n), with the compiled model changed or as it is."""
        model, data = self._model, self._data
        kept = {name: getattr(model, name).copy() for name in ("body_mass", "body_ipos", "body_inertia")}
        if change:
            change(model)
        out = np.empty_like(m["q"])
        motion = [m[key] @ self._turn.T for key in "qwa"]
        for k, (q, w, a) in enumerate(zip(*motion, strict=True)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q, w, a
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse
        for name, values in kept.items():
            getattr(model, name)[:] = values
        return out @ self._turn  # couple^-T, of rows

    def torque(self, m: dict[str, np.ndarray]) -> np.ndarray:
        """Of links, rotors, damping and dry friction (N, n)."""
        f = self.numbers
        return self.links(m) + f["armature"] * m["a"] + f["damping"] * m["w"] + f["friction"] * way(m["w"])


def way(w: np.ndarray) -> np.ndarray:
    """Direction of motion, from -1 to 1."""
    return np.tanh(w / (_SLOW * np.abs(w).max(axis=0)))


def candidates(case: Case, m: dict[str, np.ndarray], file: Inverse) -> list[Candidate]:
    """Every effect that is linear in the torque, or is over a small grid, of motion `m` (N, n) each."""
    found: list[Candidate] = []
    n, rows = len(case.drives), len(m["q"])
    needed = file.torque(m)
    links = file.links(m)
    for i, place in enumerate(case.drives):
        if not case.driven[i]:
            continue
        q, w, a = (m[key][:, i] for key in "qwa")
        side, one = way(m["w"])[:, i], np.ones(rows)

        def add(
            effect: str, columns: Sequence[np.ndarray], reading: Reading, i: int = i, place: str = place
        ) -> None:
            at = np.zeros((rows, n, len(columns)))
            at[:, i] = np.column_stack(columns)
            found.append(Candidate(effect, place, at, reading))

        add("viscous_damping", [w], plainly("damping"))
        add("coulomb_friction", [side], plainly("torque"))
        add("reflected_inertia", [a], plainly("inertia"))
        add("quadratic_drag", [w * np.abs(w)], plainly("drag"))
        add("torque_bias", [-one], plainly("torque"))
        add("parallel_spring", [q, -one], _spring)
        add("torque_constant_error", [needed[:, i]], _gain)
        for speed in np.array([0.05, 0.1, 0.2, 0.3]) * np.abs(w).max():
            add("stribeck_friction", [side, side * np.exp(-((w / speed) ** 2))], _stribeck(speed))
        for order in range(6, 21):
            add("cogging", [-np.sin(order * q), -np.cos(order * q)], _wave(float(order)))
        shifted = m | {"q": m["q"] - 1e-4 * np.eye(n)[i]}
        slope = (file.links(shifted) - links) / 1e-4
        found.append(Candidate("encoder_offset", place, slope[:, :, None], plainly("angle")))
    found += _of_links(case, m, file, links)
    return found


def _of_links(case: Case, m: dict[str, np.ndarray], file: Inverse, links: np.ndarray) -> list[Candidate]:
    model = mujoco.MjModel.from_xml_path(str(case.folder / "model.xml"))
    found = []
    last = model.nbody - 1
    mass, step = model.body_mass[last], 1e-3

    def heavier(changed: mujoco.MjModel) -> None:
        tip = model.site_pos[0]
        total = mass + step
        centre = (mass * model.body_ipos[last] + step * tip) / total
        inertia = model.body_inertia[last].copy()
        for part, spot in ((mass, model.body_ipos[last]), (step, tip)):
            arm = spot - centre
            inertia += part * (arm @ arm - arm**2)
        changed.body_mass[last], changed.body_ipos[last], changed.body_inertia[last] = total, centre, inertia

    slope = (file.links(m, heavier) - links) / step
    found.append(Candidate("payload_mass", None, slope[:, :, None], plainly("mass")))
    if case.known["joints"] != list(case.drives):
        return found
    for i, place in enumerate(case.drives):
        if not case.driven[i] or model.jnt_type[i] != mujoco.mjtJoint.mjJNT_HINGE or not i:
            continue
        axis = model.jnt_axis[i]
        target = model.body_pos[i + 2] if i + 2 < model.nbody else model.site_pos[0]
        target = target - axis * (axis @ target)
        if np.linalg.norm(target) > 1e-6:
            towards = target / np.linalg.norm(target)

            def moved(changed: mujoco.MjModel, i: int = i, towards: np.ndarray = towards) -> None:
                changed.body_ipos[i + 1] += towards * 1e-4 / changed.body_mass[i + 1]

            slope = (file.links(m, moved) - links) / 1e-4
            found.append(Candidate("first_moment_error", place, slope[:, :, None], plainly("along")))

        def rounder(changed: mujoco.MjModel, i: int = i, axis: np.ndarray = axis) -> None:
            changed.body_inertia[i + 1] += np.abs(axis) * 1e-4

        slope = (file.links(m, rounder) - links) / 1e-4
        found.append(Candidate("link_inertia_error", place, slope[:, :, None], plainly("inertia")))
    return found


def plainly(name: str) -> Reading:
    """One value that is its column's factor."""
    return lambda x: {name: (float(x[0]), np.array([1.0]))}


def _gain(x: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
    """The measured torque is that needed, over the gain."""
    return {"gain": (1.0 / (1.0 + float(x[0])), np.array([-1.0 / (1.0 + float(x[0])) ** 2]))}


def _stribeck(speed: float) -> Reading:
    return lambda x: {
        "coulomb": (float(x[0]), np.array([1.0, 0.0])),
        "static": (float(x[0] + x[1]), np.ones(2)),
        "speed": (float(speed), np.zeros(2)),
    }


def _spring(x: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
    k, moment = float(x[0]), float(x[1])
    return {"stiffness": (k, np.array([1.0, 0.0])), "rest": (moment / k, np.array([-moment / k**2, 1.0 / k]))}


def _wave(order: float) -> Reading:
    def read(x: np.ndarray) -> dict[str, tuple[float, np.ndarray]]:
        size = float(np.hypot(*x))
        return {
            "torque": (size, x / size),
            "order": (order, np.zeros(2)),
            "phase": (math.atan2(x[1], x[0]) % (2 * math.pi), np.array([-x[1], x[0]]) / size**2),
        }

    return read
