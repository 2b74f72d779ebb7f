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
    """The port does not exist, cannot be opened, or was closed."""


class NoReplyError(LinkError):
    """Nothing arrived in time, or only the echo of the request."""


class DisturbedError(LinkError):
    """Bytes arrived, but they are not a valid reply, or they are two different replies."""


class WrongEncoderError(LinkError):
    """The replies are from a different kind of encoder."""


class SecondDeviceError(LinkError):
    """Several requests in a row got two different replies, so a second device seems to answer."""


class BusyError(LinkError):
    """The memory of the encoder stayed busy."""


class NotUsableError(LinkError):
    """The encoder reports that its position is not usable.

    Attributes:
        frame: The frame, with its ``reports``.
    """

    def __init__(self, message: str, frame: PositionFrame) -> None:
        super().__init__(message)
        self.frame = frame
