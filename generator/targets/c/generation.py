"""The generation of headers: those that state the same one belong together, and others do not compile together."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256

from ...model import Manufacturer
from .. import Options

#: What stands for the generation while it is not known.
UNKNOWN = "0x00000000U"


def generation(maker: Manufacturer, options: Options, shared: Iterable[str]) -> str:
    """The generation as a number in C, of 32 bits.

    It follows from the version, which follows from what changed in the specs, from the options, and from the texts of
    the headers that all families share, rendered with ``UNKNOWN``. Words of one family do not change it.
    """
    settings = [f"{name}={value}" for name, value in sorted(options.items())]
    text = "\0".join([maker.name, maker.version, *settings, *shared])
    return f"0x{sha256(text.encode()).hexdigest()[:8].upper()}U"
