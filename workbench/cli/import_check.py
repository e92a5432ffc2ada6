"""What a model's weight and inertia say of a recording that was just imported for it."""

from __future__ import annotations

from dataclasses import replace

from workbench.core import Recording
from workbench.inspection import Inspection, Remark


def with_model(found: Inspection, model: str, recording: Recording) -> Inspection:
    """The inspection, and a problem more where the model tells a wrong sign, zero or order.

    Raises:
        InputError: the model cannot be read.
    """
    from workbench.comparison import reversed_torques, shifted_axes, swapped_axes, turned_axes
    from workbench.effects import load_model

    loaded = load_model(model)
    if tuple(recording.axes) != tuple(loaded.axes):
        return found
    turned = turned_axes(loaded, [recording])
    one, *rest = found.recordings
    if turned is None:
        if swapped := swapped_axes(loaded, [recording]):
            named = " and ".join(f"'{axis}'" for axis in swapped.axes)
            text = f"All columns of {named} are swapped, against the model: {swapped}."
            problem = Remark("problem", "swap", swapped.axes[0], text, {"axes": list(swapped.axes)})
        elif shifted := shifted_axes(loaded, [recording]):
            text = f"Positions are measured from a different zero than in the model: {shifted}."
            problem = Remark("problem", "zero", next(iter(shifted.by)), text, {"offset": shifted.by})
        elif wrong := reversed_torques(loaded, [recording]):
            told = {"axes": list(wrong.axes), "signal": wrong.signal, "whole": wrong.whole}
            problem = Remark("problem", "sign", wrong.axes[0], f"{wrong}.", told)
            one = replace(one, remarks=tuple(r for r in one.remarks if r.topic != "sign"))
        else:
            return found
        return replace(found, recordings=(replace(one, remarks=(*one.remarks, problem)), *rest))
    axes = list(dict.fromkeys(turn.axis for turn in turned.turns))
    which = " or ".join(f"'{axis}'" for axis in axes)
    text = f"{which} has the opposite sign to that in the model: {turned}."
    both = turned.turns[0]
    value = {"axes": axes, "signal": "torque_measured" if both.torque and not both.motion else "position"}
    problem = Remark("problem", "sign", axes[0], text, value)
    # what the data alone say of these signs, the model says more of
    kept = [r for r in one.remarks if r.topic != "sign" or r.axis not in axes]
    return replace(found, recordings=(replace(one, remarks=(*kept, problem)), *rest))
