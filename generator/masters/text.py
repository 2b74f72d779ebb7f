"""Output of ``codewheel master``: facts about an order code and its master settings, as text and as plain data."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from functools import lru_cache
from typing import Any

from ..language.problems import join_words
from ..model import INTERFACES, Biss, Device
from ..model.kinds import DIGIT_CODES
from ..order_codes.labels import LabelMatch
from ..say import WIDTH, two_columns, wrap_text
from ..say.names_and_evidence import Topic, differences_from_manual, grade_below_manual
from ..say.order_code import clocks_in_use
from ..say.text import PLAIN_STYLE, hertz, time_text, volts
from .encoder_facts import EncoderFacts
from .places_and_writing import WriteCondition, place_lines, write_order
from .setting_values import padding_text
from .sheet import Master, MasterRefusal, Setting, SettingsSheet

VERSION = 1

#: Words for the code of the position, by its name in the rules for masters.
CODINGS_IN_WORDS = {
    "binary": "binary",
    "gray": "Gray",
    "gray_excess": "Gray excess",
    "gray_with_status": "Gray, position and status bits as one number",
    **{name: code.name for name, code in DIGIT_CODES.items()},
    "other": "Gray, over other bits than the position",
}
#: Widths of the columns with the names and the values of settings. Longer ones move the next column.
_WIDEST_NAME, _WIDEST_VALUE = 40, 18
_MARK_BY_STANDING = {"documented": "", "inferred": " *", "tried": " +"}


def facts_in_words(facts: EncoderFacts) -> Iterator[tuple[str, str]]:
    """Yield the facts about an order code as rows: the name of each fact, and its value in words."""
    yield "Interface", INTERFACES[facts.words["interface"]].title
    yield from _frame_facts(facts)
    yield "Clock", _clock_limits_text(facts)
    if facts.cable_table.rows:
        yield "Clock by cable", _cable_table_text(facts)
    if INTERFACES[facts.words["interface"]] is Biss:
        yield "Timeout", facts.timeout or _not_stated_text(facts, Topic.TIMEOUT)
        # BiSS protocol description, p. 18.
        allowed_busy_time = f"{_not_stated_text(facts, Topic.REPLY_TIME)}, but BiSS C allows 40 µs"
        yield "Busy time", _time_limit_text(facts.numbers["busy_us"], "at most") or allowed_busy_time
    else:
        pause_text = _time_limit_text(facts.numbers["pause_us"], "at least")
        yield "Pause", pause_text or _not_stated_text(facts, Topic.PAUSE)
    yield "Supply", _supply_text(facts) or _not_stated_text(facts, Topic.SUPPLY)


def _frame_facts(facts: EncoderFacts) -> Iterator[tuple[str, str]]:
    """Yield the facts about the bits of the frame as rows: the name of each fact, and its value in words."""
    numbers = facts.numbers
    position_text = str(numbers["position_bits"])
    if numbers["multiturn_bits"]:
        position_text += f": {numbers['multiturn_bits']} multiturn, {numbers['singleturn_bits']} singleturn"
    yield "Position bits", position_text
    yield "Padding", padding_text(facts)
    yield "Status bits", _status_bits_text(facts)
    other_parts = [part.name for part in facts.frame_parts if part.role == "other"]
    if other_parts:
        yield "Other bits", ", ".join(other_parts)
    yield "Data bits", _data_bits_text(facts)
    parts_text = ", ".join(f"{part.name} {part.bits}" for part in facts.frame_parts)
    yield "Order", f"{parts_text}, most significant bit first"
    yield "Code", CODINGS_IN_WORDS[facts.words["coding"]]
    yield "CRC", _crc_text(facts)
    if facts.words["parity"] != "none":
        yield "Parity", f"{facts.words['parity']}, last bit"


def _clock_limits_text(facts: EncoderFacts) -> str:
    """Return the clock limits in words, such as ``at least 80 kHz, below 5 MHz``.

    If the user gave a cable length, it may limit the clock. If the spec gives no limits, the text contains the clocks
    with which the encoder is known to work.
    """
    slowest_hz = facts.numbers["clock_min_hz"]
    fastest_hz = facts.numbers["clock_max_hz"]
    cable_row = facts.cable_row
    limit_texts: list[str] = []
    if slowest_hz is not None:
        limit_texts.append(f"at least {hertz(slowest_hz)}")
    if cable_row is not None and cable_row.is_below:
        limit_texts.append(f"below {hertz(cable_row.hz)}")
    elif fastest_hz is not None:
        limit_texts.append(f"at most {hertz(fastest_hz)}")
    if limit_texts:
        return ", ".join(limit_texts)
    if facts.used_hz:
        return f"{_not_stated_text(facts)}, {clocks_in_use(facts.used_hz)}"
    return _not_stated_text(facts)


def _not_stated_text(facts: EncoderFacts, subject: Topic | None = None) -> str:
    """Return the words for a fact that the manual does not give, or a reference to a text that mentions the subject."""
    reference = facts.mention_by_topic[subject] if subject is not None else ""
    return reference or f"the {facts.document_word} does not say"


def _cable_table_text(facts: EncoderFacts) -> str:
    """Return the table of clocks by cable length in words, with its source, its errata, and the user's cable length."""
    table = facts.cable_table
    rows_text = ", ".join(row.text for row in table.rows)
    errata_text = f", errata {', '.join(table.errata)}" if table.errata else ""
    text = f"{rows_text} (table in {table.origin}{errata_text})"
    if facts.cable_m is None:
        return text
    return f"{text}. Clocks chosen for a cable of {facts.cable_m} m"


