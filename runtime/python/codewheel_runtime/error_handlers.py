# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Handlers for frame errors: ``decode`` raises the errors, and ``try_decode`` returns them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, NoReturn, cast

from .errors import FrameError, Sender

#: Function that handles a frame error. It receives the error, the frame and the encoder, and raises or returns the
#: error.
ErrorHandler = Callable[[Exception, object, Any], NoReturn]


def raise_frame_error(error: Exception, frame: object, encoder: Sender) -> NoReturn:
    """Raise an error after adding the frame and the encoder to it. This handles the errors of ``decode``."""
    raise _complete_error(error, frame, encoder)


def _return_frame_error(error: Exception, frame: object, encoder: Sender) -> Exception:
    """Return a frame error after adding the frame and the encoder to it. This handles the errors of ``try_decode``.

    Raises:
        TypeError: The error is not a frame error, because the frame does not have the right type.
    """
    error = _complete_error(error, frame, encoder)
    if isinstance(error, FrameError):
        return error
    raise error


#: The same function for type checkers, which assume that every handler raises its error.
return_frame_error: Final = cast(ErrorHandler, _return_frame_error)


def _complete_error(error: Exception, frame: object, encoder: Sender) -> Exception:
    """Add the frame and the encoder to a frame error, and return the error.

    Any other error becomes a TypeError whose message begins with the order code.
    """
    if isinstance(error, FrameError):
        error.add(frame, encoder)
        return error
    type_error = TypeError(f"{encoder.code}: {error}")
    # The caller raises the TypeError, so it cannot say ``from error``.
    type_error.__cause__ = error
    return type_error
