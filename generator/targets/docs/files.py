"""Documentation: pages of families, interfaces and order codes, pages across families, and an index."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, TypedDict

from ...masters.sheet import Master, shipped_masters
from ...reference.parts import for_interface
from ...render import Templates, our_templates
from ...say import markdown
from ...say.markdown import link, text
from ...say.name import heading, title
from ...say.place import addresses
from ...say.words import counted, sentence
from .. import NO_OPTIONS, Library, Options, Target, TargetError
from ..licence import licence_in
from . import across, bites, by_code, changes, facts, family, glossary, over, places, usable, waves
from . import masters as masters_page
from .sections import Rows, Section


class Index(TypedDict):
    rows: Annotated[Rows, "a row per family"]
    usable_page: Annotated[str, "the page on verdicts"]
    order_codes: Annotated[list[Section], "for each interface of a family: interface, pages, counted, links"]
    trademarks: Annotated[list[str], "notices on trademarks"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return ``docs/README.md``, the pages across families, and the pages and pictures of each family.

    A family has ``docs/<device>.md`` with its master settings and changes next to it. ``docs/<device>/`` has a page for
    each interface, each order code, the hardware, the errata and the manual, and the pictures.
    """
    try:
        masters = shipped_masters()
    except ValueError as error:
        raise TargetError(str(error)) from None
    families = [by_code.Codes(item) for item in library.devices]
    pages: dict[str, tuple[str, Mapping[str, Any]]] = {
        "README.md": ("index.md.jinja", _index(library, families)),
        usable.PAGE: ("usable.md.jinja", usable.page_values(library.devices)),
        across.WHICH: (f"{across.WHICH}.jinja", across.which(library.devices)),
        across.REGISTERS: (f"{across.REGISTERS}.jinja", across.registers(library.devices)),
        across.ALARMS: (f"{across.ALARMS}.jinja", across.alarms(library.devices)),
        bites.ALL: (f"{bites.ALL}.jinja", bites.all_values(library.devices)),
        glossary.PAGE: (f"{glossary.PAGE}.jinja", glossary.page_values(library.devices)),
    }
    files = licence_in("docs")
    for item in families:
        pages |= _of_family(item, masters)
        files |= {f"docs/{item.device.name}/{name}": picture for name, picture in _pictures(item)}
    return files | {
        f"docs/{name}": _tidy(TEMPLATES.render(template, values, library.own_templates))
        for name, (template, values) in pages.items()
    }


def _of_family(
    codes: by_code.Codes, masters: tuple[Master, ...]
) -> Iterator[tuple[str, tuple[str, Mapping[str, Any]]]]:
    """Yield each page with its template and values."""
    device, folder = codes.device, codes.device.name
    taken = {item.name for item in device.interfaces if masters_page.has_masters(for_interface(device, item.name))}
    yield f"{folder}.md", ("device.md.jinja", family.index_values(codes, bool(taken)))
    for item in device.interfaces:
        values = over.page_values(device, item.name, codes.links_beside, item.name in taken, codes.pictures)
        yield f"{folder}/{item.name}.md", ("interface.md.jinja", values)
    for alike in codes.alike:
        one = by_code.page_values(alike, alike.interface.name in taken, codes.pictures)
        yield f"{folder}/{alike.name}.md", ("code.md.jinja", one)
    yield f"{folder}/hardware.md", ("hardware.md.jinja", family.hardware_values(device))
    yield f"{folder}/{places.ERRATA}", ("errata.md.jinja", bites.page_values(device))
    yield f"{folder}/manual.md", ("manual.md.jinja", family.manual_values(device))
    if taken:
        yield f"{folder}-masters.md", ("masters.md.jinja", masters_page.page_values(device, masters))
    yield changes.page(device), ("changes.md.jinja", changes.page_values(device))


def _pictures(codes: by_code.Codes) -> Iterator[tuple[str, str]]:
    """Yield file name and picture."""
    for group in (codes.pictures, *(alike.pictures for alike in codes.alike)):
        yield from ((item.name, item.drawn) for item in group.values())
    for interface in codes.device.interfaces:
        shown = waves.wave(codes.device, interface)
        if shown is not None:
            yield f"timing-{interface.name}.svg", waves.drawn(shown)


def _tidy(made: str) -> str:
    """Remove trailing spaces and repeated empty lines, and end the file with one line end."""
    lines: list[str] = []
    for line in made.splitlines():
        if line.strip() or (lines and lines[-1]):
            lines.append(line.rstrip())
    return "\n".join(lines).rstrip() + "\n"


def _index(library: Library, families: list[by_code.Codes]) -> Index:
    rows: Rows = []
    for device in library.devices:
        page, maker = link(text(device.title), f"{device.name}.md"), text(device.manufacturer.title)
        titles = ", ".join(link(item.title, f"{device.name}/{item.name}.md") for item in device.interfaces)
        masters = link("settings", f"{device.name}-masters.md") if masters_page.has_masters(device) else ""
        manual = f"{text(device.manual.title)}, revision {family.revision(device.manual)}"
        rows.append((page, maker, titles, f"{len(device.variants)}", masters, manual))
    found: list[Section] = [
        {
            "pages": item.page_links(part.name),
            "counted": counted(len(of_part), "order code"),
            "interface": link(f"{device.name.upper()}, {part.title}", f"{device.name}/{part.name}.md"),
            "links": [item.links[one] for one in of_part],
        }
        for item in families
        for device in [item.device]
        for part in device.interfaces
        if (of_part := [one.code for one in device.variants if one.interface == part.name])
    ]
    trademarks = list(dict.fromkeys(note for maker, _ in library.by_manufacturer() for note in maker.trademarks))
    return {"rows": rows, "usable_page": usable.PAGE, "order_codes": found, "trademarks": trademarks}


TEMPLATES = Templates(
    our_templates("docs"),
    values={
        "index.md.jinja": Index,
        "device.md.jinja": family.FamilyPage,
        "interface.md.jinja": over.InterfacePage,
        "code.md.jinja": by_code.CodePage,
        "hardware.md.jinja": family.HardwarePage,
        "errata.md.jinja": bites.ErrataPage,
        "manual.md.jinja": family.ManualPage,
        "masters.md.jinja": masters_page.MastersPage,
        "changes.md.jinja": changes.ChangesPage,
        "usable.md.jinja": usable.UsablePage,
        f"{across.WHICH}.jinja": across.WhichPage,
        f"{across.REGISTERS}.jinja": across.RegistersPage,
        f"{across.ALARMS}.jinja": across.AlarmsPage,
        f"{bites.ALL}.jinja": bites.AllErrataPage,
        f"{glossary.PAGE}.jinja": glossary.GlossaryPage,
    },
    filters={
        "md": markdown.text,
        "paragraph": markdown.paragraph,
        "code": markdown.code,
        "cited": markdown.cited,
        "anchor": markdown.anchor,
        "sentence": sentence,
        "titled": title,
        "heading": heading,
        "addresses": addresses,
        "said": markdown.STYLE.sentence,
    },
    functions={"table": markdown.table, "timing_rows": facts.timing_rows, "table_rows": family.table_rows},
)
TARGET = Target(
    name="docs",
    summary="Markdown pages with pictures of every frame, and the settings of BiSS and SSI masters",
    files=generate,
    templates=TEMPLATES,
)
