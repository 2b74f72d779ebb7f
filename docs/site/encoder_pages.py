"""Pages of every encoder. The repository tracks only the families with the highest grades."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

from codewheel.loading.library import load_library
from codewheel.masters.groups import facts_of_order_codes
from codewheel.model import Device
from codewheel.targets import Library
from codewheel.targets.c.files import generate as generate_c
from codewheel.targets.c.single import single_path
from codewheel.targets.docs.files import generate

#: Pages that list all encoders.
LISTS = ("README.md", "docs/encoder/encoders.md")
#: The title of the page of an order code, and the paragraph below it.
_TITLE = re.compile(r"^# (\S+)\n\n.+\n", re.MULTILINE)
_SPEC_LINK = re.compile(r"\]\(((?:\.\./)*)specs/\w+/(\w+)\.yaml\)")


def encoder_pages(root: Path) -> Iterator[tuple[str, str]]:
    """Yield the path and text of each page, picture and header for the specs in ``root``, if there are any.

    The page of an order code links to its header for C, and to its settings for masters if it has BiSS or SSI.

    Raises:
        ValueError: There are problems in the specs.
    """
    if not (root / "specs").is_dir():
        return
    devices, report = load_library([root / "specs"])
    if report.problems:
        raise ValueError(report.problems[0].format())
    pages = generate(Library(devices))
    codes_with_settings = set(_codes_with_settings(devices))
    titles = (_TITLE.search(text) for text in pages.values())
    headers = dict(_headers(devices, {title[1] for title in titles if title is not None}))
    for path, text in pages.items():
        folder, title = f"generated/{posixpath.dirname(path)}", _TITLE.search(text)
        if title is None or title[1] not in headers:
            yield f"generated/{path}", text
            continue
        name, header = headers[title[1]]
        links = f"For C99 and C++11: [`{name}`]({name}) has all that a program needs to read a position."
        if title[1] in codes_with_settings:
            page = posixpath.relpath("settings.md", folder)
            links += f" [Settings for your master]({page}#code={quote(title[1], safe='')})."
        yield f"{folder}/{name}", header
        before = text[: title.start()]
        yield f"generated/{path}", f"{before}{title[0].rstrip()} {links}\n{text[title.end() :]}"


def _codes_with_settings(devices: tuple[Device, ...]) -> Iterator[str]:
    """Yield the order codes for which the page with the settings of masters has texts."""
    for device in devices:
        for interface in device.interfaces:
            if next(facts_of_order_codes(device, interface), None) is not None:
                yield from (variant.code for variant in device.variants_over(interface.name))


def _headers(devices: tuple[Device, ...], titles: set[str]) -> Iterator[tuple[str, tuple[str, str]]]:
    """Yield each order code among the titles of pages, with the name and text of its header."""
    makers = {variant.code: device.manufacturer for device in devices for variant in device.variants}
    codes = sorted(titles & makers.keys())
    files = generate_c(Library(devices), {"form": "single", "only": ",".join(codes)}) if codes else {}
    for code in codes:
        name = single_path(makers[code], code)
        yield code, (name, files[f"c/{name}"])


def with_page_links(text: str) -> str:
    """Return a list of encoders with links to pages in place of those to specs, whose pages are not tracked."""
    return _SPEC_LINK.sub(r"](\1generated/docs/\2.md)", text)
