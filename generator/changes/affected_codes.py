"""Describe the order codes that a change affects in as few words as possible."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from ..model import Device, Variant
from ..say.numbers import counted, first_of

_BRACES = re.compile(r"\{(\w+)\}")
_ALL = "…"


def describe_codes(device: Device, codes: Collection[str]) -> str:
    """Describe order codes of a family: ``all 12 BiSS order codes``, ``TV62-M…``, or some of them by name."""
    variants = device.variants
    if not codes:
        return ""
    if len(codes) == len(variants):
        return f"all {counted(len(variants), 'order code')}" if len(variants) > 1 else variants[0].code
    for interface in device.interfaces:
        interface_codes = [variant.code for variant in variants if variant.interface == interface.name]
        if len(interface_codes) > 1 and set(interface_codes) == set(codes):
            return f"all {len(interface_codes)} {interface.short} order codes"
    return pattern(device, codes) or first_of([variant.code for variant in variants if variant.code in codes])


def pattern(device: Device, codes: Collection[str]) -> str:
    """Return the order codes as a pattern with some parts left open, such as ``TV62-…20-B1``, or "" if that fails."""
    affected = [variant for variant in device.variants if variant.code in codes]
    used_texts = {part.name: _used_values(affected, part.name) for part in device.order_code.parts}
    fitting = [variant for variant in device.variants if _fits(variant, used_texts)]
    if len(affected) < 2 or fitting != affected:
        return ""
    all_texts = {part.name: _used_values(device.variants, part.name) for part in device.order_code.parts}
    texts = _BRACES.split(device.order_code.pattern)  # Text and names of parts in turn.
    texts[1::2] = [_part_pattern(used_texts[name], all_texts[name]) for name in texts[1::2]]
    # If everything up to the end is open, one mark stands for the rest.
    last = max((index for index in range(1, len(texts), 2) if texts[index] != _ALL), default=0)
    return "".join([*texts[: last + 1], texts[last + 1] if last + 2 >= len(texts) else _ALL])


def _fits(variant: Variant, texts: Mapping[str, tuple[str, ...]]) -> bool:
    """Return True if each part of an order code has one of these texts."""
    return all(variant.parts[name] in allowed_texts for name, allowed_texts in texts.items())


def _used_values(variants: Sequence[Variant], part: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys(variant.parts[part] for variant in variants))


def _part_pattern(used_texts: tuple[str, ...], all_texts: tuple[str, ...]) -> str:
    if len(used_texts) == 1:
        return used_texts[0]
    return _ALL if len(used_texts) == len(all_texts) else f"{{{','.join(used_texts)}}}"
