"""Order codes that have the same settings in every master."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

from ..model import Device, Interface, Variant, choices
from .record import NoRecord, Record, Undecided, record


@dataclass(frozen=True, slots=True)
class Group:
    """Order codes that have the same settings in every master."""

    device: Device
    codes: tuple[str, ...]
    record: Record


def groups_of(device: Device, interface: Interface) -> list[Group]:
    """Return the order codes of an interface in groups, each once for each choice on which its frame depends."""
    found: dict[str, list[Record]] = {}
    for item in records_of(device, interface):
        found.setdefault(repr(replace(item, code="")), []).append(item)
    return [Group(device, tuple(item.code for item in alike), alike[0]) for alike in found.values()]


def records_of(device: Device, interface: Interface) -> Iterator[Record]:
    """Yield the records of all listed order codes of an interface, once for each choice on which the frame depends."""
    for variant in device.variants:
        if variant.interface == interface.name:
            with suppress(NoRecord):
                yield from _by_answers(device, variant)


def _by_answers(device: Device, variant: Variant) -> Iterator[Record]:
    """Yield the record of an order code, once for each choice on which its frame depends."""
    try:
        yield record(device, variant)
    except Undecided as error:
        deciding = device.alternatives_of(error.layout)
        for answers, _ in choices(deciding):
            named = {item.name: answer.name for item, answer in zip(deciding, answers, strict=True)}
            yield record(device, variant, answers=named)
