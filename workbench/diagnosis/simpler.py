"""Whether, once all causes are there, a simpler form of one of them will do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from workbench.effects import contains, effect_named

from .data import Data
from .fit import fit
from .hypothesis import Fit
from .judging import TIE
from .refining import polished, with_candidate
from .screen import screen
from .sensitivity import Scene
from .stage import Stage

Progress = Callable[[str], None]


def simpler(stage: Stage, current: Fit, data: Data, progress: Progress) -> Stage | None:
    """A simpler effect in place of one that was chosen while other causes were missing; None where it fails.

    What a refinement had more than its special case may have been the shape of what came later.

    Args:
        stage: the effect in question, as it was found.
        current: the last fit, with it and all that came later.
        data: recordings, with the noise floor of that model.
        progress: told what is being done.

    Returns:
        The stage in which the simpler effect replaces the other; its `data` and `runs` are not its own yet.
    """
    given_up = next((a for a in current.hypothesis.free if a.key == stage.added), None)
    if given_up is None or not effect_named(given_up.key.effect).contains:
        return None
    progress(f"asking whether less than {given_up.key} will do")
    free = tuple(a for a in current.hypothesis.free if a is not given_up)
    (rest,) = fit([replace(current.hypothesis, free=free)], data, iterations=1)
    if rest is None:
        return None
    scene = Scene.of(rest.hypothesis.model, data, rest.simulated, len(data.recordings))
    candidates, _ = screen(scene, data, rest.simulated, rest.hypothesis.free)
    chosen = [c for c in candidates if contains(given_up.key, c.key)]
    fits = fit([with_candidate(scene, c, rest) for c in chosen], data)
    enough = (1.0 + TIE) * current.judged
    good = [(c, f) for c, f in zip(chosen, fits, strict=True) if f is not None and f.judged < enough]
    if not good:
        return None
    candidate, found = min(good, key=lambda cf: cf[1].judged)
    rivals = tuple(k for k in stage.rivals if k != candidate.key)
    return replace(
        stage, added=candidate.key, fit=polished(found, data), dropped=(given_up.key,), rivals=rivals
    )
