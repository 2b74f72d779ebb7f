"""Apply the conditions in the settings: choose the families that each target writes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from ..loading.configuration import FamilyFilters
from ..owners import family_of
from ..say.numbers import first_of
from .terminal import Stop

if TYPE_CHECKING:
    from ..model import Device

_MOST_FAMILIES = 8


def accepted_devices(target: str, devices: Sequence[Device], filters: FamilyFilters) -> tuple[Device, ...]:
    """Return the devices that a target writes. An edition is written if its family is."""
    if target not in filters:
        return tuple(devices)
    accepts = filters[target].accepts
    return tuple(device for device in devices if accepts(family_of(device), device.evidence.grade))


def devices_by_target(
    targets: Iterable[str], devices: Sequence[Device], filters: FamilyFilters
) -> dict[str, tuple[Device, ...]]:
    """Return the devices that each target writes.

    Raises:
        Stop: A target writes no family. The exit code is 1.
    """
    accepted = {target: accepted_devices(target, devices, filters) for target in targets}
    for target, target_devices in accepted.items():
        if devices and not target_devices:
            grades = [f"{device.name} ({device.evidence.grade})" for device in devices]
            raise Stop(
                f"the setting 'only.{target}' accepts no family that was read: {first_of(grades, _MOST_FAMILIES)}; "
                "change it, or name the other targets with --target",
                1,
            )
    return accepted
