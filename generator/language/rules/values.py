"""Rules for single numbers and texts: CRC parameters, widths of values, times, clocks, sources."""

from __future__ import annotations

import datetime
import re
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from typing import NamedTuple

from ...model import INTERFACES, CableLength, Clock, Revision, Supply
from ...say import count_with_unit
from ..document import Path
from ..problems import DocumentReport, missing_keys_message, quoted, suggest_word
from ..written import LocatedPart
from ..written_interfaces import WrittenSsi
from ..written_layouts import WrittenField
from ..written_parts import WrittenManual, WrittenSpec
from .parts import (
    MAX_FIELDS,
    by_name,
    clocks_of,
    constant_width,
    field_lists,
    has_erratum_at,
    interface_name_of,
    interfaces,
    last_address,
    share_order_codes,
    timings,
)
from .walk import is_placeholder, leaves_of, sources

#: One citation, with or without the key of a document: ``6.4 p.35`` or ``errata: 2``.
_CITATION = re.compile(r"(?:(?P<key>[a-z][a-z0-9_]*):)?(?P<place>.*)")
#: The number of a section or table, such as ``6.4``, ``A.2`` or ``7-1``.
_NUMBER = r"(?:[A-Z]\.)?[0-9]+(?:[.-][0-9]+)*"
#: A heading, possibly with a number, such as ``Table 41``. It does not begin with the word for a page.
_HEADING = rf"(?!(?i:page|pag|pg|p)\b)[^\W\d_](?:[^\W\d_]|[ '&/()-])+(?: {_NUMBER})?"
#: A section by number, possibly with a table or figure in it, or by its heading.
_SECTION = rf"{_NUMBER}(?: (?:Table|Figure) {_NUMBER})?|{_HEADING}"
#: One page or several, such as ``p.35`` or ``p.35-36``.
_PAGE = r"p\.[0-9]+(?:-[0-9]+)?"
_CITED_PLACE = re.compile(rf"(?:{_SECTION})(?: {_PAGE})?|{_PAGE}")


