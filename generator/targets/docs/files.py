"""The documentation: pages of families, interfaces and order codes, pages across families, and an index."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from typing import Annotated, Any, NamedTuple, TypedDict

from ...masters.sheet import Master, shipped_masters
from ...model import Device
from ...render import Templates, our_templates
from ...say import text
from ...say.names_and_evidence import addresses_text, heading, title_of
from ...say.text import as_sentence, count_with_unit, escape, markdown_link
from .. import NO_OPTIONS, Library, Options, Target, TargetError
from ..registry import licence_in
from . import (
    cross_family_pages,
    fact_tables,
    family_pages,
    interface_page,
    masters_page,
    order_code_page,
    timing_pictures,
    verdict_page,
)
from .interface_page import Rows, Section
from .links_and_errata import (
    ERRATA,
    interface_page_path,
    page_in_folder,
    with_errata_linked,
    with_other_subjects_linked,
)


class _Page(NamedTuple):
    """Page of a family. ``path`` is relative to ``docs``, and ``compute_values`` returns the values of the template."""

    path: str
    template: str
    compute_values: Callable[[], Mapping[str, Any]]


class Index(TypedDict):
    rows: Annotated[Rows, "a row per family"]
    usable_page: Annotated[str, "the page on verdicts"]
    order_codes: Annotated[
        list[Section], "each interface of a family: its pages, number of order codes, and links to these"
    ]
    trademarks: Annotated[list[str], "notices on trademarks"]


def generate(library: Library, options: Options = NO_OPTIONS) -> dict[str, str]:
    """Return the text of each file by its path: the index, the pages across families, and the files of each family.

    A family has the page ``docs/<device>.md``, with the pages about master settings, verdicts and changes next to it.
    The folder ``docs/<device>/`` has the pages about each interface and each order code, about the hardware, the errata
    and the manual, and the pictures.
    """
    files = licence_in("docs")
    sections: list[Section] = []
    for device in library.devices:
        files |= library.files_of(_files_of_family, device, options)
        sections += _order_code_sections(order_code_page.OrderCodes(device))
    identification_values = cross_family_pages.identification_page_values(library.devices)
    pages: dict[str, tuple[str, Mapping[str, Any]]] = {
        "README.md": ("index.md.jinja", _index_values(library, sections)),
        verdict_page.PAGE: ("usable.md.jinja", verdict_page.usable_values(library.devices)),
        cross_family_pages.WHICH_ENCODER: (f"{cross_family_pages.WHICH_ENCODER}.jinja", identification_values),
        cross_family_pages.COMPARISON: (f"{cross_family_pages.COMPARISON}.jinja", identification_values),
        cross_family_pages.REGISTERS: (
            f"{cross_family_pages.REGISTERS}.jinja",
            cross_family_pages.registers_page_values(library.devices),
        ),
        cross_family_pages.ALARMS: (
            f"{cross_family_pages.ALARMS}.jinja",
            cross_family_pages.alarms_page_values(library.devices),
        ),
        cross_family_pages.ALL_ERRATA: (
            f"{cross_family_pages.ALL_ERRATA}.jinja",
            cross_family_pages.all_errata_values(library.devices),
        ),
        cross_family_pages.GLOSSARY: (
            f"{cross_family_pages.GLOSSARY}.jinja",
            cross_family_pages.glossary_values(library.devices),
        ),
    }
    for name, (template, values) in pages.items():
        files[f"docs/{name}"] = _page_text(template, values, library)
    return files


def _files_of_family(device: Device, library: Library, options: Options) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the path of each picture and page of a family, and a function for its text.

    All targets pass ``options`` to such a function. The documentation has none.

    Raises:
        TargetError: A shipped spec of a master is not valid.
    """
    try:
        masters = shipped_masters()
    except ValueError as error:
        raise TargetError(str(error)) from None
    family_codes = order_code_page.OrderCodes(device)
    for picture_name, svg_function in _pictures_of_family(family_codes):
        yield f"docs/{device.name}/{picture_name}", svg_function
    for page in _pages_of_family(family_codes, masters):
        yield f"docs/{page.path}", partial(_family_page_text, device, page, library)


def _family_page_text(device: Device, page: _Page, library: Library) -> str:
    """Return the text of a page of a family.

    Names of errata in the rendered text become links. On a page about an interface, the file name is added to links
    whose anchor is on another page of this interface.
    """
    values = page.compute_values()
    page_text = _page_text(page.template, values, library)
    if page.template in ("interface.md.jinja", "interface-subject.md.jinja"):
        page_text = with_other_subjects_linked(values["interface"].name, page_text)
    return with_errata_linked(device, page.path, page_text)