def _supply_text(facts: EncoderFacts) -> str:
    """Return the range of the supply voltage, such as ``4.75 V to 5.25 V``, or an empty string if it is unknown."""
    lowest_mv, highest_mv = facts.numbers["supply_min_mv"], facts.numbers["supply_max_mv"]
    if lowest_mv is None or highest_mv is None:
        return ""
    return f"{volts(lowest_mv)} to {volts(highest_mv)}"


def _time_limit_text(time_us: int | None, bound: str) -> str:
    """Return a time with its bound, such as ``at most 40 µs``, or an empty string without a time."""
    return f"{bound} {time_text(time_us)}" if time_us is not None else ""


def _status_bits_text(facts: EncoderFacts) -> str:
    """Return the status bits with their active levels, such as ``error (active low)``, or ``none``."""
    level_words = {"low": "active low", "high": "active high", "": "always 1"}
    status_parts = [part for part in facts.frame_parts if part.role == "status"]
    texts = [f"{part.name} ({level_words[part.active]})" for part in status_parts]
    return ", ".join(texts) or "none"


def _data_bits_text(facts: EncoderFacts) -> str:
    """Return the number of data bits, and the number including other bits: ``24, 26 with the status bits, ...``."""
    numbers = facts.known_numbers
    sizes = [str(numbers["data_bits"])]
    if numbers["status_bits"]:
        sizes.append(f"{numbers['data_and_status_bits']} with the status bits")
    if numbers["other_bits_left"] or numbers["other_bits_right"]:
        sizes.append(f"{numbers['bits_without_crc']} with the other bits")
    if numbers["crc_bits"]:
        sizes.append(f"{numbers['frame_bits']} with the CRC")
    if numbers["parity_bits"]:
        sizes.append(f"{numbers['frame_bits'] + 1} with the parity bit")
    return ", ".join(sizes)


def _crc_text(facts: EncoderFacts) -> str:
    """Return the CRC in words, with its polynomial in three notations, or ``none`` without a CRC."""
    numbers = facts.known_numbers
    if not numbers["crc_bits"]:
        return "none"
    polynomial = numbers["crc_polynomial"]
    without_top_bit = numbers["crc_polynomial_without_top_bit"]
    without_last_1 = numbers["crc_polynomial_without_last_1"]
    notations = f"0x{polynomial:02X} ({polynomial}) with its top bit, 0x{without_top_bit:02X} without it"
    notations += f", 0x{without_last_1:02X} without its trailing 1 (Koopman notation)"
    inversion = "inverted" if numbers["crc_inverted"] else "not inverted"
    form_text = f"sent {inversion}"
    if facts.crc_obstacle:
        form_text = "in a form that masters cannot check, see below"
    return f"{numbers['crc_bits']} bits, polynomial {notations}, start value {numbers['crc_start']}, {form_text}"


