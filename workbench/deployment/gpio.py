"""An emergency stop at an input of the computer: high as long as motion is permitted.

The line is pulled down, where the chip can: a torn cable is a pressed button. Asked for by the kernel's own
interface (linux/gpio.h, version 2 of Linux 5.10), so that no library is needed.
"""

from __future__ import annotations

import fcntl
import os
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from workbench.can import CanConfig
from workbench.core import InputError

_GET_LINE, _GET_VALUES = 0xC250B407, 0xC010B40E
_INPUT, _PULLED_DOWN = 1 << 2, 1 << 9
_LINES, _NAME, _ATTRIBUTES = 64, 32, 240
_REQUEST = struct.Struct(f"={_LINES}I{_NAME}sQI20s{_ATTRIBUTES}sII20si")
_VALUES = struct.Struct("=QQ")

#: As `fcntl.ioctl` with a buffer that it changes.
Ioctl = Callable[[int, int, bytearray], object]


class Line:
    """One input.

    Args:
        chip: as ``/dev/gpiochip0``.
        line: its number there.
        ioctl: of the kernel.

    Raises:
        InputError: no such chip or line, or one that another program has.
    """

    def __init__(self, chip: str, line: int, ioctl: Ioctl = fcntl.ioctl) -> None:
        self._ioctl, file = ioctl, -1
        try:
            file = os.open(chip, os.O_RDONLY | os.O_CLOEXEC)
            self._line = self._request(file, line)
        except OSError as error:
            raise InputError(
                f"line {line} of {chip} cannot be opened ({error.strerror or error})", column="stop.chip",
                remedy="see `gpioinfo` for lines that are free, and permit them to this user",
            ) from error  # fmt: skip
        finally:
            if file >= 0:
                os.close(file)

    def watch(self) -> str | None:
        """Return the reason to stop, if there is one; an input that cannot be read is one."""
        values = bytearray(_VALUES.pack(0, 1))
        try:
            self._ioctl(self._line, _GET_VALUES, values)
        except OSError:
            return "the line of the button, which is gone"
        return None if _VALUES.unpack(values)[0] & 1 else "the line of the button"

    def close(self) -> None:
        """Release the input."""
        os.close(self._line)

    def _request(self, file: int, line: int) -> int:
        """Asks for the line, pulled down; as it is, where the chip cannot pull."""
        for flags in (_INPUT | _PULLED_DOWN, _INPUT):
            asked = bytearray(
                _REQUEST.pack(line, *[0] * (_LINES - 1), b"workbench stop", flags, 0, b"", b"", 1, 0, b"", 0)
            )
            try:
                self._ioctl(file, _GET_LINE, asked)
                return int(_REQUEST.unpack(asked)[-1])
            except OSError:
                if flags == _INPUT:
                    raise
        raise AssertionError


@contextmanager
def stop_line(config: CanConfig, ioctl: Ioctl = fcntl.ioctl) -> Iterator[list[Callable[[], str | None]]]:
    """Return the input that a configuration names, which the loop has to check, or nothing."""
    if config.stop is None or not config.stop.chip:
        yield []
        return
    line = Line(config.stop.chip, config.stop.line, ioctl)
    try:
        yield [line.watch]
    finally:
        line.close()