def _page_text(template: str, values: Mapping[str, Any], library: Library) -> str:
    """Return a rendered template without surplus spaces and empty lines."""
    return _without_surplus_spaces(TEMPLATES.render(template, values, library.own_templates))


def _pages_of_family(family_codes: order_code_page.OrderCodes, masters: tuple[Master, ...]) -> Iterator[_Page]:
    """Yield the pages of a family, its interfaces and its order codes."""
    device = family_codes.device
    folder = device.name
    interfaces_with_masters = masters_page.interfaces_with_masters(device)
    yield _Page(f"{folder}.md", "device.md.jinja", partial(family_pages.index_values, family_codes))
    yield from _pages_of_interfaces(family_codes, interfaces_with_masters)
    for code_group in family_codes.groups:
        code_values = partial(_code_values, family_codes, code_group, interfaces_with_masters)
        yield _Page(f"{folder}/{code_group.name}.md", "code.md.jinja", code_values)
    yield _Page(f"{folder}/hardware.md", "hardware.md.jinja", partial(family_pages.hardware_values, device))
    yield _Page(f"{folder}/{ERRATA}", "errata.md.jinja", partial(family_pages.errata_values, device))
    yield _Page(f"{folder}/manual.md", "manual.md.jinja", partial(family_pages.manual_values, device))
    for interface_name in interfaces_with_masters:
        masters_values = partial(masters_page.page_values, device, interface_name, masters)
        yield _Page(masters_page.file_name(device, interface_name), "masters.md.jinja", masters_values)
    verdict_values = partial(verdict_page.page_values, device)
    yield _Page(verdict_page.file_name(device), "verdicts.md.jinja", verdict_values)
    changes_values = partial(family_pages.changes_values, device)
    yield _Page(family_pages.changes_file_name(device), "changes.md.jinja", changes_values)


def _pages_of_interfaces(
    family_codes: order_code_page.OrderCodes, interfaces_with_masters: Collection[str]
) -> Iterator[_Page]:
    """Yield the page of each interface, and the pages about its subjects."""
    device = family_codes.device
    for interface in device.interfaces:
        interface_values = partial(_interface_values, family_codes, interface.name, interfaces_with_masters)
        yield _Page(interface_page_path(device, interface), "interface.md.jinja", interface_values)
        for subject in interface_page.subjects(device, interface.name):
            subject_path = f"{device.name}/{page_in_folder(interface.name, subject)}"
            subject_values = partial(_subject_values, subject, interface_values)
            yield _Page(subject_path, "interface-subject.md.jinja", subject_values)


def _interface_values(
    family_codes: order_code_page.OrderCodes, interface_name: str, interfaces_with_masters: Collection[str]
) -> interface_page.InterfacePage:
    """Return the values of the page of an interface."""
    return interface_page.page_values(
        family_codes.device,
        interface_name,
        links=family_codes.links_in_folder,
        has_masters=interface_name in interfaces_with_masters,
        pictures=family_codes.pictures,
    )


def _subject_values(
    subject: str, interface_values: Callable[[], interface_page.InterfacePage]
) -> interface_page.SubjectPage:
    """Return the values of the page about one subject of an interface, such as its registers."""
    return interface_page.subject_values(subject, interface_values())


def _code_values(
    family_codes: order_code_page.OrderCodes,
    code_group: order_code_page.CodeGroup,
    interfaces_with_masters: Collection[str],
) -> order_code_page.CodePage:
    """Return the values of the page about a group of order codes."""
    has_masters = code_group.interface.name in interfaces_with_masters
    return order_code_page.page_values(code_group, has_masters, family_codes.pictures)


def _pictures_of_family(family_codes: order_code_page.OrderCodes) -> Iterator[tuple[str, Callable[[], str]]]:
    """Yield the file name of each picture of a family and its order codes, with a function for its text."""
    pictures_of_groups = [group.pictures for group in family_codes.groups]
    for pictures in (family_codes.pictures, *pictures_of_groups):
        for picture in pictures.values():
            # A function that returns the finished picture.
            yield picture.name, partial(str, picture.svg)
    for interface in family_codes.device.interfaces:
        diagram = timing_pictures.timing_diagram(family_codes.device, interface)
        if diagram is not None:
            yield f"timing-{interface.name}.svg", partial(timing_pictures.diagram_picture, diagram)


