"""Output of ``codewheel master``: the record of an order code and its master settings, as text and as plain data."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import lru_cache
from typing import Any

from ..language.problems import listed
from ..model import INTERFACES, Biss, Device
from ..order_codes.labels import Match
from ..say.interface import clocks_in_use
from ..say.lines import WIDTH, pairs, wrapped
from ..say.origin import origin
from ..say.text import BY_NAME
from ..say.words import counted, hertz, microseconds, volts
from .places import place_lines
from .record import Record
from .sheet import Master, Refusal, Setting, Sheet
from .writing import Writing, write_order

VERSION = 1

_MARKS = {"documented": "", "inferred": " *", "tried": " +"}


def facts(record: Record) -> Iterator[tuple[str, str]]:
    """Yield the record in words, one fact per row."""
    number, unknown = record.numbers, f"the {record.document} does not say"
    yield "Interface", INTERFACES[record.words["interface"]].title
    turns = number["multiturn_bits"]
    yield (
        "Position bits",
        f"{number['position_bits']}"
        + (f": {turns} multiturn, {number['singleturn_bits']} singleturn" if turns else ""),
    )
    yield (
        "Padding",
        f"{counted(number['padding_left'] or 0, 'zero bit')} before the position, {number['padding_right']} after it",
    )
    yield "Status bits", _status(record)
    yield "Data bits", _data(record)
    yield "Order", ", ".join(f"{part.name} {part.bits}" for part in record.parts) + ", most significant bit first"
    yield "Code", {"binary": "binary", "gray": "Gray"}[record.words["coding"]]
    yield "CRC", _crc(record)
    slowest, fastest = number["clock_min_hz"], number["clock_max_hz"]
    row = record.cable_row
    highest = f"at most {hertz(fastest)}" if fastest is not None else ""
    if row is not None and row.is_below:
        highest = f"below {hertz(row.hz)}"
    limits = (f"at least {hertz(slowest)}" if slowest is not None else "", highest)
    used = f"{unknown}, {clocks_in_use(record.used_hz)}" if record.used_hz else unknown
    yield "Clock", ", ".join(filter(None, limits)) or used
    if record.cables.rows:
        yield "Clock by cable", _cables(record)
    if INTERFACES[record.words["interface"]] is Biss:
        yield "Time-out", record.timeout or unknown
        # The longest in the protocol description, p. 18.
        yield "Busy time", _time(number["busy_us"], "at most") or f"{unknown}, but BiSS C allows 40 µs"
    else:
        yield "Pause", _time(number["pause_us"], "at least") or unknown
    yield "Supply", _supply(record) or unknown


def _cables(record: Record) -> str:
    """Return the table, the requested cable length, and the errata."""
    table = record.cables
    chosen = f". Clocks chosen for a cable of {record.cable_m} m" if record.cable_m is not None else ""
    errata = f", errata {', '.join(table.errata)}" if table.errata else ""
    return f"{', '.join(row.text for row in table.rows)} (table in {table.origin}{errata}){chosen}"


def _supply(record: Record) -> str:
    lowest, highest = record.numbers["supply_min_mv"], record.numbers["supply_max_mv"]
    return f"{volts(lowest)} to {volts(highest)}" if lowest is not None and highest is not None else ""


def _time(value: int | None, bound: str) -> str:
    return f"{bound} {microseconds(value)}" if value is not None else ""


def _status(record: Record) -> str:
    words = {"low": "active low", "high": "active high", "": "always 1"}
    shown = [f"{part.name} ({words[part.active]})" for part in record.parts if part.role == "status"]
    return ", ".join(shown) if shown else "none"


def _data(record: Record) -> str:
    number = record.numbers
    more = [f"{number['data_and_status_bits']} with the status bits"] if number["status_bits"] else []
    more += [f"{number['frame_bits']} with the CRC"] if number["crc_bits"] else []
    return ", ".join([f"{number['data_bits']}", *more])


def _crc(record: Record) -> str:
    number = record.known
    if not number["crc_bits"]:
        return "none"
    whole = number["crc_polynomial"]
    spellings = f"0x{whole:02X} ({whole}) with its top bit, 0x{number['crc_polynomial_without_top_bit']:02X} without it"
    spellings += f", 0x{number['crc_polynomial_without_last_1']:02X} without its trailing 1 (Koopman notation)"
    return (
        f"{number['crc_bits']} bits, polynomial {spellings}, start value {number['crc_start']}, "
        f"sent {'inverted' if number['crc_inverted'] else 'not inverted'}"
    )


def legend(masters: Sequence[Master], sheets: Sequence[Sheet], with_places: bool) -> str:
    """Return the meaning of the marks, and the settings tested on hardware."""
    used = {item.standing for item in masters} | {rule.standing for sheet in sheets for rule in sheet.settings}
    used |= {rule.standing for sheet in sheets for rule in sheet.writing}
    used |= {reason.standing for sheet in sheets for reason in sheet.refusals}
    if with_places:
        used |= {place.standing for sheet in sheets for rule in sheet.settings for place in rule.places}
    inferred = " * = derived, not stated there." if "inferred" in used else ""
    tried = "Not yet tested on hardware."
    if "tried" in used:
        tried = "+ = tested on hardware. All others are not yet tested."
    return f"Settings from the documentation of each master.{inferred} {tried}"


def bound(setting: Setting) -> str:
    """Return ``at least ``, ``at most ``, ``below ``, ``start with `` or an empty string."""
    return f"{setting.bound.replace('_', ' ')} " if setting.bound else ""


def mark(rule: Setting | Refusal | Writing) -> str:
    """Return the mark that the legend explains, after a space so that the value can be copied."""
    return _MARKS[rule.standing]


@lru_cache(4096)
def cited(source: str) -> str:
    """Return keys of documents separated by commas, those without a place first."""
    return ", ".join(sorted(re.split(r";\s*", source.strip()), key=lambda piece: ":" in piece))


def condition(rule: Writing) -> str:
    """Return a condition for writing as a sentence with its mark and source."""
    return f"{rule.text}{mark(rule)} [{cited(rule.source)}]"


def conditions(setting: Setting, sheet: Sheet) -> Iterator[str]:
    """Yield the conditions only for this setting, after the advice to leave a protected factory default unchanged."""
    own = sheet.writing_of(setting)
    if setting.is_default and any(rule.needs for rule in own):
        yield f"{setting.text} is the factory default. Write it only if the setting was changed."
    yield from (condition(item) for item in own)


def _written(rule: Writing, master: Master, indent: str) -> list[str]:
    """Return the places of the values that a condition needs."""
    return [
        wrapped(f"{write.title}: {found}", WIDTH, f"{indent}  ", indent)
        for write in (*rule.needs, *rule.then)
        for found in place_lines(write.places, write.text, master.devices)
    ]


def _shown(setting: Setting) -> str:
    return f"{bound(setting)}{setting.text}{mark(setting)}"


def sheet_text(device: Device, match: Match, record: Record, sheets: Sequence[Sheet]) -> str:
    """Return the record and each master's settings or refusals as text, at most 80 columns wide."""
    lines = [wrapped(f"{match.variant.code}: {device.title}", WIDTH, "  ", "")]
    if match.written_as_in:
        lines.append(wrapped(f"the label is written as in {match.written_as_in}", WIDTH, "  "))
    if match.unlisted:
        lines.append(wrapped(f"accepted, although not listed in the manual: {', '.join(match.unlisted)}", WIDTH, "  "))
    lines += [wrapped(BY_NAME.sentence(item), WIDTH, "  ") for item in origin(device)]
    if match.special:
        lines.append(wrapped("A code that ends in /Sxxx may differ from the manual.", WIDTH, "  "))
    lines += pairs(facts(record), 2)
    lines += [wrapped(note, WIDTH, "  ") for note in record.notes]
    lines += ["", wrapped(legend([item.master for item in sheets], sheets, len(sheets) == 1), WIDTH)]
    taking = [item for item in sheets if not item.refusals]
    for item in taking:
        lines += ["", *_taken(item, with_documents=len(sheets) == 1)]
    refusing = [item for item in sheets if item.refusals and item.speaks]
    if refusing:
        lines += ["", wrapped(f"According to their documentation, these cannot use {record.code}:", WIDTH)]
    for item in refusing:
        lines.append(wrapped(f"{item.master.title} ({item.master.name})", WIDTH, "    ", "  "))
        lines += [
            wrapped(f"{reason.reason}{mark(reason)} [{cited(reason.source)}]", WIDTH, "      ", "    ")
            for reason in item.refusals
        ]
    silent = [item.master.title for item in sheets if not item.speaks]
    if silent:
        title = INTERFACES[record.words["interface"]].title
        lines += ["", wrapped(f"These masters are not described for {title}: {'; '.join(silent)}.", WIDTH, "  ", "")]
    if taking and len(sheets) > 1:
        lines += ["", f"--master NAME shows one of them with its documents, such as {taking[0].master.name}."]
    return "\n".join(lines)


