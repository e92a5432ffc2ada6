"""What a model's weight and inertia say of a recording that was just imported for it."""

from __future__ import annotations

from dataclasses import replace

from workbench.core import Recording
from workbench.inspection import Inspection, Remark


def with_model(found: Inspection, model: str, recording: Recording) -> Inspection:
    """The inspection, and a problem more where columns of an axis count the other way than the model.

    Raises:
        InputError: the model cannot be read.
    """
    from workbench.comparison import turned_axes
    from workbench.effects import load_model

    loaded = load_model(model)
    turned = turned_axes(loaded, [recording]) if tuple(recording.axes) == tuple(loaded.axes) else None
    if turned is None:
        return found
    axes = list(dict.fromkeys(turn.axis for turn in turned.turns))
    which = " or ".join(f"'{axis}'" for axis in axes)
    text = f"{which} has the other sign than in the model: {turned}."
    both = turned.turns[0]
    value = {"axes": axes, "signal": "torque_measured" if both.torque and not both.motion else "position"}
    problem = Remark("problem", "sign", axes[0], text, value)
    one, *rest = found.recordings
    # what the data alone say of these signs, the model says more of
    kept = [r for r in one.remarks if r.topic != "sign" or r.axis not in axes]
    return replace(found, recordings=(replace(one, remarks=(*kept, problem)), *rest))
