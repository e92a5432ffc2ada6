"""Commands velocities to a walking policy while it runs: by keys, a gamepad, or datagrams."""

from __future__ import annotations

import json
import math
import os
import select
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from workbench.core import InputError

from .command import Command
from .gamepad import DEVICE, Gamepad
from .steering import Clip

#: Key -> change of forward, sideward and turning speed [m/s, m/s, rad/s].
STEPS = {
    "w": (0.1, 0.0, 0.0), "s": (-0.1, 0.0, 0.0), "q": (0.0, 0.05, 0.0), "e": (0.0, -0.05, 0.0),
    "a": (0.0, 0.0, 0.1), "d": (0.0, 0.0, -0.1),
}  # fmt: skip
STAND = "x"
SILENCE_S = 0.5  # without a datagram, after which the robot is to stand
_LONGEST = 1024  # bytes of a datagram


class Keys:
    """Keys of a terminal: w s forward and back, q e sideward, a d turn, x stand; every other key stops.

    Args:
        command: what is asked for.
        clip: keeps it within what may be asked for.
        file: number of the terminal.
    """

    def __init__(self, command: Command, clip: Clip, file: int) -> None:
        self._command, self._clip, self._file = command, clip, file

    def watch(self) -> str | None:
        """Read the keys; return the reason if the emergency stop was pressed or the terminal is gone."""
        while select.select([self._file], [], [], 0.0)[0]:
            typed = os.read(self._file, 64).decode("utf-8", "replace")
            if not typed:
                return "the end of the terminal"
            for key in typed:
                if key == STAND:
                    self._command.asked = np.zeros(3)
                elif key in STEPS:
                    self._command.asked = self._clip(self._command.asked + np.array(STEPS[key]))
                else:
                    return "a key"
        return None


class Datagrams:
    """UDP datagrams ``{"velocity": [forward, sideward, turn]}``, or ``{"stop": true}``.

    Who falls silent for half a second asks for nothing more: the robot is to stand.

    Args:
        command: what is asked for.
        clip: keeps it within what may be asked for.
        port: on this computer.
        now: the loop's clock [s].

    Attributes:
        refused: datagrams that were no command.

    Raises:
        InputError: the port is taken.
    """

    def __init__(self, command: Command, clip: Clip, port: int, now: Callable[[], float]) -> None:
        self._command, self._clip, self._now = command, clip, now
        self._heard, self.refused = now(), 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind(("127.0.0.1", port))
        except OSError as error:
            self._socket.close()
            raise InputError(
                f"port {port} cannot be opened ({error.strerror})", remedy="choose another"
            ) from error
        self.port: int = self._socket.getsockname()[1]

    def watch(self) -> str | None:
        """Read the datagrams; return the reason if one of them stops."""
        for _ in range(16):  # a flood takes no time from the loop
            try:
                data = self._socket.recv(_LONGEST)
            except BlockingIOError:
                break
            if self._take(data):
                return "a datagram"
        if self._now() - self._heard > SILENCE_S:
            self._command.asked = np.zeros(3)
        return None

    def close(self) -> None:
        """Release the port."""
        self._socket.close()

    def _take(self, data: bytes) -> bool:
        """One datagram; whether it stops."""
        try:
            said = json.loads(data)
        except (ValueError, RecursionError):
            self.refused += 1
            return False
        if isinstance(said, dict) and said.get("stop"):
            return True
        velocity = said.get("velocity") if isinstance(said, dict) else None
        if not (
            isinstance(velocity, list)
            and len(velocity) == 3
            and all(type(x) in (int, float) and math.isfinite(x) for x in velocity)
        ):
            self.refused += 1
            return False
        self._heard, self._command.asked = self._now(), self._clip(np.array(velocity, float))
        return False


@contextmanager
def teleoperated(
    how: str, command: Command, clip: Clip, now: Callable[[], float]
) -> Iterator[list[Callable[[], str | None]]]:
    """Return the input for ``keys``, ``pad``, ``pad:DEVICE``, ``udp:PORT`` or nothing.

    Raises:
        InputError: none of these, no terminal, no gamepad, or a port that is taken.
    """
    if not how:
        yield []
    elif how == "keys":
        if not sys.stdin.isatty():
            raise InputError("keys need a terminal", column="--teleop", remedy="give pad, or udp:PORT")
        import termios
        import tty

        file = sys.stdin.fileno()
        before = termios.tcgetattr(file)
        tty.setcbreak(file)
        try:
            yield [Keys(command, clip, file).watch]
        finally:
            termios.tcsetattr(file, termios.TCSADRAIN, before)
    elif how.partition(":")[0] == "pad":
        pad = Gamepad(command, clip, how.partition(":")[2] or DEVICE)
        try:
            yield [pad.watch]
        finally:
            pad.close()
    elif how.startswith("udp:") and how[4:].isdigit() and 0 < int(how[4:]) < 65536:
        socket_ = Datagrams(command, clip, int(how[4:]), now)
        try:
            yield [socket_.watch]
        finally:
            socket_.close()
    else:
        raise InputError(
            f"'{how}' is not a way to steer", column="--teleop", remedy="give keys, pad, or udp:PORT"
        )
