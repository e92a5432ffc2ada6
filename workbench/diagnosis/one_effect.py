"""Fit of one effect that the user chooses, whatever a search finds."""

from __future__ import annotations

from collections.abc import Sequence

from workbench.comparison import matched
from workbench.core import EffectKey, InputError, Recording
from workbench.effects import Compliance, effect_named, kinds
from workbench.models import AppliedEffect, Model
from workbench.report.wording import effect_phrase
from workbench.s3n import off_drives, on_drives

from .data import gather
from .fitting.fit import fit
from .fitting.refinement import converged, with_candidate
from .moves.grid_refinement import refined_on_grid
from .problem import Progress, starting_fit
from .screening.compliance import compliance_candidates
from .screening.sensitivity import Linearisation
from .screening.stiction import candidates


def fit_effect(
    model: Model,
    recordings: Sequence[Recording],
    key: EffectKey,
    *,
    seed: int = 0,
    progress: Progress = lambda text: None,
) -> tuple[AppliedEffect, Model]:
    """Fit one effect to recordings, without any test.

    Args:
        model: what it is added to; nothing else in it changes.
        recordings: what to fit.
        key: the effect and its place.
        seed: of the noise simulations.
        progress: told what is being done.

    Returns:
        The effect with its estimates, and the model with it.

    Raises:
        InputError: recordings that do not fit the model, or an effect that these cannot start a fit of.
        SimulationError: the model is unstable in a recording's loop.
    """
    given, model = model, on_drives(model)
    recordings = matched(model, recordings)
    progress("simulating the model and its noise")
    data, simulated = gather(model, recordings, (), seed)
    start = starting_fit(model, data, simulated.clean)
    linearisation = Linearisation.of(model, data, start.simulated, len(data.recordings))
    progress(f"looking for values of {effect_phrase(key)} to start from")
    tried = (
        compliance_candidates(linearisation, start.test_loss)
        if isinstance(effect_named(key.effect), Compliance)
        else candidates(linearisation, start, data, seed)
    )
    candidate = next((c for c in tried if c.key == key), None)
    if candidate is None:
        raise InputError(
            f"{effect_phrase(key)} does not lower the error on these recordings",
            remedy="choose another effect, or recordings in which it would show",
        )
    hypothesis = with_candidate(linearisation, candidate, start)
    if hypothesis.parameter_free:
        return hypothesis.parameter_free[-1], off_drives(hypothesis.model, given)
    progress(f"fitting {effect_phrase(key)}")
    found = fit([hypothesis], data)[0]
    if found is None:
        raise InputError(f"the model does not run with {effect_phrase(key)}", remedy="choose another effect")
    if kinds.diverges(effect_named(key.effect)):
        progress(f"trying sizes of {effect_phrase(key)}")
    found = refined_on_grid(converged(found, data), data)
    return found.hypothesis.free[-1], off_drives(found.hypothesis.model, given)
