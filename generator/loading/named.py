"""Reduce devices to the families, interfaces and order codes that a user names."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..language.problems import nearest_choice
from ..model import Device, Variant
from ..order_codes.reduction import for_codes


class UnknownName(ValueError):
    """A name matches no order code, interface or family. The message lists those that exist."""


def narrowed_to(devices: Sequence[Device], only: str) -> tuple[Device, ...]:
    """Return the devices with the order codes that ``only`` names, and all of them if it is empty.

    Raises:
        UnknownName: A name matches no order code, interface or family.
    """
    words = [word.strip() for word in only.split(",") if word.strip()]
    if not words:
        return tuple(devices)
    known_names = {name for device in devices for variant in device.variants for name in _names(device, variant)}
    for word in words:
        if word.upper() not in known_names:
            raise UnknownName(_unknown_message(devices, word))
    wanted_names = {word.upper() for word in words}
    narrowed_devices = []
    for device in devices:
        codes = {variant.code for variant in device.variants if wanted_names & set(_names(device, variant))}
        narrowed_devices += [for_codes(device, codes)] if codes else []
    return tuple(narrowed_devices)


def _names(device: Device, variant: Variant) -> tuple[str, ...]:
    """Return the names that stand for an order code, in upper case."""
    family, kind = device.name.upper(), variant.interface.upper()
    return variant.code.upper(), kind, family, f"{family}_{kind}"


def _words(devices: Sequence[Device]) -> Iterator[str]:
    for device in devices:
        yield device.name
        yield from (f"{device.name}_{interface.name}" for interface in device.interfaces)
    yield from sorted({interface.name for device in devices for interface in device.interfaces})


def _unknown_message(devices: Sequence[Device], word: str) -> str:
    """Return the message, with the order codes of the family if the word begins like one of them."""
    families = [device for device in devices if word.upper().startswith(device.name.upper())]
    codes = [variant.code for device in families for variant in device.variants]
    nearest = nearest_choice(word, [*_words(devices), *codes, *map(str.lower, codes)])
    first = next((variant.code for device in devices for variant in device.variants), "")
    valid_names = codes or [f"order codes, such as {first}", *_words(devices)]
    hint = f"did you mean '{nearest}'?" if nearest else f"valid are {', '.join(valid_names)}"
    return f"there is no order code, interface or family '{word}'; {hint}"
