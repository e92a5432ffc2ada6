"""``workbench train``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

from workbench.core import InputError

from . import complete, options
from .common import check_outputs, echo, files_of, write_result, wrote
from .heartbeat import duration
from .progress import progress

if TYPE_CHECKING:
    from workbench.training.learn import Progress


def train(
    task: Annotated[
        str,
        Argument(
            metavar="TASK",
            help="reach, pitch-in-place or circular; or a task file of your own (.toml, .py).",
            autocompletion=complete.tasks,
        ),
    ],
    output: Annotated[
        str,
        options.written("--output", "-o", folder=True, metavar="RUN", help="Folder of the run.  [required]"),
    ] = "",
    model: Annotated[
        str | None,
        Option(
            metavar="MODEL",
            help="Model of the limb; default: that of the record, otherwise leg.",
            autocompletion=complete.models,
        ),
    ] = None,
    variant: Annotated[
        str | None,
        Option(
            metavar="NAME",
            help="kin_only, s3n_act, s3n_full, exact, or explicit (added torques); default: the model's.",
            autocompletion=complete.variants,
        ),
    ] = None,
    envs: Annotated[int, Option(min=2, help="Number of parallel simulated worlds.")] = 256,
    iterations: Annotated[
        int | None, Option(min=1, help="Total PPO iterations; default: the task's.")
    ] = None,
    seed: Annotated[int, Option(min=0, help="Seed of all random numbers.")] = 0,
    device: Annotated[str, Option(help="cpu, cuda or cuda:N.", autocompletion=complete.devices)] = "cpu",
    legs: Annotated[
        str | None,
        Option(
            help="Randomise link properties per world: none, leg_rand, heavy_leg_rand; default: the task's.",
            autocompletion=complete.legs,
        ),
    ] = None,
    stiff: Annotated[
        bool,
        Option(
            "--stiff-contact",
            help="Stiff feet of a quadruped: contact time constant 6 ms, not MuJoCo's 20 ms.",
        ),
    ] = False,
    save_every: Annotated[int, Option(min=1, help="Iterations between checkpoints.")] = 50,
    threads: Annotated[int, Option(min=0, help="Threads of the simulation; 0: all cores.")] = 0,
    logger: Annotated[
        str,
        Option(
            help="Show the learning curve in tensorboard, wandb (Weights & Biases) or none.",
            autocompletion=complete.loggers,
        ),
    ] = "tensorboard",
    resume: Annotated[bool, Option("--resume", help="Continue the run in the folder.")] = False,
    record: Annotated[
        str | None, Option(metavar="FILE", help="The model's verification record; default: beside its file.")
    ] = None,
    unverified: Annotated[
        bool, Option("--unverified", help="Train in a model that was not compared with measurements.")
    ] = False,
    json: options.Json = None,
    force: options.Force = False,
    quiet: options.Quiet = False,
) -> None:
    """Train a policy in the normalised simulator, and write it as a bundle into the run's folder.

    The model has to have a verification record (`workbench approve`). For several processes use torchrun.

    Example: workbench train reach --variant s3n_full --unverified -o runs/reach
    """
    from workbench.effects import load_model
    from workbench.training.loggers import check_logger
    from workbench.training.machine import STEP_S, make_machine
    from workbench.training.randomisation import LEG_RANDOMISATION
    from workbench.training.record import model_of, objections, read_record, record_path, summary
    from workbench.training.settings import Settings
    from workbench.training.task_file import load_task, posed
    from workbench.training.tasks import TASKS
    from workbench.training.tried import try_task

    own = task.endswith((".toml", ".py"))
    if not own and task not in TASKS:
        raise InputError(
            f"no task is called '{task}'",
            remedy=f"choose one of {', '.join(TASKS)}, or give a task file (.toml, .py)",
        )
    if not output:
        raise InputError("no folder for the run", remedy="name one: -o runs/reach")
    check_outputs(json, force=force)
    check_logger(logger)
    if legs is not None and legs not in LEG_RANDOMISATION:
        raise InputError(
            f"no range is called '{legs}'", remedy=f"choose one of {', '.join(LEG_RANDOMISATION)}"
        )
    try:
        from workbench.training.device import usable
        from workbench.training.export import export
        from workbench.training.learn import learn

        device = usable(device)
    except ImportError as error:
        raise InputError(
            f"training needs {error.name}",
            remedy="install the extra: pip install 'robot-workbench[training]'",
        ) from error
    shown = not quiet and json != "-"
    wanted = load_task(Path(task)) if own else TASKS[task]
    legs = legs or wanted.randomisation
    stated = read_record(Path(record)) if record else None
    if model is None and record and stated is not None:
        model = model_of(stated, Path(record))
    loaded = load_model(model or "leg")
    variant = variant or loaded.variant
    file = Path(record) if record else record_path(loaded)
    known = read_record(file)
    against = objections(known, loaded, variant)
    if known is not None and shown:
        echo(f"{file.name}: {summary(known)}.")
    if against and not unverified:
        raise InputError(
            "; ".join(against), file=file,
            remedy="make it with `workbench approve`, or train with --unverified",
        )  # fmt: skip
    machine = posed(wanted, make_machine(wanted.machine, loaded, variant, stiff=stiff))
    if wanted.suffix == ".py":
        try_task(wanted, machine, Path(task))
    if machine.floating and shown:
        echo(f"The quadruped is the reference trunk on four legs of {loaded.name}.")
    if machine.left_out and shown:
        echo(f"Not in the simulation: {', '.join(machine.left_out)}.")
    if machine.delay_steps != 1 and shown:
        echo(
            "`deploy` will refuse this policy: a loop over CAN delays every torque by one step, the model "
            f"by {machine.delay_steps}. If you will deploy it, first give the model delay_s = {STEP_S:g}."
        )
    settings = Settings(
        worlds=envs,
        iterations=iterations or wanted.iterations,
        seed=seed,
        device=device,
        save_every=save_every,
        threads=threads,
        randomisation=wanted.differences(legs),
    )
    folder = Path(output)
    last: list[Progress] = []
    with progress(quiet) as tell:

        def told(p: Progress) -> None:
            last[:] = [p]
            tell(
                f"iteration {p.iteration} of {p.iterations}, reward {p.reward:.2f} per second, "
                f"{p.steps_per_s:,.0f} steps/s, {duration(p.left_s)} left"
            )

        done = learn(
            wanted, machine, settings, folder,
            extra={"record": known if not against else None, "unverified": against},
            resume=resume, force=force, logger=logger, tell=told,
        )  # fmt: skip
    if done is None:  # another process of several
        return
    bundle = export(folder, folder / "bundle.zip", force=force or resume)
    if json:
        from .export import bundle_dict

        names = "reward", "episode_reward", "episode_s"
        content = {
            "format": 1,
            "run": str(folder),
            **bundle_dict(bundle),
            "model": loaded.name,
            "unverified": against,
            "left_out": machine.left_out,
            **{name: getattr(last[0], name) if last else None for name in names},
        }
        read = [*files_of(loaded), *([file] if known is not None else [])]
        write_result(content, json, files=read, seeds={"training": seed}, force=force)
    if shown:
        wrote(f"Trained {settings.iterations} iterations; wrote {bundle}.")
