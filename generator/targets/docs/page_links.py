"""Links to items on other pages, for pages next to the page of the family."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from ...model import Alarm, Device, Erratum, Interface, Layout, Procedure, Register
from ...say.markdown import MARKDOWN, code_span, escape, markdown_link, reference
from ...say.names_and_places import heading
from ...say.text import Reference, Style

#: Page with all errata of a family, in its folder.
ERRATA = "errata.md"


#: Subjects of an interface with pages of their own, and how the anchors on these pages begin.
ANCHORS_BY_SUBJECT = {
    "fields": ("group",),
    "registers": ("register",),
    "procedures": ("procedure", "alarm", "input"),
    "wiring": ("wiring", "connector", "led"),
    "examples": ("example",),
}


def subject_of(anchor: str) -> str:
    """Return the subject on whose page an anchor is, or an empty string for the page of the interface itself."""
    for subject, beginnings in ANCHORS_BY_SUBJECT.items():
        if anchor.startswith(beginnings):
            return subject
    return ""


def page_in_folder(interface_name: str, subject: str = "") -> str:
    """Return the file name of the page of an interface, or of one of its subjects, such as ``biss-registers.md``."""
    return f"{interface_name}-{subject}.md" if subject else f"{interface_name}.md"


def interface_page_path(device: Device, interface: Interface) -> str:
    return f"{device.name}/{page_in_folder(interface.name)}"


def path_to_anchor(device: Device, interface_name: str, anchor: str) -> str:
    """Return the path to a place about an interface, such as ``FAMILY/biss-registers.md#register-preset``."""
    return f"{device.name}/{page_in_folder(interface_name, subject_of(anchor))}#{anchor}"


def with_other_subjects_linked(interface_name: str, page_text: str) -> str:
    """Return a page about an interface with links to the places that are on its other pages.

    A link to an anchor that this page lacks gets the page of the anchor: ``#register-preset`` becomes
    ``biss-registers.md#register-preset``.
    """
    own_anchors = set(re.findall(r'<a id="([^"]+)">', page_text))

    def with_page(mark_and_anchor: re.Match[str]) -> str:
        mark, anchor = mark_and_anchor.groups()
        page = "" if anchor in own_anchors else page_in_folder(interface_name, subject_of(anchor))
        return f"{mark}{page}#{anchor}"

    # A link in Markdown or HTML that begins with its anchor.
    return re.sub(r'(\]\(|href=")#([\w.-]+)', with_page, page_text)


def link_to_register(device: Device, register: Register, label: str) -> str:
    return markdown_link(label, path_to_anchor(device, register.interface, f"register-{register.name}"))


def link_to_layout(device: Device, layout: Layout, label: str) -> str:
    """Return a link to a frame on the page of its interface."""
    interface = next(interface for interface, device_layout in device.layouts() if device_layout.name == layout.name)
    return markdown_link(label, path_to_anchor(device, interface.name, f"layout-{layout.name}"))


def link_to_alarm(device: Device, interface: Interface, alarm: Alarm, label: str) -> str:
    return markdown_link(label, path_to_anchor(device, interface.name, f"alarm-{alarm.name}"))


def link_to_procedure(device: Device, procedure: Procedure) -> str:
    interface = device.interface(procedure.interface)
    return markdown_link(interface.title, path_to_anchor(device, interface.name, f"procedure-{procedure.name}"))


def link_to_erratum(device: Device, erratum: Erratum) -> str:
    return markdown_link(escape(erratum.title), f"{device.name}/{ERRATA}#erratum-{erratum.name}")


def with_errata_linked(device: Device, page: str, page_text: str) -> str:
    """Return a page of a family with links to the errata that its sentences name, as in ``See erratum crc_start.``"""
    if not device.errata:
        return page_text
    # ``page`` is a path. Pages of the family are in its folder or next to it.
    is_in_folder = page.startswith(f"{device.name}/")
    folder = "" if is_in_folder else f"{device.name}/"
    titles = {erratum.name: erratum.title for erratum in device.errata}
    # Otherwise a name that another one begins with would match first.
    longest_first = sorted(titles, key=len, reverse=True)
    name_expression = f"(?:{'|'.join(longest_first)})\\b"

    def name_link(erratum_name: re.Match[str]) -> str:
        return markdown_link(escape(titles[erratum_name[0]]), f"{folder}{ERRATA}#erratum-{erratum_name[0]}")

    def with_names_linked(mention: re.Match[str]) -> str:
        return re.sub(name_expression, name_link, mention[0])

    # "erratum" or "errata" with one or more names, separated by commas.
    return re.sub(rf"\berrat(?:um|a)\s(?:{name_expression}(?:, (?={name_expression}))?)+", with_names_linked, page_text)


def links_to_steps(folder: str, names: Iterable[str]) -> list[str]:
    """Return links to the steps by hand with these names. ``folder`` is the path to the folder of the family."""
    return [markdown_link(escape(f"Steps: {heading(name)}"), f"{folder}hardware.md#by-hand-{name}") for name in names]


def style_in_folder(device: Device) -> Style:
    """Return the style for a page in the folder of the family, with links to registers on their interface page."""

    def reference_text(ref: Reference) -> str:
        for register in device.registers:
            if ref.anchor == f"register-{register.name}":
                return markdown_link(
                    code_span(ref.name), f"{page_in_folder(register.interface, 'registers')}#{ref.anchor}"
                )
        return reference(ref)

    return replace(MARKDOWN, ref=reference_text)
