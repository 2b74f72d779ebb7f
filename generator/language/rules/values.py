"""Rules for single numbers and texts: CRC parameters, widths of values, times, clocks, sources."""

from __future__ import annotations

import datetime
import math
import re
from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise

from ...model import INTERFACES, Biss
from ...say.plain_text import counted
from ..document import Path, is_placeholder
from ..problems import DocumentReport, missing, quoted, suggestion
from ..schema_files import is_second
from .walk import (
    MAX_FIELDS,
    Spec,
    by_name,
    explained,
    field_lists,
    interface_of,
    items,
    last_address,
    leaves_of,
    mapping,
    sources,
)

_PIECE = re.compile(r"(?:(?P<key>[a-z][a-z0-9_]*):)?(?P<place>.*)")
_NUMBER = r"(?:[A-Z]\.)?[0-9]+(?:[.-][0-9]+)*"
#: A section by number, or by its heading if it has no number.
#: A heading, a table or a figure may have its own number.
_HEADING = rf"(?!(?i:page|pag|pg|p)\b)[^\W\d_](?:[^\W\d_]|[ '&/()-])+(?: {_NUMBER})?"
_SECTION = rf"{_NUMBER}(?: (?:Table|Figure) {_NUMBER})?|{_HEADING}"
_PAGE = r"p\.[0-9]+(?:-[0-9]+)?"
_PLACE = re.compile(rf"(?:{_SECTION})(?: {_PAGE})?|{_PAGE}")
_RANGE = re.compile(r"([0-9]{1,4}):([0-9]{1,4})")