def legend_of_marks(masters: Sequence[Master], sheets: Sequence[SettingsSheet], with_places: bool) -> str:
    """Return the sentences that explain the marks of settings: derived from the documents, or tested on hardware.

    ``with_places`` is true if the locations of settings in the master, which also have marks, are shown.
    """
    standings_on_sheets = {master.standing for master in masters}
    for sheet in sheets:
        refusals = (*sheet.refusals, *sheet.gaps)
        rules: tuple[Setting | WriteCondition | MasterRefusal, ...] = (*sheet.settings, *sheet.writing, *refusals)
        standings_on_sheets |= {rule.standing for rule in rules}
        if with_places:
            for setting in sheet.settings:
                standings_on_sheets |= {place.standing for place in setting.places}
    sentences = ["Settings from the documentation of each master."]
    if "inferred" in standings_on_sheets:
        sentences.append("* = derived, not stated there.")
    if "tried" in standings_on_sheets:
        sentences.append("+ = tested on hardware. All others are not yet tested.")
    else:
        sentences.append("Not yet tested on hardware.")
    return " ".join(sentences)


def refusal_text(reason: MasterRefusal) -> str:
    """Return the reason why a master cannot use an encoder, with its mark and its source."""
    source = f" [{cited(reason.source)}]" if reason.source else ""
    return f"{reason.reason}{standing_mark(reason)}{source}"


def bound_in_words(setting: Setting) -> str:
    """Return the words before a value that is a limit, such as ``at most ``, or an empty string."""
    if not setting.bound:
        return ""
    bound_words = setting.bound.replace("_", " ")
    return f"{bound_words} "


def standing_mark(rule: Setting | MasterRefusal | WriteCondition) -> str:
    """Return the mark of a value that is derived (``*``) or tested on hardware (``+``), with a space before it."""
    return _MARK_BY_STANDING[rule.standing]


@lru_cache(4096)
def cited(source: str) -> str:
    """Return the citations of a source, those of whole documents first: ``"X:p. 3; Y"`` becomes ``"Y, X:p. 3"``."""

    def has_page(citation: str) -> bool:
        return ":" in citation

    citations = re.split(r";\s*", source.strip())
    return ", ".join(sorted(citations, key=has_page))


def condition_text(rule: WriteCondition) -> str:
    """Return a condition for writing as a sentence with its mark and source."""
    return f"{rule.text}{standing_mark(rule)} [{cited(rule.source)}]"


def condition_texts(setting: Setting, sheet: SettingsSheet) -> Iterator[str]:
    """Yield sentences about writing one setting: its conditions, and advice to keep a protected factory default."""
    writing_rules = sheet.writing_of(setting)
    if setting.is_default and any(rule.needs for rule in writing_rules):
        yield f"{setting.text} is the factory default. Write it only if the setting was changed."
    yield from (condition_text(rule) for rule in writing_rules)


def _lines_of_needed_values(rule: WriteCondition, master: Master, indent: str) -> list[str]:
    """Return lines with the values to write before (``needs``) and after (``then``) a setting, and their locations."""
    lines: list[str] = []
    for write in (*rule.needs, *rule.then):
        for place_line in place_lines(write.places, write.text, master.devices):
            lines.append(wrap_text(f"{write.title}: {place_line}", WIDTH, prefix=f"{indent}  ", first=indent))
    return lines


def _setting_text(setting: Setting) -> str:
    """Return the value of a setting with its bound and its mark, such as ``at most 5 MHz *``."""
    return f"{bound_in_words(setting)}{setting.text}{standing_mark(setting)}"


def sheet_text(device: Device, code_match: LabelMatch, facts: EncoderFacts, sheets: Sequence[SettingsSheet]) -> str:
    """Return the facts about an order code, and each master's settings or reasons for not supporting it, as text.

    The text is at most 80 columns wide. For a single master, it includes locations and documents. If no master can read
    the position, it contains only the facts.
    """
    lines = _lines_of_facts(device, code_match, facts)
    if facts.obstacle:
        return "\n".join(lines)
    is_single_master = len(sheets) == 1
    legend = legend_of_marks([sheet.master for sheet in sheets], sheets, with_places=is_single_master)
    lines += ["", wrap_text(legend, WIDTH)]
    usable_sheets = [sheet for sheet in sheets if not sheet.refusals]
    for sheet in usable_sheets:
        lines += ["", *_sheet_lines(sheet, with_documents=is_single_master)]
    lines += _lines_of_unusable_masters(facts, sheets)
    if usable_sheets and not is_single_master:
        example = usable_sheets[0].master.name
        lines += ["", f"--master NAME shows one of them with its documents, such as {example}."]
    return "\n".join(lines)


