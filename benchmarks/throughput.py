"""Physics steps per second of the quadruped that trains: kin-only, S3N, and closed by constraints.

    python benchmarks/throughput.py                        # on the CPU, MuJoCo's batch
    python benchmarks/throughput.py --write DIR            # writes the machines as plain MJCF, to carry
    python benchmarks/throughput.py --machines DIR --gpu   # there; needs mujoco, mujoco_warp, warp and numpy
    python benchmarks/throughput.py --parts                # what each part of S3N-Full costs: without it

All machines are timed one after the other in each round, in an order that is drawn, so that what slows a
computer down slows them all. Told is the median over rounds with its 95 % interval (by resampling rounds),
and the same of the ratio to kin-only within rounds. All stand, held by the torques that a PD loop came to,
and are put there again every 50 steps: contacts are alike in all of them.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np

VARIANTS = "kin_only", "s3n_act", "s3n_full", "exact"
CLOSED = "constraints"
#: A machine of `--parts` -> what of S3N-Full it lacks, as elements of the MJCF and their attributes.
PARTS = {
    "no weight compensation": (("body", "gravcomp"),),
    "no inertia on tendons": (("fixed", "armature"),),
    "no damping on tendons": (("fixed", "damping"),),
    "none of the three": (("body", "gravcomp"), ("fixed", "armature"), ("fixed", "damping")),
}
_AGAIN = 50  # steps
_DRAWS = 2000

Standing = tuple[list[float], list[float]]


def machines() -> dict[str, tuple[str, Standing]]:
    """MJCF of every machine, and qpos and ctrl in which it stands."""
    from workbench.models import read_model
    from workbench.training.machine import make_machine

    model, out = read_model("leg"), {}
    for variant in VARIANTS:
        made = make_machine("quadruped", model, variant)
        qpos = np.array(made.mujoco.qpos0)
        qpos[made.places] = made.posture
        qpos[2] = made.height
        back = np.linalg.inv(made.transmission)
        gains = made.places, made.dofs, made.posture, back
        out[variant] = made.xml, _settled(made.mujoco, qpos, *gains)
    out[CLOSED] = _closed()
    return out


def _settled(
    m: mujoco.MjModel, qpos: np.ndarray, places: np.ndarray, dofs: np.ndarray, target: np.ndarray,
    back: np.ndarray,
) -> Standing:  # fmt: skip
    """Where a machine comes to rest under a PD loop, and the torques there."""
    data = mujoco.MjData(m)
    data.qpos[:] = qpos
    for _ in range(600):
        error, speed = target - data.qpos[places], data.qvel[dofs]
        data.ctrl[:] = (50.0 * error - 1.5 * speed) @ back
        mujoco.mj_step(m, data)
    return data.qpos.tolist(), data.ctrl.tolist()


def _closed() -> tuple[str, Standing]:
    """The same with its four linkages as they are, each loop held by a ``connect``."""
    from workbench.models import read_model
    from workbench.s3n.loop import ConstraintSettings, close_loops, loop_spec
    from workbench.s3n.mjcf import exact_xml
    from workbench.training.machine import LEGS, STEP_S, make_machine
    from workbench.training.quadruped import quadruped

    model = read_model("leg")
    own = make_machine("quadruped", model, "exact")
    leg = loop_spec(model, ConstraintSettings())
    leg.option.timestep, leg.option.integrator = STEP_S, own.mujoco.opt.integrator
    single = leg.compile()
    angles = own.posture[1:3]
    theta, _ = close_loops(single, model, angles, np.zeros(2))
    assert model.closed_chain is not None
    for name, limit in zip(model.closed_chain.drives, model.actuators.torque_limit, strict=True):
        motor = leg.add_actuator(name=name)
        motor.set_to_motor()
        motor.trntype, motor.target = mujoco.mjtTrn.mjTRN_JOINT, name
        motor.ctrllimited, motor.ctrlrange = 1, (-limit, limit)
    spec = quadruped(leg, model)
    m = spec.compile()
    qpos = np.array(m.qpos0)
    qpos[2] = own.height
    for name in LEGS:
        for j in range(single.njnt):
            place = m.joint(f"{name}_{single.joint(j).name}").qposadr[0]
            qpos[place] = theta[single.jnt_qposadr[j]]
    drives = [m.actuator(k).trnid[0] for k in range(m.nu)]
    places, dofs = m.jnt_qposadr[drives], m.jnt_dofadr[drives]
    return exact_xml(spec), _settled(m, qpos, places, dofs, qpos[places], np.eye(m.nu))


def parts(made: dict[str, tuple[str, Standing]]) -> dict[str, tuple[str, Standing]]:
    """Kin-Only, S3N-Full, and S3N-Full without one of its parts each, begun alike."""
    xml, stands = made["s3n_full"]
    out = {name: made[name] for name in ("kin_only", "s3n_full")}
    for name, lacks in PARTS.items():
        root = ElementTree.fromstring(xml)
        for tag, attribute in lacks:
            for element in root.iter(tag):
                element.attrib.pop(attribute, None)
        out[name] = ElementTree.tostring(root, encoding="unicode"), stands
    return out


def cpu(xml: str, stands: Standing, worlds: int, steps: int) -> Callable[[], float]:
    """A function that takes `steps` steps of all worlds and gives physics steps per second of one core."""
    from mujoco.batch import Batch

    m = mujoco.MjModel.from_xml_string(xml)
    batch = Batch(m, worlds, 1)
    position, velocity, torque = batch.bind("qpos"), batch.bind("qvel"), batch.bind("ctrl")
    start = np.array(stands[0])

    def run() -> float:
        spent = 0.0
        for k in range(steps):
            if k % _AGAIN == 0:
                position[:], velocity[:], torque[:] = start, 0.0, stands[1]
            begun = time.process_time()  # what others do on the computer does not count
            batch.step()
            spent += time.process_time() - begun
        return worlds * steps / spent

    return run


def gpu(xml: str, stands: Standing, worlds: int, steps: int) -> Callable[[], float]:
    """The same in MuJoCo Warp, ten steps a CUDA graph."""
    import mujoco_warp as mjw  # pyright: ignore[reportMissingImports]
    import warp as wp  # pyright: ignore[reportMissingImports]

    mj = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(mj)
    data.qpos[:], data.ctrl[:] = stands
    mujoco.mj_forward(mj, data)
    m, d = mjw.put_model(mj), mjw.put_data(mj, data, nworld=worlds, nconmax=16, njmax=96)
    start = wp.array(np.tile(np.array(stands[0], np.float32), (worlds, 1)), dtype=wp.float32)
    still = wp.zeros((worlds, mj.nv), dtype=wp.float32)
    mjw.step(m, d)
    with wp.ScopedCapture() as capture:
        for _ in range(10):
            mjw.step(m, d)

    graph = capture.graph
    assert graph is not None

    def run(model: object = m) -> float:  # the graph does not hold the arrays of the model
        spent = 0.0
        for k in range(0, steps, 10):
            if k % _AGAIN == 0:
                wp.copy(d.qpos, start)
                wp.copy(d.qvel, still)
            wp.synchronize()
            begun = time.perf_counter()
            wp.capture_launch(graph)
            wp.synchronize()
            spent += time.perf_counter() - begun
        return worlds * steps / spent

    return run


def measured(
    runs: dict[str, Callable[[], float]], rounds: int, tell: Callable[[str], object]
) -> dict[str, np.ndarray]:
    """Steps a second by machine (rounds,), after one round that does not count."""
    generator, out = np.random.default_rng(0), {name: [] for name in runs}
    for number in range(rounds + 1):
        for name in generator.permutation(list(runs)):
            rate = runs[name]()
            if number:
                out[name].append(rate)
        tell(f"round {number} of {rounds}")
    return {name: np.array(values) for name, values in out.items()}


def interval(values: np.ndarray) -> tuple[float, float, float]:
    """Median, and the 95 % interval of it by resampling."""
    drawn = np.random.default_rng(1).integers(0, len(values), (_DRAWS, len(values)))
    low, high = np.percentile(np.median(values[drawn], axis=1), [2.5, 97.5])
    return float(np.median(values)), float(low), float(high)


def main() -> None:
    """Times all machines."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    parser.add_argument("--worlds", type=int, default=0, help="256 on the CPU, 4096 on a GPU")
    parser.add_argument("--steps", type=int, default=200, help="of all worlds, a machine and round")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--gpu", action="store_true")
    parser.add_argument("--only", nargs="*", default=[], metavar="MACHINE")
    parser.add_argument("--write", type=Path, metavar="DIR", help="write the machines and time nothing")
    parser.add_argument("--machines", type=Path, metavar="DIR", help="take them from there")
    parser.add_argument("--parts", action="store_true", help="S3N-Full without each of its parts")
    parser.add_argument("--json", type=Path, metavar="FILE")
    asked = parser.parse_args()
    if asked.machines:
        found = json.loads((asked.machines / "machines.json").read_text())
        made = {k: ((asked.machines / f"{k}.xml").read_text(), stands) for k, stands in found.items()}
    else:
        made = machines()
    if asked.write:
        asked.write.mkdir(parents=True, exist_ok=True)
        for name, (xml, _) in made.items():
            (asked.write / f"{name}.xml").write_text(xml)
        standing = {name: stands for name, (_, stands) in made.items()}
        (asked.write / "machines.json").write_text(json.dumps(standing))
        return
    if asked.parts:
        made = parts(made)
    worlds = asked.worlds or (4096 if asked.gpu else 256)
    chosen = {name: each for name, each in made.items() if not asked.only or name in asked.only}
    make = gpu if asked.gpu else cpu
    runs = {name: make(xml, stands, worlds, asked.steps) for name, (xml, stands) in chosen.items()}
    rates = measured(runs, asked.rounds, lambda text: print(text, end="\r", flush=True))
    print(
        f"{worlds} worlds, {asked.rounds} rounds of {asked.steps} steps, {'GPU' if asked.gpu else 'one core'}"
    )
    print(f"{'machine':24s} {'thousand steps/s':>32s} {'over kin_only':>28s}")
    told = {}
    for name, values in rates.items():
        rate = [x / 1e3 for x in interval(values)]
        ratio = interval(values / rates["kin_only"]) if "kin_only" in rates else (np.nan,) * 3
        told[name] = {"steps_per_s": interval(values), "over_kin_only": ratio}
        print(
            f"{name:24s} {rate[0]:10.1f} ({rate[1]:8.1f} to {rate[2]:8.1f}) "
            f"{ratio[0]:10.3f} ({ratio[1]:.3f} to {ratio[2]:.3f})"
        )
    if asked.json:
        asked.json.write_text(json.dumps(told, indent=1) + "\n")


if __name__ == "__main__":
    main()