def field_count(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no list of fields is longer than the schema allows if the groups in it are written out."""
    groups = by_name(raw, "field_groups")
    sizes = {name: len(list(items(group, "fields"))) for name, group in groups.items()}
    for fields in field_lists(spec):
        count = sum(sizes.get(field.get("use", ""), 1) for _, field in fields)
        if count > MAX_FIELDS:
            problem = f"'fields' has {count} entries with those of its groups; the limit is {MAX_FIELDS}"
            report.add("too-long", (*fields.path, "fields"), problem)


def crc_impossible(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the parameters of a CRC fit its width, and that its polynomial ends in + 1."""
    for path, crc in items(spec, "crcs"):
        width, poly = crc["width"], crc["poly"]
        bits_above_width = poly >> width
        if bits_above_width:
            has_only_top_bit = bits_above_width == 1
            hint = f"; omit the top bit: {poly ^ (1 << width):#x}" if has_only_top_bit else ""
            message = f"the polynomial {poly:#x} does not fit into {width} bits{hint}"
            report.add("crc-impossible", (*path, "poly"), message)
        elif poly & 1 == 0:
            message = f"the polynomial {poly:#x} is even; every generator polynomial ends in + 1"
            report.add("crc-impossible", (*path, "poly"), message)
        for key in ("init", "xorout"):
            if crc[key] >> width:
                message = f"{quoted(key)} is {crc[key]:#x}, which does not fit into {width} bits"
                report.add("crc-impossible", (*path, key), message)


def _numbers_in(field: Spec) -> Iterator[tuple[Path, str, int]]:
    """Yield each number that a field must hold, with its path in the field and the beginning of a message about it."""
    for name, value in mapping(field, "values").items():
        yield ("values", name, "value"), f"the value {quoted(name)} is", value["value"]
    for key in ("constant", "unused", "default", "equals"):
        if isinstance(field.get(key), int):
            yield (key,), f"{quoted(key)} is", field[key]


def value_too_wide(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the values of a field fit into it, if its width does not depend on the order code."""
    for fields in field_lists(spec):
        for path, field in fields:
            width = constant_width(field)
            if width is None:
                continue
            for value_path, subject, number in _numbers_in(field):
                is_too_wide = number < 0 or number >> width > 0
                # The number for which zero stands is sent as zero. A constant is sent as it is.
                is_sent_as_zero = number == field.get("zero_means") and value_path != ("constant",)
                if is_too_wide and not is_sent_as_zero:
                    message = f"{subject} {number:#x}, which does not fit into {counted(width, 'bit')}"
                    report.add("value-too-wide", (*path, *value_path), message)


def register_range(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a register is within the addresses of its interface."""
    for path, register in items(spec, "registers"):
        interface = INTERFACES[interface_of(register)]
        if "bank" in register and interface.highest_in_bank is not None:
            area, highest = f"a bank of {interface.short}", interface.highest_in_bank
        elif interface.highest_address is not None:
            area, highest = f"the address range of {interface.short}", interface.highest_address
        else:
            area, highest = "the range of register addresses", 0xFFFF
        last = last_address(register)
        if last > highest:
            message = f"{quoted(register['name'])} extends to {last:#x}, but {area} ends at {highest:#x}"
            report.add("register-range", (*path, "address"), message)


def timing_bounds(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a timing has bounds, in ascending order."""
    for path, timing in _timings(spec):
        bounds = [(key, timing[key]) for key in ("at_least_us", "typical_us", "at_most_us") if key in timing]
        if not bounds:
            report.add("timing-without-bound", path, "a timing needs 'at_least_us', 'typical_us' or 'at_most_us'")
        for (low_key, low), (high_key, high) in pairwise(bounds):
            if low > high:
                message = f"{quoted(high_key)} ({high}) is less than {quoted(low_key)} ({low})"
                report.add("timing-order", (*path, high_key), message)


def clock_range(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that a clock has limits or clocks in use, in ascending order and within the limits."""
    for interface in mapping(spec, "interfaces"):
        path: Path = ("interfaces", interface, "clock")
        clock = mapping(spec, *map(str, path))
        if not clock:
            continue
        # A key rejected by the schema was removed. It must not be reported as missing, too.
        is_complete = clock.keys() == mapping(raw, *map(str, path)).keys()
        if "used_hz" not in clock and is_complete:
            _report_missing_limit(clock, path, report)
        used_clocks = clock.get("used_hz", [])
        if not isinstance(used_clocks, list):
            used_clocks = [used_clocks]
        if used_clocks != sorted(set(used_clocks)):
            report.add("clock-range", (*path, "used_hz"), "list the clocks of 'used_hz' once each, in ascending order")
        clocks = [("used_hz", hz) for hz in used_clocks]
        if "min_hz" in clock:
            clocks.insert(0, ("min_hz", clock["min_hz"]))
        if "max_hz" in clock:
            clocks.append(("max_hz", clock["max_hz"]))
        for (low_key, low), (high_key, high) in pairwise(clocks):
            if low > high and low_key != high_key:
                problem = f"{quoted(low_key)} ({low}) is above {quoted(high_key)} ({high})"
                report.add("clock-range", (*path, low_key), problem)


def _report_missing_limit(clock: Spec, path: Path, report: DocumentReport) -> None:
    """Report that a clock has neither its highest frequency nor one in use."""
    # A source that is still a placeholder marks a clock whose limits are still to be transcribed.
    if "max_hz" not in clock and not is_placeholder(clock.get("source")):
        remedy = "if no document of the manufacturer gives the limits, write 'used_hz'"
        report.add("missing-key", path, f"{missing(['max_hz'], 'a clock')}; {remedy}", at_key=True)


def cable_order(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that longer cables have slower clocks, and that no row of the table repeats another."""
    for interface in mapping(spec, "interfaces"):
        if explained(report.document, "interfaces", interface, "cable_lengths", "below_hz"):
            continue
        rows = items(spec, "interfaces", interface, "cable_lengths")
        by_length = sorted(rows, key=lambda path_and_row: path_and_row[1]["shorter_than_m"])
        for (_, shorter), (path, longer) in pairwise(by_length):
            is_slower = longer["below_hz"] < shorter["below_hz"]
            if not is_slower or shorter["shorter_than_m"] == longer["shorter_than_m"]:
                problem = (
                    f"the clock must be below {longer['below_hz']} Hz for cables shorter than"
                    f" {longer['shorter_than_m']} m, but below {shorter['below_hz']} Hz for cables shorter than"
                    f" {shorter['shorter_than_m']} m; a longer cable needs a slower clock. If this is what the manual"
                    f" says, add an erratum that affects interfaces.{interface}.cable_lengths.below_hz"
                )
                report.add("cable-order", (*path, "below_hz"), problem)


def dates(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that dates exist, and that revisions are in order, up to the transcribed one."""
    manual = mapping(spec, "manual")
    history = list(items(spec, "manual", "history"))
    for path, edition in ((("manual",), manual), *items(spec, "manual", "editions"), *history):
        date = edition.get("date", "")
        is_only_a_year = len(date) <= len("2024")
        if not is_only_a_year and _date(date) is None:
            report.add("date", (*path, "date"), f"{quoted(date)} is not a valid date")
    dated_history = [(path, revision) for path, revision in history if _date(revision.get("date"))]
    for (_, earlier), (path, later) in pairwise(dated_history):
        if later["date"] < earlier["date"]:
            problem = f"revision {later['revision']} is dated {later['date']}, before revision {earlier['revision']}"
            report.add("date", (*path, "date"), f"{problem}, dated {earlier['date']}; list the oldest first")
    own_revision = manual.get("revision")
    own_dates = [revision["date"] for _, revision in dated_history if revision["revision"] == own_revision]
    if own_dates and _date(manual.get("date")) and own_dates[-1] != manual["date"]:
        problem = f"revision {own_revision} is dated {manual['date']}, but {own_dates[-1]} in 'history'"
        report.add("date", ("manual", "date"), problem)


def _date(text: object) -> datetime.date | None:
    try:
        return datetime.date.fromisoformat(text) if isinstance(text, str) else None
    except ValueError:
        return None


def supply_range(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the lowest supply voltage of a device or order code value is not above the highest."""
    supplies: list[tuple[Path, Spec]] = []
    has_supply_of_device = bool(mapping(spec, "supply"))
    if has_supply_of_device:
        supplies.append((("supply",), mapping(spec, "supply")))
    for path, part in items(spec, "order_code", "parts"):
        for text, value in mapping(part, "values").items():
            if not value or "supply" not in value:
                continue
            supply_path = (*path, "values", text, "supply")
            supplies.append((supply_path, value["supply"]))
            if has_supply_of_device:
                problem = "the device already has a 'supply'; keep only one of them"
                report.add("supply-range", supply_path, problem, at_key=True)
    for path, supply in supplies:
        if supply["min_mv"] > supply["max_mv"]:
            problem = f"'min_mv' ({supply['min_mv']}) is above 'max_mv' ({supply['max_mv']})"
            report.add("supply-range", (*path, "min_mv"), problem)


def timeout_mismatch(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that the time-outs calculated in the manual match its rule, to the nearest nanosecond."""
    path: Path = ("interfaces", Biss.name, "timeout")
    timeout = mapping(spec, *map(str, path))
    if not timeout:
        return
    _check_timeout_rule(path, timeout, report)
    clock = mapping(spec, "interfaces", Biss.name, "clock")
    if "max_hz" in clock and not explained(report.document, *map(str, path)):
        low, high = clock.get("min_hz", 0), clock["max_hz"]
        for printed_path, printed in items(timeout, "printed"):
            if not low <= printed["clock_hz"] <= high:
                problem = f"the clock is {low} to {high} Hz, so there is no time-out at {printed['clock_hz']} Hz"
                remedy = f"if the manual gives both, add an erratum that affects {'.'.join(map(str, path))}"
                report.add("timeout-mismatch", (*path, *printed_path, "clock_hz"), f"{problem}; {remedy}")
    if timeout["rule"] != "fixed" and timeout.get("half_clock_periods") is not None:
        _check_calculated_timeouts(path, timeout, report)


def _check_timeout_rule(path: Path, timeout: Spec, report: DocumentReport) -> None:
    """Check that a time-out has the numbers for its rule."""
    has_half_periods = timeout.get("half_clock_periods") is not None
    has_limit = "at_most_ns" in timeout or "typical_ns" in timeout
    if timeout["rule"] == "fixed":
        if has_half_periods:
            message = "a fixed time-out does not depend on the clock; leave 'half_clock_periods' out"
            report.add("timeout-mismatch", (*path, "half_clock_periods"), message, at_key=True)
        if not has_limit:
            report.add("timeout-mismatch", path, "a fixed time-out needs 'at_most_ns' or 'typical_ns'", at_key=True)
    elif timeout["rule"] == "follows_clock" and not has_half_periods and not has_limit and "printed" not in timeout:
        message = (
            "a time-out that depends on the clock needs 'half_clock_periods', "
            "or 'typical_ns', 'at_most_ns' or 'printed' if there is no rule"
        )
        report.add("timeout-mismatch", path, message, at_key=True)


def _check_calculated_timeouts(path: Path, timeout: Spec, report: DocumentReport) -> None:
    """Check that each printed time-out is the given number of half clock periods."""
    half_periods: int = timeout["half_clock_periods"]
    for printed_path, printed in items(timeout, "printed"):
        clock_hz, printed_ns = printed["clock_hz"], printed["timeout_ns"]
        exact_ns = Fraction(half_periods * 10**9, 2 * clock_hz)
        if abs(exact_ns - printed_ns) > Fraction(1, 2):
            rounded_ns = math.floor(exact_ns + Fraction(1, 2))
            message = f"{half_periods} half periods at {clock_hz} Hz are {rounded_ns} ns, not {printed_ns}"
            report.add("timeout-mismatch", (*path, *printed_path, "timeout_ns"), message)


def bad_source(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that sources are well-formed, and that cited editions and documents are listed."""
    languages = (edition.get("language") for _, edition in items(raw, "manual", "editions"))
    editions = [language for language in languages if isinstance(language, str)]
    documents = mapping(raw, "documents")
    own_language = mapping(raw, "manual").get("language")
    for path, value in sources(leaves_of(spec, report)):
        for piece in value.split(";"):
            _check_piece(piece.strip(), path, editions, list(documents), own_language, report)


def _check_piece(
    piece: str, path: Path, editions: list[str], documents: list[str], own_language: object, report: DocumentReport
) -> None:
    """Check one of the places that a source cites, with the edition or document before its colon."""
    match = _PIECE.fullmatch(piece.replace("\n", " ").removeprefix("TODO "))
    key, place = (match["key"], match["place"].strip()) if match is not None else (None, piece)
    if key is not None and key == own_language:
        report.add("bad-source", path, f"{quoted(key)} is the language of the manual itself; leave '{key}:' out")
    elif key is not None and key not in editions and key not in documents:
        hint = suggestion(key, [*editions, *documents])
        report.add("undefined-reference", path, f"there is no edition or document {quoted(key)}{hint}")
    elif key in documents and place:
        return  # Public documents have sections of every kind.
    elif not _PLACE.fullmatch(place):
        piece_text = quoted(piece) if piece else "empty text"
        forms = (
            "cite a section ('6.4' or 'Cover'), a table ('Table 41'), a page ('p.35'), "
            "or a section or table followed by a page"
        )
        message = (
            f"{piece_text} is not a valid source; {forms}. "
            "Separate several sources with semicolons, and prefix those in other documents with the document's key and"
            " a colon"
        )
        report.add("bad-source", path, message)


def _timings(spec: Spec) -> Iterator[tuple[Path, Spec]]:
    for interface in mapping(spec, "interfaces"):
        yield from items(spec, "interfaces", interface, "timings")
    yield from items(spec, "timings")


def constant_width(field: Spec) -> int | None:
    """Return the width of a field if it is constant, or None if it depends on others or another rule reports it."""
    if "bits" in field:
        bits = field["bits"]
        return bits if isinstance(bits, int) and bits > 0 else None
    bit_range = _RANGE.fullmatch(str(field.get("at", "")))
    if bit_range is not None:
        width = int(bit_range[1]) - int(bit_range[2]) + 1
        return width if width > 0 else None
    is_one_bit = "active" in field or isinstance(field.get("at"), int)
    return 1 if is_one_bit else None


#: No encoder has such a low limit in Hz. The highest limits in kHz, of SPI, are still below.
_LOWEST_MAXIMUM_HZ = 50_000
#: The lowest clock in Hz of an encoder whose highest clock is plausible.
_LOWEST_MINIMUM_HZ = 1_000
#: The lowest standard baud rate. Rates in kbaud and Mbaud that do not look like one are below it.
_LOWEST_BAUD = 300
#: Below this number, a unit of MHz is more likely than kHz.
_LIKELY_MEGA = 50
#: Standard baud rates that are not whole numbers of kbaud.
_STANDARD_BAUDS = (9600, 19_200, 38_400, 57_600, 115_200, 230_400, 460_800, 921_600)


def plausible_rate(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no clock or baud rate is too low for an encoder, unless a note of the interface mentions it."""
    if is_second(report.document.file):  # It repeats printed facts, without the notes that may explain them.
        return
    for kind, interface in mapping(spec, "interfaces").items():
        if "note" in interface:
            continue
        clock_path = ("interfaces", kind, "clock")
        clock, port = mapping(interface, "clock"), mapping(interface, "port")
        highest_hz, lowest_hz = clock.get("max_hz"), clock.get("min_hz")
        if highest_hz is not None and highest_hz < _LOWEST_MAXIMUM_HZ:
            _report_rate(highest_hz, "max_hz", "Hz", (*clock_path, "max_hz"), report)
        elif lowest_hz is not None and 0 < lowest_hz < _LOWEST_MINIMUM_HZ:
            _report_rate(lowest_hz, "min_hz", "Hz", (*clock_path, "min_hz"), report)
        if "baud" in port and port["baud"] < _LOWEST_BAUD:
            _report_rate(port["baud"], "baud", "baud", ("interfaces", kind, "port", "baud"), report)


def _report_rate(rate: int, key: str, unit: str, path: tuple[str, ...], report: DocumentReport) -> None:
    """Report a rate that is too low, with the number to write if the manual gives it in a larger unit."""
    prefix, factor = ("M", 1_000_000) if rate < _LIKELY_MEGA else ("k", 1000)
    likely_rate = rate * factor
    if unit == "baud":
        # Manuals round standard rates: 115 kbaud is 115200 baud.
        standard_rates = [standard for standard in _STANDARD_BAUDS if standard // 1000 == rate]
        likely_rate = standard_rates[0] if standard_rates else likely_rate
    problem = f"'{key}' is {rate} {unit}, which is implausible; if the manual means {rate} {prefix}{unit}"
    remedy = f"write {likely_rate}. If the number is right, say so in a 'note' of the interface"
    report.add("implausible-rate", path, f"{problem}, {remedy}")


#: Keys of numbers that manuals print in hexadecimal.
HEXADECIMAL = frozenset("address addresses poly init xorout check control constant unused biss_id".split())
#: Maps whose keys are names defined in the spec.
_OWN_NAMES = frozenset(("values", "arguments", "sets"))
#: Pairs of quotes used by word processors and PDF files.
_TYPOGRAPHIC = frozenset(map(tuple, ("“”", "„“", "„”", "””", "‘’", "‚‘", "’’", "«»", "»«")))
_DECIMAL = re.compile("[0-9]{2,}")
_LEADING_ZERO = re.compile("[-+]?0[0-9]+")


def number_base(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that numbers printed in hexadecimal have 0x, and that no number has leading zeros.

    A JSON file may use decimal numbers, because JSON has no others.
    """
    is_json = report.document.line(1).startswith("{")
    for path, number in leaves_of(spec, report):
        if not isinstance(number, int) or isinstance(number, bool):
            continue
        spelling = report.document.spelling_at(path)
        hexadecimal = f"0x{spelling.lstrip('+-0'):0>2}"
        if not is_json and _is_hexadecimal(path) and _DECIMAL.fullmatch(spelling):
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


def typographic_quotes(spec: Spec, raw: Spec, report: DocumentReport) -> None:
    """Check that no text is in typographic quotes, which YAML treats as part of the text."""
    for path, value in leaves_of(spec, report):
        if isinstance(value, str) and len(value) > 1 and (value[0], value[-1]) in _TYPOGRAPHIC:
            message = (
                f"the quotes {value[0]} and {value[-1]} are part of this text; "
                f'write "{value[1:-1]}" with straight quotes'
            )
            report.add("typographic-quotes", path, message)


def _is_hexadecimal(path: Path) -> bool:
    """Return True for a number that manuals print in hexadecimal."""
    if path[-1] == "value":
        return "writes" in path
    is_name_in_spec = len(path) > 1 and path[-2] in _OWN_NAMES
    return path[-1] in HEXADECIMAL and not is_name_in_spec
