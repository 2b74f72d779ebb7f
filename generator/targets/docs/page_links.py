"""Links to items on other pages of a family, and corrections of links in the text of a page."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from ...model import Alarm, Device, Erratum, Interface, Layout, Procedure, Register
from ...say.markdown import MARKDOWN, code_span, escape, markdown_link, reference
from ...say.names_and_places import heading
from ...say.text import Reference, Style

#: File name of the page with all errata of a family, in the folder of the family.
ERRATA = "errata.md"


#: First words of the anchors on the page about each subject of an interface.
ANCHORS_BY_SUBJECT = {
    "fields": ("group",),
    "registers": ("register",),
    "procedures": ("procedure", "alarm", "input"),
    "wiring": ("wiring", "connector", "led"),
    "examples": ("example",),
}


def subject_of(anchor: str) -> str:
    """Return the subject whose page contains an anchor, or an empty string for the page of the interface itself."""
    for subject, first_words in ANCHORS_BY_SUBJECT.items():
        if anchor.startswith(first_words):
            return subject
    return ""


def page_in_folder(interface_name: str, subject: str = "") -> str:
    """Return the file name of an interface page or, with a subject, of the page about it: ``biss-registers.md``."""
    return f"{interface_name}-{subject}.md" if subject else f"{interface_name}.md"


def interface_page_path(device: Device, interface: Interface) -> str:
    """Return the path to the page of an interface, such as ``FAMILY/biss.md``."""
    return f"{device.name}/{page_in_folder(interface.name)}"


def path_to_anchor(device: Device, interface_name: str, anchor: str) -> str:
    """Return the path to an anchor on a page of an interface, such as ``FAMILY/biss-registers.md#register-preset``."""
    return f"{device.name}/{page_in_folder(interface_name, subject_of(anchor))}#{anchor}"


def with_other_subjects_linked(interface_name: str, page_text: str) -> str:
    """Return the text of a page with the file name added to each link whose anchor is on another page of the interface.

    For example, ``#register-preset`` becomes ``biss-registers.md#register-preset``.
    """
    own_anchors = set(re.findall(r'<a id="([^"]+)">', page_text))

    def add_file_name(link: re.Match[str]) -> str:
        link_start, anchor = link.groups()
        file_name = "" if anchor in own_anchors else page_in_folder(interface_name, subject_of(anchor))
        return f"{link_start}{file_name}#{anchor}"

    # The start of a link in Markdown or HTML whose target is an anchor without a page.
    return re.sub(r'(\]\(|href=")#([\w.-]+)', add_file_name, page_text)


def link_to_register(device: Device, register: Register, label: str) -> str:
    """Return a link to a register on the page about the registers of its interface."""
    return markdown_link(label, path_to_anchor(device, register.interface, f"register-{register.name}"))


def link_to_layout(device: Device, layout: Layout, label: str) -> str:
    """Return a link to a frame on the page of its interface."""
    interface = next(interface for interface, device_layout in device.layouts() if device_layout.name == layout.name)
    return markdown_link(label, path_to_anchor(device, interface.name, f"layout-{layout.name}"))


def link_to_alarm(device: Device, interface: Interface, alarm: Alarm, label: str) -> str:
    """Return a link to an alarm on a page of an interface."""
    return markdown_link(label, path_to_anchor(device, interface.name, f"alarm-{alarm.name}"))


def link_to_procedure(device: Device, procedure: Procedure) -> str:
    """Return a link to a procedure, labeled with the interface that it uses."""
    interface = device.interface(procedure.interface)
    return markdown_link(interface.title, path_to_anchor(device, interface.name, f"procedure-{procedure.name}"))


def link_to_erratum(device: Device, erratum: Erratum) -> str:
    """Return a link to an erratum on the errata page of its family."""
    return markdown_link(escape(erratum.title), f"{device.name}/{ERRATA}#erratum-{erratum.name}")


def with_errata_linked(device: Device, page: str, page_text: str) -> str:
    """Return the text of a page with a link for each erratum that its sentences name, as in ``See erratum crc_start.``

    ``page`` is the path of the page. A link shows the title of the erratum.
    """
    if not device.errata:
        return page_text
    # Pages of the family are in its folder or next to it.
    is_in_folder = page.startswith(f"{device.name}/")
    folder = "" if is_in_folder else f"{device.name}/"
    titles = {erratum.name: erratum.title for erratum in device.errata}
    # Longer names first, so that a name does not match the beginning of a longer one.
    longest_first = sorted(titles, key=len, reverse=True)
    name_pattern = f"(?:{'|'.join(longest_first)})\\b"

    def link_name(name_match: re.Match[str]) -> str:
        name = name_match[0]
        return markdown_link(escape(titles[name]), f"{folder}{ERRATA}#erratum-{name}")

    def link_names_in_mention(mention: re.Match[str]) -> str:
        return re.sub(name_pattern, link_name, mention[0])

    # "erratum" or "errata" with one or more names, separated by commas.
    mention_pattern = rf"\berrat(?:um|a)\s(?:{name_pattern}(?:, (?={name_pattern}))?)+"
    return re.sub(mention_pattern, link_names_in_mention, page_text)


def links_to_steps(folder: str, names: Iterable[str]) -> list[str]:
    """Return links to the manual procedures with these names. ``folder`` is the path to the folder of the family."""
    links = []
    for name in names:
        label = escape(f"Steps: {heading(name)}")
        links.append(markdown_link(label, f"{folder}hardware.md#by-hand-{name}"))
    return links


def style_in_folder(device: Device) -> Style:
    """Return the style for a page in the folder of a family. References to registers link to the register pages."""

    def reference_text(ref: Reference) -> str:
        """Return a link to the item. Only registers are on other pages."""
        for register in device.registers:
            if ref.anchor == f"register-{register.name}":
                page = page_in_folder(register.interface, "registers")
                return markdown_link(code_span(ref.name), f"{page}#{ref.anchor}")
        return reference(ref)

    return replace(MARKDOWN, ref=reference_text)
