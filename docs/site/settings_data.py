"""Data of the page with master settings: what ``codewheel master`` prints for each order code and master.

A text is a list of numbers of lines. Each line is stored once for all order codes, with a placeholder for the code.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypedDict

from codewheel.language.written_masters import FILE_FORMATS
from codewheel.loading.library import load_library
from codewheel.masters.groups import order_code_groups, records_of
from codewheel.masters.record import EncoderFacts
from codewheel.masters.sheet import Master, SettingsSheet, sheet, shipped_masters
from codewheel.masters.text import sheet_text
from codewheel.model import Device, Interface
from codewheel.order_codes.labels import find_code
from codewheel.say.evidence import GRADES
from codewheel.targets.masters.files import file_text

#: Placeholders in a line for the order code, and for the order code as an identifier.
CODE, IDENTIFIER = "\x00", "\x01"


class Page(TypedDict):
    """The data of the page. ``codes`` has a list of choices for each order code."""

    masters: list[list[str]]
    formats: dict[str, str]
    codes: dict[str, list[list[Any]]]
    texts: list[list[int]]
    lines: list[str]


class _Texts:
    """Numbers texts and lines, so that each is stored once."""

    def __init__(self) -> None:
        self.lines: dict[str, int] = {}
        self.texts: dict[tuple[int, ...], int] = {}

    def number_of(self, text: str, order_code: str) -> int:
        """Return the number of a text about an order code."""
        text = text.replace(order_code, CODE).replace(identifier(order_code), IDENTIFIER)
        line_numbers = tuple(self.lines.setdefault(line, len(self.lines)) for line in text.split("\n"))
        return self.texts.setdefault(line_numbers, len(self.texts))


def identifier(order_code: str) -> str:
    """Return an order code in the form that files use for names."""
    return re.sub(r"\W|^(?=\d)", "_", order_code, flags=re.ASCII)


def script(root: Path) -> str:
    """Return the script with the data of the page for the specs in ``root``.

    Raises:
        ValueError: There are problems in the specs.
    """
    families, report = load_library([root / "specs"])
    if report.problems:
        raise ValueError(report.problems[0].format())
    # The first order code is the example of the page.
    devices = sorted(families, key=lambda device: GRADES.index(device.evidence.grade))
    data = json.dumps(page_data(devices), ensure_ascii=False, separators=(",", ":"))
    return f"window.codewheelSettings = {data};\n"


def page_data(devices: Sequence[Device]) -> Page:
    texts = _Texts()
    masters = shipped_masters()
    codes: dict[str, list[list[Any]]] = {}
    for device in devices:
        for interface in device.interfaces:
            for record, sheets in _records_with_sheets(device, interface, masters):
                choice = " ".join(f"--choose {name}={answer}" for name, answer in record.answers.items())
                by_master = [_texts_of(device, record, master_sheet, texts) for master_sheet in sheets]
                codes.setdefault(record.code, []).append([choice, by_master])
    return {
        "masters": [[master.name, master.title] for master in masters],
        "formats": {name: file_format.suffix for name, file_format in FILE_FORMATS.items()},
        "codes": codes,
        "texts": [list(line_numbers) for line_numbers in texts.texts],
        "lines": list(texts.lines),
    }


def _records_with_sheets(
    device: Device, interface: Interface, masters: Sequence[Master]
) -> Iterator[tuple[EncoderFacts, list[SettingsSheet]]]:
    """Yield the record of each order code with the sheets of all masters, which a group of order codes shares."""
    sheets_by_code: dict[tuple[str, tuple[str, ...]], list[SettingsSheet]] = {}
    for group in order_code_groups(device, interface):
        sheets = [sheet(master, group.record) for master in masters]
        answers = tuple(group.record.answers.values())
        sheets_by_code |= {(code, answers): sheets for code in group.codes}
    for record in records_of(device, interface):
        yield record, sheets_by_code[record.code, tuple(record.answers.values())]


def _texts_of(device: Device, record: EncoderFacts, master_sheet: SettingsSheet, texts: _Texts) -> list[Any]:
    """Return the number of the text of a master, and its files, or an empty list if it lacks the interface."""
    if not master_sheet.is_described:
        return []
    text = sheet_text(device, find_code(device, record.code), record, [master_sheet])
    files = []
    if not master_sheet.refusals:
        for rule in master_sheet.master.files:
            for master_device in master_sheet.devices_with(rule):
                content = file_text(device, [record.code], master_sheet, rule=rule, master_device=master_device)
                number = texts.number_of(content.rstrip("\n"), record.code)
                files.append([rule["format"], master_device, number])
    return [texts.number_of(text, record.code), files]
