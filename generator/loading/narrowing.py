"""Select some order codes of devices by the names that a user gives: order codes, interfaces or families."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..language.problems import nearest_choice
from ..model import Device, Variant
from ..order_codes.reduction import for_codes
from .samples import sample_frames


class UnknownName(ValueError):
    """A name matches no order code, interface or family. The message lists the existing names or suggests one."""


def narrowed_to(devices: Sequence[Device], only: str) -> tuple[Device, ...]:
    """Return the devices with only the order codes that ``only`` names, or all devices if it is empty.

    ``only`` is a list of names, separated by commas: order codes, interfaces, families, or a family with one of its
    interfaces, such as ``x_24_ssi``. Devices without such an order code are left out.

    Raises:
        UnknownName: A name matches no order code, interface or family.
    """
    words = [word.strip() for word in only.split(",") if word.strip()]
    if not words:
        return tuple(devices)
    known_names: set[str] = set()
    for device in devices:
        for variant in device.variants:
            known_names.update(_names_of_code(device, variant))
    for word in words:
        if word.upper() not in known_names:
            raise UnknownName(_unknown_message(devices, word))
    wanted_names = {word.upper() for word in words}
    narrowed_devices = []
    for device in devices:
        codes = {variant.code for variant in device.variants if wanted_names & set(_names_of_code(device, variant))}
        if codes:
            narrowed_device = for_codes(device, codes)
            # The sample frames in programs and pages must belong to one of the remaining order codes.
            narrowed_devices.append(replace(narrowed_device, samples=sample_frames(narrowed_device)))
    return tuple(narrowed_devices)


def _names_of_code(device: Device, variant: Variant) -> tuple[str, ...]:
    """Return the names by which users can select an order code, in uppercase.

    These are the order code, the interface, the family, and the family with the interface, such as ``X_24_SSI``.
    """
    family = device.name.upper()
    interface = variant.interface.upper()
    return variant.code.upper(), interface, family, f"{family}_{interface}"


def _yield_suggestions(devices: Sequence[Device]) -> Iterator[str]:
    """Yield the names of families, of families with an interface such as ``x_24_ssi``, and of interfaces."""
    interface_names: set[str] = set()
    for device in devices:
        yield device.name
        for interface in device.interfaces:
            interface_names.add(interface.name)
            yield f"{device.name}_{interface.name}"
    yield from sorted(interface_names)


def _unknown_message(devices: Sequence[Device], word: str) -> str:
    """Return the message about an unknown name, with the nearest name or, if none is similar, the valid names.

    If the word begins with the name of a family, the valid names are the order codes of this family.
    """
    all_codes: list[str] = []
    codes_of_named_families: list[str] = []
    for device in devices:
        codes = [variant.code for variant in device.variants]
        all_codes += codes
        if word.upper().startswith(device.name.upper()):
            codes_of_named_families += codes
    names = list(_yield_suggestions(devices))
    lowercase_codes = [code.lower() for code in codes_of_named_families]
    nearest_name = nearest_choice(word, [*names, *codes_of_named_families, *lowercase_codes])
    if nearest_name:
        hint = f"did you mean '{nearest_name}'?"
    else:
        example_code = all_codes[0] if all_codes else ""
        valid_names = codes_of_named_families or [f"order codes, such as {example_code}", *names]
        hint = f"valid are {', '.join(valid_names)}"
    return f"there is no order code, interface or family '{word}'; {hint}"
