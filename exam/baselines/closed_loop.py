"""Armature, damping, friction, joint bias and one delay: fitted in closed loop by CMA-ES to positions.

After F. Bjelonic et al., Towards bridging the gap: systematic sim-to-real transfer for diverse legged robots
(PACE),
2025: the same numbers, the same fit. It names nothing by itself; named is what costs more at the file's
    number than a further parameter has to pay. Needs `pip install cma mujoco`.
"""

from __future__ import annotations

import math
import warnings

import cma
import mujoco
import numpy as np
from mujoco import rollout
from workbench_exam.answers import Answer, Named
from workbench_exam.cases import Case

_STEP = 2e-3  # s
_SECONDS = 3.0  # of each recording
_WORK = 1200  # simulations of all recordings
_MATTERS = 1.3  # times the cost, where a number is put back
_EFFECTS = (
    ("reflected_inertia", "inertia"),
    ("viscous_damping", "damping"),
    ("coulomb_friction", "torque"),
    ("encoder_offset", "angle"),
)


class Loop:
    """The file's model in its own loop, with numbers (4 n + 1,): three and a bias a drive, a delay."""

    def __init__(self, case: Case) -> None:
        self.driven = np.flatnonzero(case.driven)
        self.model = mujoco.MjModel.from_xml_path(str(case.folder / "model.xml"))
        self.tendons = self.model.ntendon > 0
        for k, i in enumerate(self.driven):
            self.model.actuator_gainprm[k, 0] = case.kp[i]
            self.model.actuator_biastype[k] = mujoco.mjtBias.mjBIAS_AFFINE
            # Euler's steps show angles half a step early: taken back here and where angles are compared
            self.model.actuator_biasprm[k, :3] = 0.0, -case.kp[i], -(case.kd[i] - 0.5 * _STEP * case.kp[i])
        self.model.opt.timestep = _STEP
        self.model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
        self.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
        self.data = mujoco.MjData(self.model)
        self.couple, self.case = case.couple, case
        file = case.known["file_numbers"]
        n = len(self.driven)
        self.nominal = np.concatenate(
            [
                *(np.array(file[key])[self.driven] for key in ("armature", "damping", "friction")),
                np.zeros(n + 1),
            ]
        )
        rub = np.maximum(self.nominal[2 * n : 3 * n], 0.05 * case.kd[self.driven])
        usual = np.maximum(self.nominal[n : 2 * n], 0.05 * case.kd[self.driven])
        self.scale = np.concatenate([self.nominal[:n], usual, rub, np.full(n, 0.03), [0.003]])
        self.recorded = []
        for r in case.recordings:
            t = np.arange(0.0, min(_SECONDS, r.time[-1]), _STEP)
            asked, seen = (
                np.column_stack([np.interp(t, r.time, r.signals[key][:, i]) for i in range(len(case.drives))])
                for key in ("position_reference", "position")
            )
            self.recorded.append((t, asked, seen))
        self.rows = sum(len(t) for t, *_ in self.recorded) * n

    def cost(self, x: np.ndarray) -> float:
        """Mean square of position errors [rad^2 or m^2], each drive over its own motion."""
        n, m = len(self.driven), self.model
        arm, damp, rub, bias, late = *np.split(x[: 4 * n], 4), x[-1]
        places = m.tendon_armature, m.tendon_damping, m.tendon_frictionloss
        if not self.tendons:
            places = m.dof_armature, m.dof_damping, m.dof_frictionloss
        for place, values in zip(places, (arm, damp, rub), strict=True):
            if place.ndim == 2:
                place[self.driven, 0] = values
            else:
                place[self.driven] = values
        total = 0.0
        for t, asked, seen in self.recorded:
            delayed = np.column_stack([np.interp(t - late, t, asked[:, i]) for i in self.driven]) - bias
            start = np.linalg.solve(self.couple, seen[0])
            state = np.concatenate([[0.0], start, np.zeros(m.nv)])
            out, _ = rollout.rollout(m, self.data, state[None], delayed[None])
            angle = (out[0, :, 1 : 1 + m.nq] - 0.5 * _STEP * out[0, :, 1 + m.nq :]) @ self.couple.T
            error = (angle[:-1] - seen[1:])[:, self.driven] + bias
            total += float(np.sum(np.mean(error**2, axis=0) / np.var(asked[:, self.driven], axis=0)))
        return total if math.isfinite(total) else 1e6


def solve(case: Case) -> Answer:
    """Fits, then puts each number back."""
    loop = Loop(case)
    n = len(loop.driven)
    least = np.concatenate([0.1 * loop.nominal[:n], np.zeros(2 * n), np.full(n, -0.3), [0.0]])
    most = np.concatenate([4 * loop.nominal[:n], np.full(2 * n, np.inf), np.full(n, 0.3), [0.02]])
    most[n : 3 * n] = loop.nominal[n : 3 * n] + 8 * loop.scale[n : 3 * n]

    def at(z: np.ndarray) -> np.ndarray:
        return np.clip(loop.nominal + loop.scale * z, least, most)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        search = cma.CMAEvolutionStrategy(
            np.zeros(4 * n + 1), 0.4, {"seed": 1, "maxfevals": _WORK, "verbose": -9, "tolfun": 1e-9}
        )
        while not search.stop():
            tried = search.ask()
            search.tell(tried, [loop.cost(at(z)) for z in tried])
    fitted = at(search.result.xbest)
    best = loop.cost(fitted)
    named = []
    for k in range(4 * n + 1):
        back = fitted.copy()
        back[k] = loop.nominal[k]
        if loop.cost(back) < _MATTERS * best or abs(fitted[k] - loop.nominal[k]) < 0.1 * loop.scale[k]:
            continue
        move, none = float(fitted[k] - loop.nominal[k]), math.nan
        if k == 4 * n:
            named.append(Named("command_delay", None, {"time": (move, none, none)}))
        else:
            effect, name = _EFFECTS[k // n]
            named.append(Named(effect, case.drives[loop.driven[k % n]], {name: (move, none, none)}))
    return Answer("missing_effect" if named else "consistent", tuple(named))