def check_field_count(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no list of fields has more than ``MAX_FIELDS`` if the groups in it are written out."""
    counts_by_group = {name: len(group.fields) for name, group in by_name(spec.with_invalid_parts.field_groups).items()}
    for field_list in field_lists(spec):
        count = sum(counts_by_group.get(field.use, 1) for field in field_list.fields)
        if count > MAX_FIELDS:
            problem = f"'fields' has {count} entries with those of its groups; the limit is {MAX_FIELDS}"
            report.add("too-long", field_list.owner.place_of("fields"), problem)


def check_crc_numbers(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that polynomial, start value and final XOR of a CRC fit its width, and that the polynomial is odd."""
    for located_crc in spec.crcs:
        crc = located_crc.part
        path = located_crc.path
        bits_above_width = crc.poly >> crc.width
        is_even = crc.poly & 1 == 0
        if bits_above_width:
            # The polynomial may be written with its top bit, which is implied.
            has_only_top_bit = bits_above_width == 1
            poly_without_top_bit = crc.poly ^ (1 << crc.width)
            hint = f"; omit the top bit: {poly_without_top_bit:#x}" if has_only_top_bit else ""
            message = f"the polynomial {crc.poly:#x} does not fit into {crc.width} bits{hint}"
            report.add("crc-impossible", (*path, "poly"), message)
        elif is_even:
            message = f"the polynomial {crc.poly:#x} is even; every generator polynomial ends in + 1"
            report.add("crc-impossible", (*path, "poly"), message)
        for key, number in (("init", crc.init), ("xorout", crc.xorout)):
            is_too_wide = number >> crc.width > 0
            if is_too_wide:
                message = f"{quoted(key)} is {number:#x}, which does not fit into {crc.width} bits"
                report.add("crc-impossible", (*path, key), message)


def _numbers_in(field: WrittenField) -> Iterator[tuple[Path, str, int]]:
    """Yield each number that must fit in a field, with its path and the start of a message, such as ``'constant' is``.

    These are the numbers of its named values, and its fixed, default and expected numbers.
    """
    for name, value in field.values.items():
        yield value.place_of("value"), f"the value {quoted(name)} is", value.value
    numbers = {"constant": field.constant, "unused": field.unused, "default": field.default, "equals": field.equals}
    for key, number in numbers.items():
        if isinstance(number, int):
            yield field.place_of(key), f"{quoted(key)} is", number


def check_value_widths(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the numbers of a field are not negative and fit in the width of the field.

    A field whose width depends on the order code is not checked.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            width = constant_width(field)
            if width is None:
                continue
            for path, subject, number in _numbers_in(field):
                is_too_wide = number < 0 or number >> width > 0
                # The number for which a stored 0 stands is sent as 0. A constant is sent as it is.
                is_sent_as_zero = number == field.zero_means and path != field.place_of("constant")
                if is_too_wide and not is_sent_as_zero:
                    message = f"{subject} {number:#x}, which does not fit into {count_with_unit(width, 'bit')}"
                    report.add("value-too-wide", path, message)


def check_register_range(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that all bytes of a register are within the addresses of its interface, or of its bank."""
    for register in spec.registers:
        interface = INTERFACES[interface_name_of(register)]
        if register.bank is not None and interface.highest_in_bank is not None:
            area_text = f"a bank of {interface.short}"
            highest_address = interface.highest_in_bank
        elif interface.highest_address is not None:
            area_text = f"the address range of {interface.short}"
            highest_address = interface.highest_address
        else:
            area_text = "the range of register addresses"
            highest_address = 0xFFFF
        end_address = last_address(register)
        if end_address > highest_address:
            extent = f"{quoted(register.name)} extends to {end_address:#x}"
            message = f"{extent}, but {area_text} ends at {highest_address:#x}"
            report.add("register-range", register.place_of("address"), message)


def check_timing_bounds(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a timing has a lowest, a typical or a highest value, and that these are in ascending order."""
    for timing in timings(spec):
        times_by_key = {  # In ascending order.
            "at_least_us": timing.part.at_least_us,
            "typical_us": timing.part.typical_us,
            "at_most_us": timing.part.at_most_us,
        }
        times = [(key, time_us) for key, time_us in times_by_key.items() if time_us is not None]
        if not times:
            message = "a timing needs 'at_least_us', 'typical_us' or 'at_most_us'"
            report.add("timing-without-bound", timing.path, message)
        for (lower_key, lower_us), (higher_key, higher_us) in pairwise(times):
            if lower_us > higher_us:
                message = f"{quoted(higher_key)} ({higher_us}) is less than {quoted(lower_key)} ({lower_us})"
                report.add("timing-order", (*timing.path, higher_key), message)


def check_clock_range(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that a clock has a highest limit or clocks in use, in ascending order and within the limits."""
    # Documents must not give a clock. Then the outputs say that it is not known.
    may_be_unknown = spec.evidence.part.grade == "uncorroborated"
    raw_clocks_by_path: dict[Path, LocatedPart[Clock]] = {}
    for _, raw_interface in interfaces(spec.with_invalid_parts):
        raw_clocks_by_path |= {raw_clock.path: raw_clock for raw_clock in clocks_of(raw_interface)}
    for _, interface in interfaces(spec):
        for clock in clocks_of(interface):
            if not clock.is_given:
                continue
            _check_clock(clock, report)
            if not may_be_unknown:
                _report_missing_limit(clock, raw_clocks_by_path.get(clock.path), report)


def _check_clock(located_clock: LocatedPart[Clock], report: DocumentReport) -> None:
    """Check that the lowest limit of a clock, the frequencies in use and the highest limit are in ascending order."""
    clock = located_clock.part
    used_frequencies = list(clock.used_hz)
    if used_frequencies != sorted(set(used_frequencies)):
        message = "list the clocks of 'used_hz' once each, in ascending order"
        report.add("clock-range", (*located_clock.path, "used_hz"), message)
    frequencies: list[tuple[str, int]] = []  # Each with its key.
    if clock.min_hz is not None:
        frequencies.append(("min_hz", clock.min_hz))
    frequencies += [("used_hz", frequency) for frequency in used_frequencies]
    if clock.max_hz is not None:
        frequencies.append(("max_hz", clock.max_hz))
    for (lower_key, lower_hz), (higher_key, higher_hz) in pairwise(frequencies):
        # A wrong order among the frequencies in use is already reported.
        if lower_hz > higher_hz and lower_key != higher_key:
            problem = f"{quoted(lower_key)} ({lower_hz}) is above {quoted(higher_key)} ({higher_hz})"
            report.add("clock-range", (*located_clock.path, lower_key), problem)


def _report_missing_limit(
    clock: LocatedPart[Clock], raw_clock: LocatedPart[Clock] | None, report: DocumentReport
) -> None:
    """Report a clock without a highest frequency, unless it lists frequencies in use (``used_hz``).

    ``raw_clock`` is the clock together with its invalid keys, which must not be reported as missing.
    """
    is_complete = raw_clock is not None and clock.data.keys() == raw_clock.data.keys()
    is_known = clock.part.max_hz is not None or bool(clock.part.used_hz)
    # A source that is still a placeholder marks a clock whose limits are still to be transcribed.
    if is_complete and not is_known and not is_placeholder(clock.source):
        problem = missing_keys_message(("max_hz",), "a clock")
        remedy = "if no document of the manufacturer gives the limits, write 'used_hz'"
        report.add("missing-key", clock.path, f"{problem}; {remedy}", at_key=True)


def check_cable_order(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the clock limit of SSI is lower for longer cables, and that no two rows have the same length.

    An erratum that affects the table of cable lengths explains a different order.
    """
    for name, interface in interfaces(spec):
        if not isinstance(interface, WrittenSsi):
            continue
        if has_erratum_at(report.document, "interfaces", name, "cable_lengths"):
            continue
        shortest_first = sorted(interface.cable_lengths, key=lambda row: row.part.shorter_than_m)
        for row, row_of_longer_cable in combinations(shortest_first, 2):
            if share_order_codes(row.part, row_of_longer_cable.part):
                _check_cable_order(row.part, row_of_longer_cable, f"interfaces.{name}.cable_lengths", report)


def _check_cable_order(
    shorter: CableLength, row_of_longer_cable: LocatedPart[CableLength], affected_path: str, report: DocumentReport
) -> None:
    """Report the row of a longer cable if its clock limit is not lower than the limit of a shorter cable.

    ``affected_path`` is the path that an erratum must affect to explain it.
    """
    longer = row_of_longer_cable.part
    is_slower = longer.limit_hz < shorter.limit_hz or not shorter.limit_hz
    have_same_length = longer.shorter_than_m == shorter.shorter_than_m
    if not is_slower or have_same_length:
        limit, limit_of_shorter = (f"{row.limit_words} {row.limit_hz} Hz" for row in (longer, shorter))
        problem = (
            f"the clock must be {limit} for cables shorter than {longer.shorter_than_m} m, but {limit_of_shorter} for"
            f" cables shorter than {shorter.shorter_than_m} m; a longer cable needs a slower clock. If this is what the"
            f" manual says, add an erratum that affects {affected_path}"
        )
        report.add("cable-order", (*row_of_longer_cable.path, longer.limit_key), problem)


def check_dates(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that dates exist, that revisions are in order, and that the transcribed revision has the manual's date."""
    _check_that_dates_exist(spec.manual, report)
    dated_history = [revision for revision in spec.manual.history if _parse_date(revision.part.date)]
    _check_order_of_revisions(dated_history, report)
    _check_date_in_history(spec.manual, dated_history, report)


def _check_that_dates_exist(manual: WrittenManual, report: DocumentReport) -> None:
    """Check that each date of the manual, its editions and its revisions exists. It may be empty or only a year."""
    dated_parts = [(manual.path, manual.date)]
    dated_parts += [(edition.path, edition.part.date) for edition in manual.editions]
    dated_parts += [(revision.path, revision.part.date) for revision in manual.history]
    for path, date in dated_parts:
        is_only_a_year = len(date) <= len("2024")  # or empty
        if not is_only_a_year and _parse_date(date) is None:
            report.add("date", (*path, "date"), f"{quoted(date)} is not a valid date")


def _check_order_of_revisions(dated_history: Sequence[LocatedPart[Revision]], report: DocumentReport) -> None:
    """Check that no revision of the history has an earlier date than the one before it."""
    for earlier, later in pairwise(dated_history):
        if later.part.date < earlier.part.date:
            message = (
                f"revision {later.part.revision} is dated {later.part.date}, before revision {earlier.part.revision},"
                f" dated {earlier.part.date}; list the oldest first"
            )
            report.add("date", (*later.path, "date"), message)


def _check_date_in_history(
    manual: WrittenManual, dated_history: Sequence[LocatedPart[Revision]], report: DocumentReport
) -> None:
    """Check that the revision table gives the manual's own revision the date of the manual, if it has both."""
    date_by_revision = {revision.part.revision: revision.part.date for revision in dated_history}
    date_in_history = date_by_revision.get(manual.revision)
    if date_in_history is None or not _parse_date(manual.date):
        return
    if date_in_history != manual.date:
        problem = f"revision {manual.revision} is dated {manual.date}, but {date_in_history} in 'history'"
        report.add("date", manual.place_of("date"), problem)


def _parse_date(date_text: str) -> datetime.date | None:
    """Return the date in a text such as 2024-05-31, or None if it is not a date."""
    try:
        return datetime.date.fromisoformat(date_text)
    except ValueError:
        return None


def check_revision_in_history(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the revision table of a manual lists the manual's own revision, unless an erratum explains it."""
    # A revision that is not text is reported by the schema, and can still be the right revision.
    listed_revisions = [str(row.data.get("revision")) for row in spec.with_invalid_parts.manual.history]
    revision = spec.manual.revision
    has_duplicates = len(set(listed_revisions)) < len(listed_revisions)  # Reported by another rule.
    if not listed_revisions or has_duplicates or not revision or revision in listed_revisions:
        return
    if has_erratum_at(report.document, "manual", "history"):
        return
    problem = f"the manual has revision {quoted(revision)}, but its history lists {', '.join(listed_revisions)}"
    remedy = "correct one of the two, or add an erratum that affects manual.history if the manual prints this"
    report.add("revision-not-in-history", ("manual", "revision"), f"{problem}; {remedy}")


def check_supply_range(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that either the device or values of the order code have a supply, and that its voltages are in order."""
    supplies: list[LocatedPart[Supply]] = []
    if spec.supply is not None and spec.supply.is_given:
        supplies.append(spec.supply)
    has_supply_of_device = bool(supplies)
    for part in spec.order_code.parts:
        for value in part.values.values():
            if value.supply is None:
                continue
            supplies.append(value.supply)
            if has_supply_of_device:
                problem = "the device already has a 'supply'; keep only one of them"
                report.add("supply-range", value.supply.path, problem, at_key=True)
    for located_supply in supplies:
        supply = located_supply.part
        if supply.min_mv > supply.max_mv:
            problem = f"'min_mv' ({supply.min_mv}) is above 'max_mv' ({supply.max_mv})"
            report.add("supply-range", (*located_supply.path, "min_mv"), problem)


def check_source_format(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that sources are well-formed, and that cited editions and documents are listed.

    A source has one or more places, separated by semicolons, each with an optional document: ``6.4 p.35; errata: 2``.
    """
    editions = [edition.part.language for edition in spec.with_invalid_parts.manual.editions if edition.part.language]
    documents = document_names(spec)
    language = spec.with_invalid_parts.manual.language
    known_sources = _KnownSources(language, editions, documents)
    for path, source_text in sources(leaves_of(spec.data, report)):
        for citation in source_text.split(";"):
            _check_citation(citation.strip(), path, known_sources, report)


def document_names(spec: WrittenSpec) -> list[str]:
    """Return the keys of the documents, even of documents with a wrong shape."""
    return spec.with_invalid_parts.names_in("documents")


class _KnownSources(NamedTuple):
    """The documents that a spec can cite: the manual, its editions in other languages, and other documents."""

    #: Language of the manual itself, which is cited without a key.
    language_of_manual: str
    #: Language of each other edition, which is its key.
    editions: list[str]
    #: Keys of other documents.
    documents: list[str]


def _check_citation(citation: str, path: Path, known_sources: _KnownSources, report: DocumentReport) -> None:
    """Check one citation of a source, such as ``6.4 p.35``, or ``errata: 2`` in the document with the key ``errata``.

    The form of the place, such as ``6.4 p.35``, is checked only in the manual and its editions.
    """
    # TODO marks a place that is still to be checked.
    citation_line = citation.replace("\n", " ").removeprefix("TODO ")
    match = _CITATION.fullmatch(citation_line)
    key, place = (match["key"], match["place"].strip()) if match is not None else (None, citation)
    possible_keys = [*known_sources.editions, *known_sources.documents]
    if key is not None and key == known_sources.language_of_manual:
        report.add("bad-source", path, f"{quoted(key)} is the language of the manual itself; remove '{key}:'")
    elif key is not None and key not in possible_keys:
        hint = suggest_word(key, possible_keys)
        report.add("undefined-reference", path, f"there is no edition or document {quoted(key)}{hint}")
    elif key in known_sources.documents and place:
        return  # Public documents have sections of every kind.
    elif not _CITED_PLACE.fullmatch(place):
        citation_text = quoted(citation) if citation else "empty text"
        forms = (
            "cite a section ('6.4' or 'Cover'), a table ('Table 41'), a page ('p.35'), "
            "or a section or table followed by a page"
        )
        message = (
            f"{citation_text} is not a valid source; {forms}. "
            "Separate several sources with semicolons, and prefix those in other documents with the document's key and"
            " a colon"
        )
        report.add("bad-source", path, message)


#: Keys of numbers that manuals print in hexadecimal.
HEXADECIMAL = frozenset("address addresses poly init xorout check control constant unused biss_id".split())
#: Maps whose keys are names defined in the spec.
_OWN_NAMES = frozenset(("values", "arguments", "sets"))
#: Pairs of quotes used by word processors and PDF files.
_TYPOGRAPHIC_QUOTES = frozenset(map(tuple, ("“”", "„“", "„”", "””", "‘’", "‚‘", "’’", "«»", "»«")))
_DECIMAL_DIGITS = re.compile("[0-9]{2,}")
_LEADING_ZERO = re.compile("[-+]?0[0-9]+")


def check_number_base(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that numbers printed in hexadecimal are written with 0x, and that no number has leading zeros.

    A JSON file may use decimal numbers, because JSON has no hexadecimal numbers. A single digit is the same in both
    bases.
    """
    is_json = report.document.line(1).startswith("{")
    for path, number in leaves_of(spec.data, report):
        if not isinstance(number, int) or isinstance(number, bool):
            continue
        spelling = report.document.spelling_at(path)
        # The same digits read as hexadecimal, without sign and leading zeros, with at least two digits.
        digits = spelling.lstrip("+-0")
        hexadecimal = f"0x{digits:0>2}"
        must_be_hexadecimal = not is_json and _is_hexadecimal(path)
        if must_be_hexadecimal and _DECIMAL_DIGITS.fullmatch(spelling):
            decimal_hint = f", or {number:#04x} for decimal {number}" if number > 9 else ""
            message = (
                f"{quoted(path[-1])} is {spelling}, which is decimal, but manuals print it in hexadecimal; "
                f"write {hexadecimal}{decimal_hint}"
            )
            report.add("number-base", path, message)
        elif _LEADING_ZERO.fullmatch(spelling):
            message = (
                f"{spelling} begins with a zero and is read as decimal {number}; "
                f"write {number}, or {hexadecimal} if it is hexadecimal"
            )
            report.add("number-base", path, message)


def check_typographic_quotes(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no text begins and ends with typographic quotes, which YAML treats as part of the text."""
    for path, text in leaves_of(spec.data, report):
        if not isinstance(text, str) or len(text) < 2:
            continue
        first_character, inner_text, last_character = text[0], text[1:-1], text[-1]
        if (first_character, last_character) in _TYPOGRAPHIC_QUOTES:
            message = (
                f"the quotes {first_character} and {last_character} are part of this text; "
                f'write "{inner_text}" with straight quotes'
            )
            report.add("typographic-quotes", path, message)


def _is_hexadecimal(path: Path) -> bool:
    """Return True for the place of a number that manuals print in hexadecimal, such as an address.

    Names that the spec defines, which can be the same as such a key, do not count.
    """
    if path[-1] == "value":
        return "writes" in path
    is_name_in_spec = len(path) > 1 and path[-2] in _OWN_NAMES
    return path[-1] in HEXADECIMAL and not is_name_in_spec
