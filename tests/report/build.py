"""Results made by hand: a leg of two axes whose knee drive has Coulomb friction that the model lacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.core import (
    Comparison,
    Diagnosis,
    EffectKey,
    Estimate,
    Finding,
    Improvement,
    InverseDynamics,
    Recording,
    RecordingError,
    Shape,
    Share,
    Step,
    Tried,
)

AXES = ("hip", "knee")
NOISE = {"position": 2e-4, "torque_measured": 0.03}
FRICTION = EffectKey("coulomb_friction", "knee")
GAIN = EffectKey("torque_gain", "hip")
DAMPING = EffectKey("viscous_damping", "knee", "joint")
TRUTH = [
    {"effect": "coulomb_friction", "axis": "knee", "parameters": {"torque": {"value": 0.255, "unit": "N*m"}}},
    {"effect": "torque_gain", "axis": "hip", "parameters": {"gain": 0.93}},
    {"effect": "delay", "axis": None, "parameters": {}},
]


def recording_pair(name: str, modelled: float, seconds: float, rate: float, seed: int) -> RecordingError:
    """A measured chirp with friction of 0.25 on the knee, and its simulation with `modelled` of it."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate)
    sweep = 2 * np.pi * (0.3 * t + 0.5 * (6 - 0.3) / seconds * t**2)
    q = np.stack([0.4 * np.sin(sweep), 0.6 * np.sin(0.8 * sweep + 0.5)], axis=1)
    v = np.gradient(q, t, axis=0)
    torque = 0.2 * v + 2.0 * q + np.array([0.5, -0.3])
    missing = np.stack([0 * t, 0.25 * np.tanh(v[:, 1] / 0.02)], axis=1)
    measured = {
        "position": q + 0.01 * missing + rng.normal(0, NOISE["position"], q.shape),
        "velocity": v,
        "torque_measured": torque + missing + rng.normal(0, NOISE["torque_measured"], q.shape),
    }
    part = modelled / 0.25 * missing
    simulated = {
        "position": q + 0.01 * part,
        "velocity": v,
        "torque_command": torque,
        "torque_measured": torque + part,
    }
    common = {"axes": AXES, "coordinates": "actuator", "time": t, "units": ("rad", "rad")}
    valid = np.ones(len(t), bool)
    valid[len(t) // 2 : len(t) // 2 + len(t) // 50] = False
    real = Recording(name=name, signals=measured, valid=valid, **common)
    model = Recording(name=name, signals=simulated, **common)
    size = {s: np.sqrt(np.mean((measured[s] - simulated[s]) ** 2, axis=0)) for s in NOISE}
    score = float(np.sqrt(np.mean([(size[s] / measured[s].std(axis=0)) ** 2 for s in NOISE])))
    floor = float(np.sqrt(np.mean([(NOISE[s] / measured[s].std(axis=0)) ** 2 for s in NOISE])))
    return RecordingError(
        recording=real,
        simulated=model,
        position_rmse=size["position"],
        torque_rmse=size["torque_measured"],
        position_noise=np.full(2, NOISE["position"]),
        torque_noise=np.full(2, NOISE["torque_measured"]),
        error=score,
        noise_error=floor,
    )


def comparison(
    modelled: float, seconds: float = 12.0, rate: float = 500.0, names=("chirp_hip", "chirp_knee")
) -> Comparison:
    entries = tuple(recording_pair(n, modelled, seconds, rate, seed) for seed, n in enumerate(names))
    error = float(np.sqrt(np.mean([e.error**2 for e in entries])))
    noise = float(np.sqrt(np.mean([e.noise_error**2 for e in entries])))
    where = (
        Share("knee", "torque_measured", "speed", (-0.5, 0.5), "rad/s", 0.64),
        Share("knee", "torque_measured", "speed", (0.5, 2.0), "rad/s", 0.21),
        Share("knee", "torque_measured", "position", (-0.1, 0.3), "rad", 0.35),
        Share("knee", "position", "frequency", (0.3, 2.0), "Hz", 0.55),
        Share("hip", "torque_measured", "frequency", (2.0, 6.0), "Hz", 0.04),
        Share("knee", "torque_measured", "time", (0.0, 4.0), "s", 0.42),
    )
    return Comparison(
        model="leg",
        axes=AXES,
        recordings=entries,
        error=error,
        noise_error=noise,
        noise_error_std=0.02 * noise,
        consistent=modelled == 0.25,
        where=() if modelled == 0.25 else where,
        inverse_dynamics=InverseDynamics(0.213, np.array([0.04, 0.29]), "zero-phase low-pass, 20 Hz"),
        notes=("velocity of chirp_hip derived from position",),
    )


def parameters() -> dict[str, Estimate]:
    return {"torque": Estimate(0.2541, 0.0016, "N*m")}


def diagnosis(seconds: float = 12.0, rate: float = 500.0) -> Diagnosis:
    before, after = comparison(0.0, seconds, rate), comparison(0.25, seconds, rate)
    finding = Finding(
        key=FRICTION,
        parameters=parameters(),
        error_after=after.error,
        holdout_error_before=0.201,
        holdout_error_after=0.0312,
        probability=0.973,
        indistinguishable_from=(EffectKey("coulomb_friction", "knee", "joint"),),
        evidence=(
            "The knee torque residual is odd in speed and jumps by 0.51 N m at zero speed.",
            "Its size does not change with speed from 0.1 to 6 rad/s.",
        ),
    )
    return Diagnosis(
        model="leg",
        verdict="missing_effect",
        error=before.error,
        noise_error=before.noise_error,
        findings=(finding,),
        unexplained_fraction=0.02,
        where=(Share("hip", "position", "time", (0.0, 0.5), "s", 0.7),),
        next_experiment="Move the knee slowly, at 0.05 rad/s, through its whole range: friction at the "
        "drive and at the joint then differ by the lever arm.",
        not_excited=(EffectKey("backlash", "hip"), EffectKey("thermal_derating", None)),
        ranking=((FRICTION, 0.98), (DAMPING, 0.41), (EffectKey("cogging", "knee"), 0.08), (GAIN, 0.011)),
        before=before,
        after=after,
        trace=tried(),
    )


def tried() -> tuple[Tried, ...]:
    """A friction taken at once, and a start that led nowhere."""
    first = Tried(
        "one effect after the other", (), ((FRICTION, ((FRICTION, 0.98), (DAMPING, 0.41))),), (FRICTION,),
        (7.1, 1.02), 0.98, 1, True, "it explains the recordings",
    )  # fmt: skip
    gap = EffectKey("backlash", "hip")
    other = Tried(
        "a gap or soft joint that explains the residual torque", (FRICTION,), ((gap, ()),), (FRICTION, gap),
        (1.02, 3.4), 0.8, 3, False, "it explains 80 % of the squared error above the noise",
    )  # fmt: skip
    return first, other


def unexplained() -> Diagnosis:
    """A stop on the hip and a tone on the knee that no effect explains."""
    grid = np.linspace(-1.0, 1.0, 41)
    stop = np.where(grid > 0.2, 2.0 * (grid - 0.2), 0.0)
    seen = np.where(np.arange(41) == 7, np.nan, stop + 0.01)
    spring = Shape("hip", ("position",), ("rad",), "N m", 0.973, grid, stop, np.full(41, 0.02), seen)
    cycle = 0.3 * np.cos(2 * np.pi * 3.7 * (grid + 1.0))
    tone = Shape(
        "knee", ("time",), ("s",), "N m", 0.61, grid + 1.0, cycle, np.full(41, 0.03), cycle, frequency=3.7
    )
    both = replace(spring, axis="knee", quantities=("position", "the position of hip"), units=("rad", "rad"))
    found = diagnosis()
    return replace(found, verdict="unexplained", findings=(), shapes=(spring, tone, both), after=None)


def held_out(fitted: Comparison) -> Comparison:
    """As if it were of another recording."""
    first = fitted.recordings[0]
    return replace(
        fitted, recordings=(replace(first, recording=replace(first.recording, name="walk, held out")),)
    )


def improvement(seconds: float = 12.0, rate: float = 500.0) -> Improvement:
    found = diagnosis(seconds, rate)
    assert found.before and found.after
    last = found.after.error
    steps = (
        Step(
            FRICTION,
            parameters(),
            0.4 * found.error,
            0.0864,
            found.findings[0].indistinguishable_from,
            found.findings[0].evidence,
        ),
        Step(
            GAIN,
            {"gain": Estimate(0.931, 0.0042, "1")},
            last,
            0.0312,
            evidence=("The hip torque residual is proportional to the torque.",),
            removed=(DAMPING,),
        ),
    )
    return Improvement(
        model="leg",
        steps=steps,
        error_before=found.error,
        error_after=last,
        holdout_error_before=0.201,
        holdout_error_after=0.0312,
        noise_error=found.noise_error,
        verdict="consistent",
        before=found.before,
        after=found.after,
        held_out=(held_out(found.before), held_out(found.after)),
        diagnosis=found,
        holdout_noise_error=0.0303,
    )