def _lines_of_unusable_masters(facts: EncoderFacts, sheets: Sequence[SettingsSheet]) -> list[str]:
    """Return lines with the masters that cannot use an order code, each with the reasons.

    Masters whose description does not cover the interface follow as a list.
    """
    lines: list[str] = []
    refusing_sheets = [sheet for sheet in sheets if sheet.refusals and sheet.is_described]
    if refusing_sheets:
        lines += ["", wrap_text(f"According to their documentation, these cannot use {facts.code}:", WIDTH)]
    for sheet in refusing_sheets:
        lines.append(wrap_text(f"{sheet.master.title} ({sheet.master.name})", WIDTH, prefix="    ", first="  "))
        lines += [wrap_text(refusal_text(reason), WIDTH, prefix="      ", first="    ") for reason in sheet.refusals]
    undescribed_titles = [sheet.master.title for sheet in sheets if not sheet.is_described]
    if undescribed_titles:
        title = INTERFACES[facts.words["interface"]].title
        sentence = f"These masters are not described for {title}: {'; '.join(undescribed_titles)}."
        lines += ["", wrap_text(sentence, WIDTH, prefix="  ", first="")]
    return lines


def _lines_of_facts(device: Device, code_match: LabelMatch, facts: EncoderFacts) -> list[str]:
    """Return lines with an order code, notes on its label, the grade of the spec, and the facts about it."""
    lines = [wrap_text(f"{code_match.variant.code}: {device.title}", WIDTH, prefix="  ", first="")]
    if code_match.written_as_in:
        lines.append(wrap_text(f"the label is written as in {code_match.written_as_in}", WIDTH, prefix="  "))
    if code_match.unlisted:
        unlisted_parts = ", ".join(code_match.unlisted)
        lines.append(wrap_text(f"accepted, although not listed in the manual: {unlisted_parts}", WIDTH, prefix="  "))
    statements = (*grade_below_manual(device), *differences_from_manual(device))
    lines += [wrap_text(PLAIN_STYLE.sentence(statement), WIDTH, prefix="  ") for statement in statements]
    if code_match.special:
        lines.append(wrap_text("A code that ends in /Sxxx may differ from the manual.", WIDTH, prefix="  "))
    lines += two_columns(facts_in_words(facts), indent=2)
    lines += [wrap_text(note, WIDTH, prefix="  ") for note in facts.notes]
    return lines


def _sheet_lines(sheet: SettingsSheet, with_documents: bool) -> list[str]:
    """Return lines with the settings of a master.

    ``with_documents`` adds the locations of the settings, the file formats, and the documents of the master.
    """
    lines = [wrap_text(f"{sheet.master.title} ({sheet.master.name})", WIDTH, prefix="  ", first="")]
    longest_name = max((len(setting.name) for setting in sheet.settings), default=0)
    longest_value = max((len(_setting_text(setting)) for setting in sheet.settings), default=0)
    name_width = min(longest_name, _WIDEST_NAME)
    value_width = min(longest_value, _WIDEST_VALUE)
    for setting in sheet.settings:
        lines += _setting_lines(setting, sheet, name_width, value_width)
        if with_documents:
            lines += _lines_of_places(setting, sheet)
    lines += [wrap_text(refusal_text(gap), WIDTH, prefix="    ", first="  - ") for gap in sheet.gaps]
    for rule in sheet.shared_writing:
        lines.append(wrap_text(condition_text(rule), WIDTH, prefix="    ", first="  - "))
        if with_documents:
            lines += _lines_of_needed_values(rule, sheet.master, "    ")
    lines += [wrap_text(note, WIDTH, prefix="    ", first="  - ") for note in sheet.notes]
    if with_documents:
        lines += _lines_of_files_and_documents(sheet.master)
    return lines


def _setting_lines(setting: Setting, sheet: SettingsSheet, name_width: int, value_width: int) -> list[str]:
    """Return lines with a setting, in one row or in two if it is too long, followed by its note and its conditions."""
    name_cell = setting.name.ljust(name_width)
    value_cell = _setting_text(setting).ljust(value_width)
    row = f"  {name_cell}  {value_cell}  {setting.at}".rstrip()
    lines = [row]
    if len(row) > WIDTH:
        name_and_place = f"{setting.name}, {setting.at}" if setting.at else setting.name
        lines = [
            wrap_text(name_and_place, WIDTH, prefix="      ", first="  "),
            wrap_text(_setting_text(setting), WIDTH, prefix="      "),
        ]
    if setting.note:
        lines.append(wrap_text(setting.note, WIDTH, prefix="      "))
    lines += [wrap_text(sentence, WIDTH, prefix="      ") for sentence in condition_texts(setting, sheet)]
    return lines