def _taken(sheet: Sheet, with_documents: bool) -> list[str]:
    lines = [wrapped(f"{sheet.master.title} ({sheet.master.name})", WIDTH, "  ", "")]
    names = min(max((len(item.name) for item in sheet.settings), default=0), 40)
    values = min(max((len(_shown(item)) for item in sheet.settings), default=0), 18)
    for item in sheet.settings:
        row = f"  {item.name.ljust(names)}  {_shown(item).ljust(values)}  {item.at}".rstrip()
        if len(row) <= WIDTH:
            lines.append(row)
        else:
            place = f", {item.at}" if item.at else ""
            lines += [wrapped(f"{item.name}{place}", WIDTH, "      ", "  "), wrapped(_shown(item), WIDTH, "      ")]
        if item.note:
            lines.append(wrapped(item.note, WIDTH, "      "))
        lines += [wrapped(found, WIDTH, "      ") for found in conditions(item, sheet)]
        if with_documents:
            places = place_lines(item.places, item.text, sheet.master.devices)
            lines += [wrapped(found, WIDTH, "        ", "      ") for found in places]
            for rule in sheet.writing_of(item):
                lines += _written(rule, sheet.master, "      ")
    for rule in sheet.shared_writing:
        lines.append(wrapped(condition(rule), WIDTH, "    ", "  - "))
        lines += _written(rule, sheet.master, "    ") if with_documents else []
    lines += [wrapped(note, WIDTH, "    ", "  - ") for note in sheet.notes]
    if with_documents and sheet.master.files:
        formats = listed((item["format"] for item in sheet.master.files), "or")
        lines.append(wrapped(f"file: --format {formats}", WIDTH, "      ", "  "))
    for document in sheet.master.documents if with_documents else ():
        where = f"{document.title}, {document.url}" if document.url else document.title
        lines.append(wrapped(where, WIDTH, "      ", f"  {document.key}: "))
    return lines


