"""The generation of files that belong together: those that state the same one were made from the same."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256


def digits(parts: Iterable[str]) -> str:
    """Eight hexadecimal digits that follow from all ``parts``."""
    return sha256("\0".join(parts).encode()).hexdigest()[:8].upper()