def _without_surplus_spaces(page_text: str) -> str:
    """Return a page without trailing spaces, empty first lines and repeated empty lines, with one final line end."""
    kept_lines: list[str] = []
    for text_line in page_text.splitlines():
        # An empty line is kept only after a line with text.
        follows_line_with_text = bool(kept_lines) and kept_lines[-1] != ""
        if text_line.strip() or follows_line_with_text:
            kept_lines.append(text_line.rstrip())
    return "\n".join(kept_lines).rstrip() + "\n"


def _order_code_sections(family_codes: order_code_page.OrderCodes) -> Iterator[Section]:
    """Yield the section of the index for each interface of a family that has order codes."""
    device = family_codes.device
    for interface in device.interfaces:
        interface_codes = [variant.code for variant in device.variants_over(interface.name)]
        if interface_codes:
            title = f"{device.name.upper()}, {interface.title}"
            count_text = count_with_unit(len(interface_codes), "order code")
            yield {
                "pages": family_codes.page_links(interface.name),
                "counted": f"All {count_text}" if len(interface_codes) > 1 else "The order code",
                "interface": markdown_link(title, f"{device.name}/{interface.name}.md"),
                "links": [family_codes.links[order_code] for order_code in interface_codes],
            }


def _index_values(library: Library, order_codes: list[Section]) -> Index:
    """Return the values of the index of all families."""
    family_rows = [_index_row(device) for device in library.devices]
    # Each notice appears once, in the order of the manufacturers.
    trademarks: dict[str, None] = {}
    for manufacturer, _ in library.by_manufacturer():
        trademarks |= dict.fromkeys(manufacturer.trademarks)
    return {
        "rows": family_rows,
        "usable_page": verdict_page.PAGE,
        "order_codes": order_codes,
        "trademarks": list(trademarks),
    }


def _index_row(device: Device) -> tuple[str, ...]:
    """Return a row of family, manufacturer, interfaces, number of order codes, masters, manual, evidence."""
    folder = device.name
    interface_links = [
        markdown_link(interface.title, f"{folder}/{interface.name}.md") for interface in device.interfaces
    ]
    return (
        markdown_link(escape(device.title), f"{folder}.md"),
        escape(device.manufacturer.title),
        ", ".join(interface_links),
        f"{len(device.variants)}",
        ", ".join(masters_page.page_links(device)),
        f"{escape(device.manual.title)}, revision {family_pages.revision_and_date(device.manual)}",
        escape(device.evidence.grade),
    )


TEMPLATES = Templates(
    our_templates("docs"),
    values={
        "index.md.jinja": Index,
        "device.md.jinja": family_pages.FamilyPage,
        "interface.md.jinja": interface_page.InterfacePage,
        "interface-subject.md.jinja": interface_page.SubjectPage,
        "code.md.jinja": order_code_page.CodePage,
        "hardware.md.jinja": family_pages.HardwarePage,
        "errata.md.jinja": family_pages.ErrataPage,
        "manual.md.jinja": family_pages.ManualPage,
        "masters.md.jinja": masters_page.MastersPage,
        "changes.md.jinja": family_pages.ChangesPage,
        "usable.md.jinja": verdict_page.UsablePage,
        "verdicts.md.jinja": verdict_page.VerdictPage,
        f"{cross_family_pages.WHICH_ENCODER}.jinja": cross_family_pages.WhichPage,
        f"{cross_family_pages.COMPARISON}.jinja": cross_family_pages.WhichPage,
        f"{cross_family_pages.REGISTERS}.jinja": cross_family_pages.RegistersPage,
        f"{cross_family_pages.ALARMS}.jinja": cross_family_pages.AlarmsPage,
        f"{cross_family_pages.ALL_ERRATA}.jinja": cross_family_pages.AllErrataPage,
        f"{cross_family_pages.GLOSSARY}.jinja": cross_family_pages.GlossaryPage,
    },
    filters={
        "md": text.escape,
        "paragraph": text.wrap_markdown,
        "code": text.code_span,
        "html": text.escape_html,
        "cited": text.citation,
        "cited_html": text.cited_html,
        "anchor": text.anchor_of,
        "sentence": as_sentence,
        "titled": title_of,
        "heading": heading,
        "addresses": addresses_text,
        "said": text.MARKDOWN.sentence,
    },
    functions={"table": text.table, "timing_rows": fact_tables.timing_rows, "table_rows": family_pages.table_rows},
)
TARGET = Target(
    name="docs",
    summary="Markdown pages with pictures of every frame, and the settings of BiSS and SSI masters",
    files=generate,
    templates=TEMPLATES,
    family=_files_of_family,
)