def masters_text(masters: Sequence[Master]) -> str:
    """Return the list of masters, one per line."""
    return "\n".join(
        pairs(
            (
                (item.name, f"{item.title}: {', '.join(INTERFACES[name].title for name in item.takes)}")
                for item in masters
            ),
            0,
        )
    )


def masters_data(masters: Sequence[Master]) -> dict[str, Any]:
    return {
        "version": VERSION,
        "masters": [{"name": item.name, "title": item.title, "takes": list(item.takes)} for item in masters],
    }


def sheet_data(match: Match, record: Record, sheets: Sequence[Sheet]) -> dict[str, Any]:
    """Return the record and the settings as plain data, in the shape of ``language/master_settings.schema.json``."""
    return {
        "version": VERSION,
        "order_code": record.code,
        "family": record.family,
        "label": {
            "code": match.variant.code,
            "unlisted": list(match.unlisted),
            "tail": match.tail,
            "special": match.special,
            "written_as_in": match.written_as_in,
        },
        "alternatives": dict(record.answers),
        "record": {
            **record.words,
            **record.numbers,
            "clock_used_hz": list(record.used_hz),
            "frame": [asdict(part) for part in record.parts],
            "timeout": record.timeout,
            "cable_m": record.cable_m,
            "cable_lengths": [asdict(row) for row in record.cables.rows],
            "cable_lengths_from": record.cables.origin if record.cables.rows else "",
            "cable_errata": list(record.cables.errata),
            "notes": list(record.notes),
        },
        "masters": [
            {
                "name": item.master.name,
                "title": item.master.title,
                "takes_it": not item.refusals,
                "refusals": [asdict(reason) for reason in item.refusals],
                "settings": [asdict(setting) for setting in item.settings],
                "writing": [asdict(rule) for rule in item.writing],
                "write_order": list(write_order([setting.name for setting in item.settings], item.writing)),
                "files": [
                    {"format": rule["format"], "devices": item.devices_with(rule)}
                    for rule in (() if item.refusals else item.master.files)
                ],
                "notes": list(item.notes),
                "documents": [asdict(document) for document in item.master.documents],
            }
            for item in sheets
        ],
    }
