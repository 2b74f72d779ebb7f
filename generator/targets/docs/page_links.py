"""Links to items on other pages, for pages next to the page of the family."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from ...model import Alarm, Device, Interface, Layout, Procedure, Register
from ...say.markdown import STYLE, code, link, reference, text
from ...say.name import heading
from ...say.text import Ref, Style

#: Page with all errata of a family, in its folder.
ERRATA = "errata.md"


def interface_page(device: Device, interface: Interface) -> str:
    return f"{device.name}/{interface.name}.md"


def to_register(device: Device, item: Register, label: str) -> str:
    return link(label, f"{interface_page(device, device.interface(item.interface))}#register-{item.name}")


def to_layout(device: Device, item: Layout, label: str) -> str:
    over = next(interface for interface, layout in device.layouts() if layout.name == item.name)
    return link(label, f"{interface_page(device, over)}#layout-{item.name}")


def to_alarm(device: Device, over: Interface, item: Alarm, label: str) -> str:
    return link(label, f"{interface_page(device, over)}#alarm-{item.name}")


def to_procedure(device: Device, item: Procedure) -> str:
    over = device.interface(item.interface)
    return link(over.title, f"{interface_page(device, over)}#procedure-{item.name}")


def to_erratum(device: Device, name: str) -> str:
    return link(code(name), f"{device.name}/{ERRATA}#erratum-{name}")


def with_errata_linked(device: Device, page: str, made: str) -> str:
    """Return a page of a family with links to the errata that its sentences name, as in ``See erratum crc_start.``"""
    if not device.errata:
        return made
    folder = "" if page.startswith(f"{device.name}/") else f"{device.name}/"
    name = f"(?:{'|'.join(sorted((item.name for item in device.errata), key=len, reverse=True))})\\b"

    def linked(found: re.Match[str]) -> str:
        return re.sub(name, lambda one: link(code(one[0]), f"{folder}{ERRATA}#erratum-{one[0]}"), found[0])

    return re.sub(rf"\berrat(?:um|a)\s(?:{name}(?:, (?={name}))?)+", linked, made)


def to_steps(folder: str, names: Iterable[str]) -> list[str]:
    """Return links to manual steps. ``folder`` is the path to the folder of the family."""
    return [link(text(f"Steps: {heading(name)}"), f"{folder}hardware.md#by-hand-{name}") for name in names]


def style_beside(device: Device) -> Style:
    """Return the style for a page in the folder of the family, where registers are on their interface page."""

    def written(ref: Ref) -> str:
        found = next((item for item in device.registers if ref.anchor == f"register-{item.name}"), None)
        return reference(ref) if found is None else link(code(ref.name), f"{found.interface}.md#{ref.anchor}")

    return replace(STYLE, ref=written)
