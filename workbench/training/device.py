"""The device for training: the processor or an available graphics card."""

from __future__ import annotations

from workbench.core import InputError


def usable(name: str) -> str:
    """Return the device as torch names it, ``cpu`` or ``cuda:N``.

    Raises:
        InputError: the name is none, or this machine has no such card.
    """
    import torch

    try:
        device = torch.device(name)
    except RuntimeError:
        device = None
    if device is None or device.type not in ("cpu", "cuda"):
        raise InputError(f"'{name}' is not a device", remedy="give --device cpu, cuda or cuda:N")
    if device.type == "cpu":
        return "cpu"
    count, index = torch.cuda.device_count(), device.index or 0
    if index >= count:
        cards = f"{count} CUDA card{'s' * (count != 1)}" if count else "no CUDA card that torch can use"
        others = f", or on cuda:0 to cuda:{count - 1}" if count else ""
        raise InputError(
            f"--device {name}: this machine has {cards}",
            remedy=f"train on the processor, --device cpu{others}",
        )
    return f"cuda:{index}"
