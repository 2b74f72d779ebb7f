# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Functions that decode one frame, each created once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

from ..encoder import Encoder
from ..error_handlers import ErrorHandler

_Decode = TypeVar("_Decode", bound=Callable[..., Any])


def cached_decoder(
    make_decoder: Callable[[Any, ErrorHandler], _Decode], encoder: Encoder | None, handle_error: ErrorHandler
) -> _Decode:
    """Return the function that decodes the frames of an encoder. ``make_decoder`` creates it on the first call.

    ``handle_error`` receives each error, and raises or returns it. ``encoder`` is None for frames that are the same for
    every encoder.
    """
    decoders: dict[object, _Decode] = _DECODERS if encoder is None else encoder._decoders
    try:
        return decoders[make_decoder, handle_error]
    except KeyError:
        decode = decoders[make_decoder, handle_error] = make_decoder(encoder, handle_error)
        return decode


_DECODERS: dict[object, Any] = {}


def raise_error(error: Exception, _frame: object, _encoder: object) -> NoReturn:
    """Raise the error unchanged.

    Used by the ``decode`` method of a class, which cannot name an encoder in the message.
    """
    raise error
