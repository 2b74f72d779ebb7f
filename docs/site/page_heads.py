"""Titles and descriptions of pages with the words that people type into a search engine, and a sitemap."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from codewheel.model import Device, Variant
from docutils import nodes
from sphinx.application import Sphinx

#: Longest description in characters. Search engines show about as many.
_LONGEST = 155
#: Address under which the site is served, given by ``make site BASE=``.
BASE = "SITE_BASE"


def code_title(device: Device, variant: Variant) -> str:
    """Return the title of the page of an order code: "AMM5A21/65KSC1: BiSS-C frame, CRC, pinout, preset"."""
    interface = device.interface(variant.interface)
    subjects = [f"{_common_name(interface.title)} frame"]
    if any(layout.place(variant.parameters).crc_field is not None for layout in interface.layouts):
        subjects.append("CRC")
    if any(interface.name in connector.interfaces for connector in device.connectors):
        subjects.append("pinout")
    if any("preset" in procedure.name for procedure in device.procedures if procedure.interface == interface.name):
        subjects.append("preset")
    return f"{variant.code}: {', '.join(subjects)}"


def _common_name(interface_title: str) -> str:
    """Return the name of an interface that people type."""
    return interface_title.replace("BiSS C-mode", "BiSS-C")


def code_description(device: Device, variant: Variant) -> str:
    interface = device.interface(variant.interface)
    name = f"{device.manufacturer.title} {variant.code}"
    return shortened(
        f"{name} over {_common_name(interface.title)}: every bit of the frame, clock and cable, wiring, commands and "
        "errors, with sources. Paste your frame to decode it."
    )


def family_description(device: Device) -> str:
    interfaces = ", ".join(_common_name(interface.title) for interface in device.interfaces)
    manufacturer = device.manufacturer.title
    is_named = manufacturer.split()[0].lower() in device.title.lower().split()
    name = device.title if is_named else f"{manufacturer} {device.title}"
    return shortened(f"{name}: {interfaces} frame format, CRC, status bits, registers and settings, with sources.")


def first_paragraph(doctree: nodes.document | None) -> str:
    """Return the beginning of the first paragraph of a page."""
    paragraphs = doctree.findall(nodes.paragraph) if doctree is not None else iter(())
    texts = (re.sub(r"\s+", " ", paragraph.astext()).strip() for paragraph in paragraphs)
    return shortened(next((text for text in texts if len(text) > 40), ""))


def shortened(text: str) -> str:
    if len(text) <= _LONGEST:
        return text
    return text[:_LONGEST].rpartition(" ")[0].rstrip(",;:.") + " …"


def _add_head(app: Sphinx, page: str, _template: str, context: dict[str, Any], doctree: nodes.document | None) -> None:
    encoders: Any = app.env.get_domain("encoder")
    device, variant = encoders.device_of(page), encoders.variant_of(page)
    context["head_title"] = code_title(device, variant) if variant else context.get("title", "")
    # A page of an encoder can begin with a table.
    context["description"] = first_paragraph(doctree) or (family_description(device) if device else "")
    if variant:
        context["description"] = code_description(device, variant)
    elif device and page.endswith(f"/{device.name}"):
        context["head_title"] = f"{context['title']}: frame, CRC, registers"
        context["description"] = family_description(device)


def sitemap(base: str, pages: list[str]) -> str:
    """Return the sitemap of a site that is served at an address."""
    places = "".join(f"<url><loc>{escape(base.rstrip('/'))}/{escape(page)}.html</loc></url>\n" for page in pages)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        f'<urlset xmlns="http://www.sitemaps.org/schemas/sitemap/0.9">\n{places}</urlset>\n'
    )


def _write_sitemap(app: Sphinx, error: Exception | None) -> None:
    base = os.environ.get(BASE, "")
    if base and error is None:
        pages = sorted(app.env.found_docs)
        Path(app.outdir, "sitemap.xml").write_text(sitemap(base, pages), encoding="utf-8", newline="\n")
        Path(app.outdir, "robots.txt").write_text(f"Sitemap: {base.rstrip('/')}/sitemap.xml\n", encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("html-page-context", _add_head, priority=450)
    app.connect("build-finished", _write_sitemap)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
