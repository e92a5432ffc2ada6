"""The effect of MuJoCo's soft friction constraint, as a file states it, on a comparison."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from workbench.core import Recording
from workbench.effects import rigid_in_steps
from workbench.models import Model, friction_leads, is_urdf, load_tree

from .consistent import consistent
from .replay import Replay
from .score import Scale, normalised, pooled, scored_signals, squares
from .simulated import Simulated

_FEW = 4
_SOFT_MJCF = "as the file states it, MuJoCo's friction constraint is soft (solreffriction, solimpfriction)"
_SOFT_URDF = "a URDF cannot say how rigid it is, and MuJoCo's friction constraint is soft"
_TRAIN = "train in what workbench normalize writes"


def softness_note(model: Model, replay: Replay, simulated: Simulated) -> str | None:
    """Return a note if the recordings show that the dry friction of a file is soft in MuJoCo; otherwise
    None.

    The workbench takes dry friction as rigid, whatever the file says of its constraint; a policy that trains
    in the file has it as the file says. So the model runs once more with the file's own constraint.

    Args:
        model: that was run.
        replay: how.
        simulated: its runs.
    """
    own_file = load_tree(model.serial).compile()
    leads = friction_leads(own_file)
    if not leads or model.friction_as_in_mjcf or any(r.timing.by_mujoco for r in simulated.recordings):
        return None
    soft, recordings = replay.run([replace(model, friction_as_in_mjcf=True)])[0], simulated.recordings
    names, counts = [scored_signals(r) for r in recordings], [int(np.sum(r.valid)) for r in recordings]
    scale = Scale.of(recordings)

    def apart(ones: Sequence[Recording], others: Sequence[Recording]) -> np.ndarray:
        return pooled([squares(*pair) for pair in zip(ones, others, names, strict=True)], counts)

    noise = np.stack([apart(draw, simulated.clean) for draw in simulated.noisy])
    allowed = pooled([simulated.immaterial(i) for i in range(len(recordings))], counts)
    # what the file's own constraint would leave of a machine whose friction is rigid
    left = noise.mean(axis=0) + apart(soft, simulated.clean)
    if consistent(left, noise, scale, allowed):
        return None
    rigid, own = (normalised(apart(recordings, made), scale) for made in (simulated.clean, soft))
    urdf = is_urdf(model.serial)
    kind = "URDF" if urdf else "MJCF"
    soft_there = _SOFT_URDF if urdf else _SOFT_MJCF
    advice = _TRAIN if urdf else _stiffen(float(own_file.opt.timestep))
    return (
        f"the {kind}'s dry friction ({_named(list(leads))}) is taken as rigid here; {soft_there}: "
        f"it changes sign up to {1e3 * max(leads.values()):.2g} ms before a reversal. With soft friction the "
        f"error would be {_against(own, rigid)}; {advice}"
    )


def _against(own: float, rigid: float) -> str:
    new, old = f"{own:.3g}", f"{rigid:.3g}"
    return f"{new} too" if new == old else f"{new} instead of {old}"


def _stiffen(timestep: float) -> str:
    """What makes the file's friction as rigid as its steps allow."""
    (time, ratio), (impedance, *_) = rigid_in_steps(timestep)
    return (
        f'to train in the file, give it solreffriction="{time:g} {ratio:g}" '
        f'solimpfriction="{impedance:g} {impedance:g}", or {_TRAIN}'
    )


def _named(names: list[str]) -> str:
    """All of a few names, and of many the first and how many more."""
    first = ", ".join(names[:_FEW])
    return first if len(names) <= _FEW else f"{first} and {len(names) - _FEW} more"