def _lines_of_places(setting: Setting, sheet: SettingsSheet) -> list[str]:
    """Return lines with the locations of a setting, and of the values to write before and after it."""
    places = place_lines(setting.places, setting.text, sheet.master.devices)
    lines = [wrap_text(line, WIDTH, prefix="        ", first="      ") for line in places]
    for rule in sheet.writing_of(setting):
        lines += _lines_of_needed_values(rule, sheet.master, "      ")
    return lines


def _lines_of_files_and_documents(master: Master) -> list[str]:
    """Return lines with the file formats that codewheel can write for a master, and with each of its documents."""
    lines = []
    if master.files:
        formats = join_words((file["format"] for file in master.files), "or")
        lines.append(wrap_text(f"file: --format {formats}", WIDTH, prefix="      ", first="  "))
    for document in master.documents:
        title = f"{document.title}, {document.url}" if document.url else document.title
        lines.append(wrap_text(title, WIDTH, prefix="      ", first=f"  {document.key}: "))
    return lines


def masters_text(masters: Sequence[Master]) -> str:
    """Return the list of masters as text, one per line, each with its interfaces."""
    rows: list[tuple[str, str]] = []
    for master in masters:
        interface_titles = ", ".join(INTERFACES[name].title for name in master.supported_interfaces)
        rows.append((master.name, f"{master.title}: {interface_titles}"))
    return "\n".join(two_columns(rows, indent=0))


def masters_data(masters: Sequence[Master]) -> dict[str, Any]:
    """Return the list of masters as plain data."""
    rows: list[dict[str, Any]] = []
    for master in masters:
        rows.append({"name": master.name, "title": master.title, "takes": list(master.supported_interfaces)})
    return {"version": VERSION, "masters": rows}


def sheet_data(
    device: Device, code_match: LabelMatch, facts: EncoderFacts, sheets: Sequence[SettingsSheet]
) -> dict[str, Any]:
    """Return the facts about an order code and the settings of each master as plain data.

    The JSON Schema of the data is ``language/master_settings.schema.json``.
    """
    return {
        "version": VERSION,
        "order_code": facts.code,
        "family": facts.family,
        "label": {
            "code": code_match.variant.code,
            "unlisted": list(code_match.unlisted),
            "tail": code_match.tail,
            "special": code_match.special,
            "written_as_in": code_match.written_as_in,
        },
        "evidence": device.evidence.grade,
        "placeholders": list(device.evidence.placeholders),
        "alternatives": dict(facts.answers),
        "record": _data_of_facts(facts),
        "masters": [_sheet_data(sheet) for sheet in sheets],
    }


def _data_of_facts(facts: EncoderFacts) -> dict[str, Any]:
    """Return the facts about an order code as plain data."""
    return {
        **facts.words,
        **facts.numbers,
        "clock_used_hz": list(facts.used_hz),
        "frame": [asdict(part) for part in facts.frame_parts],
        "timeout": facts.timeout,
        "cable_m": facts.cable_m,
        "cable_lengths": [asdict(row) for row in facts.cable_table.rows],
        "cable_lengths_from": facts.cable_table.origin if facts.cable_table.rows else "",
        "cable_errata": list(facts.cable_table.errata),
        "notes": list(facts.notes),
    }


def _sheet_data(sheet: SettingsSheet) -> dict[str, Any]:
    """Return the settings of one master as plain data. The list of files is empty if it cannot read the position."""
    names = [setting.name for setting in sheet.settings]
    files = () if sheet.refusals else sheet.master.files
    return {
        "name": sheet.master.name,
        "title": sheet.master.title,
        "takes_it": not sheet.refusals,
        "refusals": [asdict(reason) for reason in sheet.refusals],
        "gaps": [asdict(gap) for gap in sheet.gaps],
        "settings": [asdict(setting) for setting in sheet.settings],
        "writing": [asdict(rule) for rule in sheet.writing],
        "write_order": list(write_order(names, sheet.writing)),
        "files": [{"format": rule["format"], "devices": sheet.devices_with(rule)} for rule in files],
        "notes": list(sheet.notes),
        "documents": [asdict(document) for document in sheet.master.documents],
    }
