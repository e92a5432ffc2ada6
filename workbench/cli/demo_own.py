"""``workbench demo MODEL``: hide an effect in one's own machine, and see whether experiments find it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.core import InputError
from workbench.core.files import together

from .hidden import hidden_in
from .record_own import experiments_of

if TYPE_CHECKING:
    from workbench.core import Recording
    from workbench.models import Model
    from workbench.rigs import HiddenIn, OwnExperiment

_SECONDS = 6.0


def record_hidden(
    name: str, designs: Sequence[str], folder: Path, hidden: tuple[str | None, Sequence[str] | None],
    options: tuple[int, bool, bool], say: Callable[[str], Any],
) -> tuple[Model, list[str], list[HiddenIn]]:  # fmt: skip
    """Records a model's own hardware with something hidden in it.

    Args:
        name: of the model.
        designs: files of experiments; two multisines that fit the model's limits where none is named.
        folder: where recordings go.
        hidden: effect and parameters as the command line has them; drawn where none is named.
        options: seed, whether nothing is hidden, whether files are written over.
        say: told what is done.

    Returns:
        The model that has to explain the recordings, their files (the last of several judges), the effects.

    Raises:
        InputError: a model that no recording of its machine can be held against, or hardware that cannot be.
    """
    from workbench.effects import load_model
    from workbench.importing import described, own_rig
    from workbench.recordings import save_recording

    seed, clean, force = options
    model = _as_its_mechanism(load_model(name), say)
    experiments = [each for text in designs for each in experiments_of(Path(text), model)]
    experiments = experiments or _planned(model, seed)
    effects = [] if clean else hidden_in(*hidden) or [_drawn(model, experiments[0], seed)]
    rig = own_rig(model, effects, seed)
    say(described(model))
    say(
        f"{'Nothing' if clean else 'Something'} is hidden in it; {len(experiments)} experiments are recorded."
    )
    files = [folder / "recordings" / f"{experiment.name}.toml" for experiment in experiments]
    with together():
        for number, (experiment, file) in enumerate(zip(experiments, files, strict=True)):
            save_recording(rig.run(experiment, number), file, compress=True, force=force)
    return model, list(map(str, files)), effects


def _as_its_mechanism(model: Model, say: Callable[[str], Any]) -> Model:
    """The model whose structure is the mechanism's, so that nothing but what is hidden is missing; without a
    loop of its own it has that of the position actuators in its file.

    Raises:
        InputError: it has no loop.
    """
    from workbench.core import Controller
    from workbench.models import servos_of
    from workbench.s3n.variants import with_variant

    if model.controller.kind != "pd":
        servos = servos_of(model)
        if servos is None:
            raise InputError(
                "the model has no PD loop, and nothing holds the machine", file=model.source,
                column="controller", remedy="give it a [controller], as docs/models.md shows",
            )  # fmt: skip
        loop = Controller("pd", "joint", servos.kp, servos.kd, period_s=servos.step)
        model = replace(model, controller=loop)
        say("The loop is that of the position actuators in the model's file.")
    if model.linkage is not None and model.variant != "exact":
        say(f"The model is taken as variant exact, not {model.variant}: its linkage is known here.")
        return with_variant(model, "exact")
    return model


def _planned(model: Model, seed: int) -> list[OwnExperiment]:
    """Multisines of all axes about the middle of the ranges, scaled to the limits; one of them to judge."""
    from workbench import frf
    from workbench.simulation import held_posture, limits_of, predictor, whole_period

    from .record_own import played

    length = whole_period(model, _SECONDS, 1000.0)
    design = frf.multisine(
        model.axes, name="planned", period_s=length, rms=3.0, f_min_hz=1.0 / length, f_max_hz=20.0,
        rate_hz=1000.0, hold=held_posture(model, {}), mixing="orthogonal", periods=1, transient_periods=0,
        realisations=2, phases="random", driven="torque_feedforward", seed=seed,
    )  # fmt: skip
    limits = limits_of(model, None)
    scaled = frf.scale_to_limits(design, predictor(model, limits), limits)
    return played(scaled.design, model)


def _drawn(model: Model, experiment: OwnExperiment, seed: int) -> HiddenIn:
    from workbench.importing import own_rig
    from workbench.rigs import draw_own

    rig = own_rig(model, (), seed)
    run: Recording = rig.run(experiment)
    return draw_own(rig.machine, run, seed)
