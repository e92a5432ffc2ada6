"""Frames as python-can's messages, and back."""

from __future__ import annotations

from typing import Any

import can

from .frame import Frame


def to_message(frame: Frame, **more: Any) -> can.Message:
    """Return a frame as a message of python-can; ``more`` are arguments of `can.Message`."""
    return can.Message(
        arbitration_id=frame.id, is_extended_id=frame.extended, is_fd=frame.fd, bitrate_switch=frame.fd,
        is_remote_frame=frame.remote, data=None if frame.remote else frame.data, check=False, **more,
    )  # fmt: skip


def from_message(message: can.Message) -> Frame:
    """Return a message of python-can as a frame."""
    data = b"" if message.is_remote_frame else bytes(message.data)
    return Frame(
        message.arbitration_id, data, message.is_extended_id, message.is_fd, message.is_remote_frame
    )  # fmt: skip
