"""The whole way round: identify, deploy over CAN, log, diagnose, add what was found, train again, deploy.

    python analyses/closed_loop.py --out out/closed_loop                     # the shipped policy throughout
    python analyses/closed_loop.py --out out/closed_loop --iterations 200    # one trained in each model

The leg hides friction, play and a wrong torque constant. In every round a `reach` policy drives it over the
virtual CAN bus, the frames on the bus become a recording, and the round's model is compared with it: gap and
noise are `compare`'s error and what a perfect model would leave. Between rounds `improve` gets other
recordings of the leg, none of a policy. As the shipped policy was not trained in these models, `--iterations`
trains one in each.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from transfer_bus import deployed
from transfer_identification import find_effects, identify_plant
from transfer_plants import SETS, reference_leg
from transfer_policies import POLICIES
from transfer_tables import show, spread, write_csv

from workbench import compare, report
from workbench.bundle import PolicyBundle, read_bundle
from workbench.core.palette import COLOURS
from workbench.models import Model, read_model


@dataclass(frozen=True)
class Round:
    """One model and its policy on the leg; a number a seed of noise and trajectory.

    Attributes:
        name: of the model.
        found: what it has beyond the first round's, as text.
        gap, noise: `Comparison.error` of the log and what a perfect model would have (S,).
        position, torque: RMSE over both axes, actuator coordinates (S,) [rad, N m].
        faults: what ended runs early.
    """

    name: str
    found: tuple[str, ...]
    gap: np.ndarray
    noise: np.ndarray
    position: np.ndarray
    torque: np.ndarray
    faults: tuple[str, ...]


def main(arguments: Sequence[str] | None = None) -> list[Round]:
    """Two rounds and Kin-Only for comparison; print, write, draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/closed_loop"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--trials", type=int, default=3, help="runs of each policy")
    parser.add_argument("--set", choices=list(SETS), default="hidden effects", help="what the leg hides")
    parser.add_argument("--models", type=Path, help="models that chirp_response.py identified; else anew")
    parser.add_argument("--iterations", type=int, default=0, help="of PPO in each round's model; 0: none")
    parser.add_argument("--quick", action="store_true", help="the clean leg, one short run")
    given = parser.parse_args(arguments)
    which = "clean" if given.quick else given.set
    trials, seconds = (1, 2.0) if given.quick else (given.trials, 6.0)
    models = _models(which, given.seed, given.models, given.quick)
    shipped = read_bundle(POLICIES / "reach_s3n_full.zip")
    rounds = []
    for name, model in models.items():
        policy = shipped
        if given.iterations and name != "Kin-Only":
            policy = trained(model, given.iterations, given.seed, given.out / f"run_{len(rounds)}")
        rounds.append(
            deploy_round(name, model, models["S3N-Full"], policy, which, trials, seconds, given.seed)
        )
    rows = [
        (r.name, ", ".join(r.found), spread(r.gap, 3), spread(r.noise, 3), spread(r.gap / r.noise, 2),
         spread(r.position, 2, 1e3), spread(r.torque, 3), ", ".join(r.faults) or "none")
        for r in rounds
    ]  # fmt: skip
    columns = ("model", "found", "gap", "noise", "gap / noise", "position [mrad]", "torque [N m]", "faults")
    policies = f"trained for {given.iterations} iterations" if given.iterations else "the shipped one"
    title = f"Policy over CAN, {which}: {trials} runs of {seconds:g} s, policy: {policies}"
    show(given.out, "closed_loop", title, columns, rows)
    write_csv(given.out / "closed_loop.csv", [
        {"model": r.name, "run": k, "gap": float(r.gap[k]), "noise": float(r.noise[k])}
        for r in rounds for k in range(trials)
    ])  # fmt: skip
    report.save_figure(figure(rounds), given.out / "closed_loop.png", force=True)
    print(f"Wrote {given.out}.")
    return rounds


def _models(which: str, seed: int, folder: Path | None, quick: bool) -> dict[str, Model]:
    if folder is not None:
        names = {"Kin-Only": "kin_only", "S3N-Full": "s3n_full", "S3N + found effects": "found"}
        slug = which.replace(" ", "_")
        return {name: read_model(folder / f"{slug}_{file}.toml") for name, file in names.items()}
    plant = reference_leg(which, seed)
    known = identify_plant(plant)
    _, better = find_effects(plant, known, quick)
    return {
        "Kin-Only": known.variant("kin_only"),
        "S3N-Full": known.variant("s3n_full"),
        "S3N + found effects": better,
    }


def trained(model: Model, iterations: int, seed: int, folder: Path) -> PolicyBundle:
    """A `reach` policy trained in a model as the command line trains it."""
    from workbench.training.export import export
    from workbench.training.learn import learn
    from workbench.training.machine import make_machine
    from workbench.training.settings import Settings
    from workbench.training.tasks import TASKS

    task = TASKS["reach"]
    settings = Settings(
        worlds=256, iterations=iterations, seed=seed, device="cpu", save_every=iterations, threads=0,
        randomisation=task.differences(),
    )  # fmt: skip
    learn(
        task,
        make_machine(task.machine, model),
        settings,
        folder,
        extra={"record": None, "unverified": ["virtual"]},
    )
    return read_bundle(export(folder, folder / "bundle.zip", force=True))


def deploy_round(
    name: str,
    model: Model,
    first: Model,
    policy: PolicyBundle,
    which: str,
    trials: int,
    seconds: float,
    seed: int,
) -> Round:
    """Deploy, log, compare."""
    gaps, faults = [], []
    for k in range(trials):
        log, fault = deployed(policy, SETS[which], seconds, seed + k)
        found = compare(model, [log])
        entry = found.recordings[0]
        sizes = (float(np.sqrt(np.mean(np.square(x)))) for x in (entry.position_rmse, entry.torque_rmse))
        gaps.append((found.error, found.noise_error, *sizes))
        faults += [fault] if fault else []
    own = {e.key for e in first.effects}
    added = tuple(str(e.key) for e in model.effects if e.key not in own)
    gap, noise, position, torque = np.array(gaps).T
    return Round(name, added, gap, noise, position, torque, tuple(faults))


def figure(rounds: Sequence[Round]) -> Figure:
    """The gap of every run, round by round, and the noise."""
    with report.house_style():
        made = Figure(figsize=(7.2, 2.2), layout="constrained")
        a = made.subplots()
        for y, r in enumerate(rounds):
            a.plot(
                r.noise,
                [y] * len(r.noise),
                "|",
                color=COLOURS["noise"][0],
                ms=16,
                mew=1.5,
                label="noise alone",
            )
            a.plot(r.gap, [y] * len(r.gap), "o", color=COLOURS["after"][0], ms=5, label="gap")
        a.set_yticks(range(len(rounds)), [r.name for r in rounds])
        a.set_ylim(len(rounds) - 0.5, -0.5)
        a.set_xlim(left=0.0)
        a.set_xlabel("error of the policy's log (RMSE / deviation of the signal)")
        handles, labels = a.get_legend_handles_labels()
        made.legend(handles[:2], labels[:2], loc="outside upper left", ncols=2)
    return made


if __name__ == "__main__":
    main()
