# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Errors of links to encoders over RS-485."""

from __future__ import annotations

from .encoder import PositionFrame

__all__ = [
    "BusyError",
    "DisturbedError",
    "LinkError",
    "NoReplyError",
    "NotUsableError",
    "PortError",
    "SecondDeviceError",
    "WrongEncoderError",
]


class LinkError(RuntimeError):
    """A link failed.

    Attributes:
        received: Bytes that arrived in the last attempt.
    """

    def __init__(self, message: str, received: bytes = b"") -> None:
        super().__init__(message, received)
        self.received = received

    def __str__(self) -> str:
        return str(self.args[0])


class PortError(LinkError):
    """The port does not exist, cannot be opened, was closed or failed, or pyserial is not installed."""


class NoReplyError(LinkError):
    """In time, nothing arrived except an echo of the request or the reply to another request."""


class DisturbedError(LinkError):
    """Bytes arrived, but with no valid reply, two different replies, or a reply that does not match its request."""


class WrongEncoderError(LinkError):
    """The replies are from a different kind of encoder."""


class SecondDeviceError(LinkError):
    """Several extra replies with other values arrived, so a second device seems to answer."""


class BusyError(LinkError):
    """The encoder's memory stayed busy."""


class NotUsableError(LinkError):
    """The encoder reports that its position is not usable.

    Attributes:
        frame: The frame, with its ``reports``.
    """

    def __init__(self, message: str, frame: PositionFrame) -> None:
        super().__init__(message)
        self.frame = frame
