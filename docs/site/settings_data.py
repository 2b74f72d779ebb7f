"""Data of the page with master settings: the facts about each order code, and the descriptions of the masters.

The scripts ``master-*.js`` compute the output of ``codewheel master`` from them. A file for a master is a list of
numbers of lines. Each line is stored once for all order codes, with a placeholder for the code.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypedDict

from codewheel.language.keys_of_masters import FILE_FORMATS, NUMBERS, TYPES, WORDS
from codewheel.loading.library import load_library
from codewheel.masters.encoder_facts import NOTE_ON_CLOCKS, EncoderFacts
from codewheel.masters.frame_parts import covered_facts, depends_on_crc, depends_on_whole_frame
from codewheel.masters.groups import facts_of_order_codes, order_code_groups
from codewheel.masters.order_code_facts import facts_of_order_code
from codewheel.masters.sheet import Master, SettingsSheet, sheet, shipped_masters
from codewheel.masters.text import CODINGS_IN_WORDS
from codewheel.model import INTERFACES, Biss, Device, Interface, Ssi
from codewheel.model.expressions import Expression
from codewheel.one_line.spec import device_of_line
from codewheel.say import decimal
from codewheel.say.names_and_evidence import GRADES, differences_from_manual, grade_below_manual
from codewheel.say.text import PLAIN_STYLE
from codewheel.targets.masters.files import file_text

#: Placeholders in a line for the order code, and for the order code as an identifier.
CODE, IDENTIFIER = "\x00", "\x01"
#: Largest whole number that JavaScript reads exactly.
_LARGEST_NUMBER = (1 << 53) - 1
_EXAMPLE_LINES = {"biss": "biss:position=8", "ssi": "ssi:position=8"}


class Page(TypedDict):
    """The data of the page. ``codes`` has the family and a list of choices for each order code."""

    masters: list[dict[str, Any]]
    formats: dict[str, str]
    types: Mapping[str, tuple[str, int | None]]
    interfaces: dict[str, str]
    codings: Mapping[str, str]
    word_meanings: Mapping[str, Mapping[str, str]]
    number_meanings: Mapping[str, str]
    note_on_clocks: str
    line: dict[str, Any]
    families: list[dict[str, Any]]
    records: list[dict[str, Any]]
    codes: dict[str, list[Any]]
    texts: list[list[int]]
    lines: list[str]


class _Numbered:
    """Numbers values that can be written as JSON, so that each is stored once."""

    def __init__(self) -> None:
        self._index_by_json: dict[str, int] = {}

    def number_of(self, value: Any) -> int:
        return self._index_by_json.setdefault(json.dumps(value), len(self._index_by_json))

    @property
    def values(self) -> list[Any]:
        return [json.loads(text) for text in self._index_by_json]


class _Files:
    """The texts of files, with each line stored once."""

    def __init__(self) -> None:
        self.lines = _Numbered()
        self.texts = _Numbered()

    def number_of(self, text: str, order_code: str) -> int:
        """Return the number of a text about an order code."""
        text = text.replace(order_code, CODE).replace(identifier(order_code), IDENTIFIER)
        return self.texts.number_of([self.lines.number_of(line) for line in text.split("\n")])


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
    """Return the data of the page for these families and the masters of the package."""
    masters = shipped_masters()
    files = _Files()
    records = _Numbered()
    codes: dict[str, list[Any]] = {}
    for family_number, device in enumerate(devices):
        for interface in device.interfaces:
            for encoder_record, sheets in _records_with_sheets(device, interface, masters):
                choice = " ".join(f"--choose {name}={answer}" for name, answer in encoder_record.answers.items())
                files_by_master = _files_by_master(device, encoder_record, sheets, files)
                _, choices = codes.setdefault(encoder_record.code, [family_number, []])
                choices.append([choice, records.number_of(_record_data(encoder_record)), files_by_master])
    return {
        "masters": [_master_data(master) for master in masters],
        "formats": {name: file_format.suffix for name, file_format in FILE_FORMATS.items()},
        "types": TYPES,
        "interfaces": {name: interface.title for name, interface in INTERFACES.items()},
        "codings": CODINGS_IN_WORDS,
        "word_meanings": WORDS,
        "number_meanings": NUMBERS,
        "note_on_clocks": NOTE_ON_CLOCKS,
        "line": _line_data(),
        "families": [_family_data(device) for device in devices],
        "records": records.values,
        "codes": codes,
        "texts": files.texts.values,
        "lines": files.lines.values,
    }


def _family_data(device: Device) -> dict[str, Any]:
    """Return the title of a family, and the sentences about its grade and its origin."""
    statements = (*grade_below_manual(device), *differences_from_manual(device))
    return {"title": device.title, "statements": [PLAIN_STYLE.sentence(statement) for statement in statements]}


def _line_data() -> dict[str, Any]:
    """Return what is the same for all encoders in one line: the words about them, and a record for each interface."""
    records = {}
    for name, line in _EXAMPLE_LINES.items():
        device, code_match = device_of_line(line)
        records[name] = _record_data(facts_of_order_code(device, code_match.variant))
    other_interfaces = f"there are masters for {Ssi.title} and {Biss.title} only"
    return {**_family_data(device), "records": records, "other_interfaces": other_interfaces}


def _record_data(encoder_record: EncoderFacts) -> dict[str, Any]:
    """Return the facts about an order code without the code, as data for the page."""
    channels = encoder_record.other_channels
    rows = [[row.metres, row.hz, row.is_below, row.is_shorter] for row in encoder_record.cable_table.rows]
    return {
        "words": encoder_record.words,
        "numbers": {name: _exact_number(number) for name, number in encoder_record.numbers.items()},
        "parts": [[part.name, part.role, part.bits, part.active] for part in encoder_record.frame_parts],
        "timeout": encoder_record.timeout,
        "cables": {
            "rows": rows,
            "origin": encoder_record.cable_table.origin,
            "errata": encoder_record.cable_table.errata,
        },
        "mentioned": {topic.name: text for topic, text in encoder_record.mention_by_topic.items() if text},
        "notes": encoder_record.notes,
        "step_text": decimal(encoder_record.count_size_um) if encoder_record.count_size_um is not None else "",
        "document": encoder_record.document_word,
        "used_hz": encoder_record.used_hz,
        "crc_obstacle": encoder_record.crc_obstacle,
        "channel_refusal": channels.refusal(encoder_record.layout_name),
        "channel_gap": channels.gap if channels else "",
    }


def _exact_number(number: int | None) -> int | str | None:
    """Return a number, as text if JavaScript would round it."""
    return str(number) if number is not None and abs(number) > _LARGEST_NUMBER else number


def _master_data(master: Master) -> dict[str, Any]:
    """Return the description of a master, with the expressions of its settings as sums of products."""
    rules = (master.limits, master.settings, master.notes)
    return {
        "name": master.name,
        "title": master.title,
        "takes": master.supported_interfaces,
        "documents": [{"key": item.key, "title": item.title, "url": item.url} for item in master.documents],
        "devices": [{"name": device.name, "channels": device.channels} for device in master.devices],
        "standing": master.standing,
        "several_channels": master.several_channels,
        "limits": master.limits,
        "settings": [_setting_data(rule) for rule in master.settings],
        "writing": master.writing,
        "notes": master.notes,
        "files": master.files,
        "checks_crc": depends_on_crc((master.limits, master.settings)),
        "covered_items": sorted(covered_facts(rules)),
    }


def _setting_data(rule: Mapping[str, Any]) -> dict[str, Any]:
    """Return the rule of a setting, with its expression, and whether it depends on every part of the frame."""
    data = {**rule, "whole_frame": depends_on_whole_frame(rule)}
    if "value" in rule:
        expression = Expression.parse(rule["value"])
        terms = [
            [term.multiple, [[factor.parameter, factor.power] for factor in term.factors]] for term in expression.terms
        ]
        data["expression"] = {
            "constant": _exact_number(expression.constant),
            "terms": terms,
            "parameters": expression.parameters,
            "text": expression.render(),
        }
    return data


def _records_with_sheets(
    device: Device, interface: Interface, masters: Sequence[Master]
) -> Iterator[tuple[EncoderFacts, list[SettingsSheet]]]:
    """Yield the record of each order code with the sheets of all masters, which a group of order codes shares."""
    sheets_by_code: dict[tuple[str, tuple[str, ...]], list[SettingsSheet]] = {}
    for group in order_code_groups(device, interface):
        sheets = [sheet(master, group.facts) for master in masters if master.files]
        answers = tuple(group.facts.answers.values())
        sheets_by_code |= {(code, answers): sheets for code in group.codes}
    for encoder_record in facts_of_order_codes(device, interface):
        yield encoder_record, sheets_by_code[encoder_record.code, tuple(encoder_record.answers.values())]


def _files_by_master(
    device: Device, encoder_record: EncoderFacts, sheets: Sequence[SettingsSheet], files: _Files
) -> dict[str, list[list[Any]]]:
    """Return the files for each master that has any, each as its format, its device and the number of its text."""
    files_by_master: dict[str, list[list[Any]]] = {}
    for master_sheet in sheets:
        if not master_sheet.is_described or master_sheet.refusals:
            continue
        for rule in master_sheet.master.files:
            for master_device in master_sheet.devices_with(rule):
                content = file_text(
                    device, [encoder_record.code], master_sheet, file_rule=rule, master_device=master_device
                )
                number = files.number_of(content.rstrip("\n"), encoder_record.code)
                files_by_master.setdefault(master_sheet.master.name, []).append([rule["format"], master_device, number])
    return files_by_master
