"""Describe the order codes that a change affects in as few words as possible."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from ..model import Device, Variant
from ..say.numbers import counted, first_of

_BRACES = re.compile(r"\{(\w+)\}")
_ALL = "…"


def reach(device: Device, codes: Collection[str]) -> str:
    """Describe order codes of a family: ``all 12 BiSS order codes``, ``TV62-M…``, or some of them by name."""
    every = device.variants
    if not codes:
        return ""
    if len(codes) == len(every):
        return f"all {counted(len(every), 'order code')}" if len(every) > 1 else every[0].code
    for interface in device.interfaces:
        own = [item.code for item in every if item.interface == interface.name]
        if len(own) > 1 and set(own) == set(codes):
            return f"all {len(own)} {interface.short} order codes"
    return pattern(device, codes) or first_of([item.code for item in every if item.code in codes])


def pattern(device: Device, codes: Collection[str]) -> str:
    """Return the order codes as a pattern with some parts left open, such as ``TV62-…20-B1``, or "" if that fails."""
    chosen = [item for item in device.variants if item.code in codes]
    used = {part.name: _used(chosen, part.name) for part in device.order_code.parts}
    fitting = (item for item in device.variants if all(item.parts[name] in texts for name, texts in used.items()))
    if len(chosen) < 2 or list(fitting) != chosen:
        return ""
    every = {part.name: _used(device.variants, part.name) for part in device.order_code.parts}
    pieces = _BRACES.split(device.order_code.pattern)
    texts = [_part(used[item], every[item]) if index % 2 else item for index, item in enumerate(pieces)]
    # If everything up to the end is open, one mark stands for the rest.
    last = max((index for index in range(1, len(texts), 2) if texts[index] != _ALL), default=0)
    return "".join([*texts[: last + 1], texts[last + 1] if last + 2 >= len(texts) else _ALL])


def _used(variants: Sequence[Variant], part: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(item.parts[part] for item in variants))


def _part(used: tuple[str, ...], every: tuple[str, ...]) -> str:
    if len(used) == 1:
        return used[0]
    return _ALL if len(used) == len(every) else f"{{{','.join(used)}}}"
