# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decoders of one frame, each made once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

from ..encoder import Encoder, Failed

_Decode = TypeVar("_Decode", bound=Callable[..., Any])


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
