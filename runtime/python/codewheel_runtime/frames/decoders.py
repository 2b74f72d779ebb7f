# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decoders of one frame, and the functions that receive their errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn, TypeVar, cast

from ..encoder import Encoder
from ..errors import FrameError

_Decode = TypeVar("_Decode", bound=Callable[..., Any])

#: Function for an error of a frame. It receives the error, the frame and the encoder, and raises or returns the error.
Failed = Callable[[Exception, object, Any], NoReturn]


def decoder(make: Callable[[Any, Failed], _Decode], encoder: Encoder | None, failed: Failed) -> _Decode:
    """Return the decoder of a class for an encoder. Each is made only once."""
    decoders: dict[object, _Decode] = _DECODERS if encoder is None else encoder.__dict__.setdefault("_decoders", {})
    decode = decoders.get((make, failed))
    if decode is None:
        decode = decoders[make, failed] = make(encoder, failed)
    return decode


_DECODERS: dict[object, Any] = {}


def raised(error: Exception, _frame: object, _encoder: object) -> NoReturn:
    """Raise the error of a class."""
    raise error


def reported(error: Exception, frame: object, encoder: Encoder) -> NoReturn:
    """Raise the error of an encoder."""
    raise _of_encoder(error, frame, encoder)


def _returned(error: Exception, frame: object, encoder: Encoder) -> Exception:
    """Return the error of an encoder. Raises TypeError if the frame does not have the right type."""
    error = _of_encoder(error, frame, encoder)
    if isinstance(error, FrameError):
        return error
    raise error


returned: Failed = cast(Failed, _returned)


def _of_encoder(error: Exception, frame: object, encoder: Encoder) -> Exception:
    """Return the error with the frame and the encoder."""
    if isinstance(error, FrameError):
        error.add(frame, encoder)
        return error
    type_error = TypeError(f"{encoder.code}: {error}")
    type_error.__cause__ = error
    return type_error
