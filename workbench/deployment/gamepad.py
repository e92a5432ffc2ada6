"""Commands velocities to a walking policy with the sticks of a gamepad; any button stops.

Read by the kernel's joystick interface (linux/joystick.h): events of 8 bytes, for every stick and button when
it is opened and whenever one changes. A pad that is gone stops.
"""

from __future__ import annotations

import os
import struct

import numpy as np

from workbench.core import InputError

from .command import Command
from .steering import Clip

DEVICE = "/dev/input/js0"
#: Stick's axis -> what it asks for when it is pushed all the way down or right [m/s, m/s, rad/s].
STICKS = {1: (-1.0, 0.0, 0.0), 0: (0.0, -0.5, 0.0), 3: (0.0, 0.0, -1.0)}
_EVENT = struct.Struct("=IhBB")  # time, value, kind, number
_BUTTON, _AXIS, _BEGIN = 0x01, 0x02, 0x80
_DEAD = 0.1  # of its way: sticks do not come back to zero
_FULL = 32767


class Gamepad:
    """Left stick forward and sideward, right stick to the side turns (axes 1, 0 and 3).

    Args:
        command: what is asked for.
        clip: keeps it within what may be asked for.
        device: of the kernel.

    Raises:
        InputError: no such device, or none that may be read.
    """

    def __init__(self, command: Command, clip: Clip, device: str = DEVICE) -> None:
        self._command, self._clip = command, clip
        self._pushed = dict.fromkeys(STICKS, 0.0)
        try:
            self._file = os.open(device, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError as error:
            raise InputError(
                f"no gamepad at {device} ({error.strerror})", column="--teleop",
                remedy="plug it in, or name its device: pad:/dev/input/js1",
            ) from error  # fmt: skip

    def watch(self) -> str | None:
        """Read the events; return the reason if the emergency stop was pressed."""
        for _ in range(16):  # a flood takes no time from the loop
            try:
                data = os.read(self._file, 64 * _EVENT.size)
            except BlockingIOError:
                return None
            except OSError:
                data = b""
            if not data:
                return "the end of the gamepad"
            for at in range(0, len(data) - _EVENT.size + 1, _EVENT.size):
                _, value, kind, number = _EVENT.unpack_from(data, at)
                if kind == _BUTTON and value:
                    return "a button of the gamepad"
                if kind & ~_BEGIN == _AXIS and number in STICKS:
                    self._push(number, value / _FULL)
        return None

    def close(self) -> None:
        """Close the device."""
        os.close(self._file)

    def _push(self, number: int, part: float) -> None:
        self._pushed[number] = part if abs(part) > _DEAD else 0.0
        asked = sum(np.array(STICKS[k]) * pushed for k, pushed in self._pushed.items())
        self._command.asked = self._clip(np.array(asked, float))
