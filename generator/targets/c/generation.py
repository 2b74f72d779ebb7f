"""The generation of headers: a number that keeps headers of different runs from compiling together."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256

from ...model import Manufacturer
from .. import Options

#: Placeholder for the generation in the texts that it is computed from.
UNKNOWN = "0x00000000U"


def generation(maker: Manufacturer, options: Options, shared: Iterable[str]) -> str:
    """Return the generation as a 32-bit number in C.

    It is a hash of the version, which follows from the changes in the specs, of the options, and of the texts of the
    shared headers, rendered with ``UNKNOWN``. The text of a family does not change it.
    """
    settings = [f"{name}={value}" for name, value in sorted(options.items())]
    text = "\0".join([maker.name, maker.version, *settings, *shared])
    return f"0x{sha256(text.encode()).hexdigest()[:8].upper()}U"
