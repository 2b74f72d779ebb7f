"""Write a line as a spec with the grade ``uncorroborated``, and build the device that the line describes from it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..language.problems import Problem, ProblemReport
from ..language.read import document_of_text
from ..loading.library import families_of
from ..model import Device
from ..order_codes.labels import LabelMatch
from .line import (
    IN_TURN,
    POSITION,
    TURNS,
    CrcField,
    EncoderLine,
    FillerField,
    FlagField,
    LineError,
    LineField,
    LineProblem,
    NumberField,
    ParityField,
)
from .parse import parse_line

#: Source of the facts that the line states, and of the remaining facts.
_SOURCE_LINE, _NOT_STATED = '"line: fields"', "TODO not stated"
_LAYOUT_NAMES = {"biss": "single_cycle_data", "ssi": "ssi_word", "spi": "position_word", "rs485": "reply"}
_CRC_NAME = "line_crc"
#: Baud rate in the spec if the line states none. It is marked with TODO.
_PLACEHOLDER_BAUD = 115200
#: Units and meanings of fields.
_UNIT_AND_MEANING = {
    POSITION: ("counts", "Position"),
    IN_TURN: ("counts", "Position within one revolution"),
    TURNS: ("revolutions", "Number of revolutions"),
}
_MEANING_BY_VERDICT = {
    "not_usable": "an error is active",
    "usable_with_warning": "a warning is active",
    "usable": "the bit is active",
}
#: Text that is replaced by the schema of devices once the place of the spec is known.
SCHEMA = "device.schema.json"


def spec_text(line: EncoderLine, name: str, manufacturer: str, schema: str = SCHEMA) -> str:
    """Return the text of a spec for the encoder that a line describes, with the family name ``name``.

    ``codewheel check`` accepts this spec. ``schema`` is the path of the JSON Schema for editors.
    """
    return "\n".join(
        [
            *_write_head(line, name, manufacturer, schema),
            *_write_crc(line),
            *_write_interface(line),
            *_write_erratum(line),
            "",
        ]
    )


def order_code(line: EncoderLine, name: str) -> str:
    """Return the order code in the spec of a line, which has only one, such as ``MY-ENCODER-BISS``."""
    return f"{_fixed_text_of_code(name)}-{line.interface.upper()}"


def _fixed_text_of_code(family_name: str) -> str:
    """Return the family name in the form in which order codes begin, such as ``MY-ENCODER`` for ``my_encoder``."""
    return family_name.replace("_", "-").upper()


def _write_head(line: EncoderLine, family_name: str, manufacturer: str, schema: str) -> Iterator[str]:
    """Yield the lines of the spec up to and including its measurement."""
    yield f"# yaml-language-server: $schema={schema}"
    yield "#"
    yield "# Written from one line. TODO marks what it does not state. Replace these facts and their sources with those"
    yield "# of the manual, and raise the grade when the manual confirms the others."
    yield ""
    yield "codewheel: 1"
    yield f"device: {family_name}"
    yield f"manufacturer: {manufacturer}"
    yield f"title: {_fixed_text_of_code(family_name)}, described in one line"
    yield "movement: rotary"
    yield "evidence:"
    yield "  grade: uncorroborated"
    yield "  implementations: [line]"
    yield "  left_out:"
    for gap in line.gaps:
        yield f"    - {json.dumps(gap)}"
    yield ""
    yield "manual:"
    yield "  title: Description in one line"
    yield '  revision: "1.0"'
    yield "  language: en"
    yield ""
    yield "documents:"
    yield f"  line: {{title: {json.dumps(line.text)}}}"
    yield ""
    yield "parameters: {}"
    yield ""
    yield "order_code:"
    yield f'  pattern: "{_fixed_text_of_code(family_name)}-{{output}}"'
    yield f"  source: {_SOURCE_LINE}"
    yield "  parts:"
    only_value = f"{{{line.interface.upper()}: {{meaning: The interface of the line, interface: {line.interface}}}}}"
    yield f"    - {{name: output, meaning: Interface, values: {only_value}}}"
    yield ""
    yield from _write_measurement(line)


def _write_measurement(line: EncoderLine) -> Iterator[str]:
    """Yield the counts per revolution and the number of revolutions, if the line states them."""
    widths = {field.name: field.bits for field in line.fields}
    if IN_TURN in widths:
        counts = f"2^{widths[IN_TURN]}"
        turns = f"2^{widths[TURNS]}" if TURNS in widths else "1"
    elif line.options.counts:
        counts = str(line.options.counts)
        turns = str(line.options.turns or 1)
    else:
        return
    # Without a field for turns, the position within a revolution is the whole position.
    is_singleturn = IN_TURN in widths and TURNS not in widths
    measured_field = IN_TURN if is_singleturn else POSITION
    yield f"measurement: {{of: {measured_field}, counts_per_turn: {counts}, turns: {turns}, source: {_SOURCE_LINE}}}"
    yield ""


def _write_crc(line: EncoderLine) -> Iterator[str]:
    """Yield the definition of the CRC, if the line has one."""
    for field in line.fields:
        if isinstance(field, CrcField):
            all_ones = (1 << field.bits) - 1
            xorout = all_ones if field.is_inverted else 0
            numbers = f"width: {field.bits}, poly: {field.poly:#x}, init: {field.init:#x}"
            yield "crcs:"
            is_reflected = "true" if field.is_reflected else "false"
            bit_order = f"refin: {is_reflected}, refout: {is_reflected}"
            yield f"  - {{name: {_CRC_NAME}, {numbers}, {bit_order}, xorout: {xorout:#x}, source: {_SOURCE_LINE}}}"
            yield ""


def _write_interface(line: EncoderLine) -> Iterator[str]:
    """Yield the interface with its layouts. The source of facts that the line does not state is ``TODO not stated``."""
    options = line.options
    yield "interfaces:"
    yield f"  {line.interface}:"
    if line.interface == "rs485":
        yield from _write_serial_port(line)
    else:
        yield from _write_clock(line)
    if line.interface == "spi":
        yield f"    word_bits: {line.bits}"
        yield "    reply: same_word"
    if line.interface == "ssi":
        alignment = options.alignment or "msb_left"
        source = _SOURCE_LINE if options.alignment else _NOT_STATED
        output_code = "gray" if options.is_gray else "binary"
        yield f"    alignment: {alignment}"
        yield f"    alignment_source: {source}"
        yield f"    output_code: {output_code}"
    yield "    layouts:"
    if line.interface == "rs485":
        yield from _write_request(line)
    yield from _write_layout(line)


def _write_clock(line: EncoderLine) -> Iterator[str]:
    """Yield the clock of the interface and, for SPI, its mode."""
    options = line.options
    is_mode_unknown = line.interface == "spi" and options.mode is None
    source = _NOT_STATED if is_mode_unknown else _SOURCE_LINE
    yield f"    source: {source}"
    if line.interface == "spi":
        yield f"    mode: {options.mode or 0}"
    if options.clock_hz:
        yield f"    clock: {{used_hz: {options.clock_hz}, source: {_SOURCE_LINE}}}"
    else:
        yield f"    clock: {{source: {_NOT_STATED}}}"


def _write_serial_port(line: EncoderLine) -> Iterator[str]:
    """Yield the settings of the serial port, and the exchange: the request and its reply."""
    source = _SOURCE_LINE if line.options.baud else _NOT_STATED
    port = f"baud: {line.options.baud or _PLACEHOLDER_BAUD}, data_bits: 8, parity: none, stop_bits: 1"
    yield f"    source: {_SOURCE_LINE}"
    yield f"    port: {{{port}, source: {source}}}"
    yield "    exchanges:"
    # A request with the purpose ``position`` needs a measurement.
    has_measurement = line.options.counts > 0 or line.has(IN_TURN)
    purpose = "position" if has_measurement else "other"
    yield f"      - {{request: position_request, reply: reply, purpose: {purpose}, source: {_SOURCE_LINE}}}"


def _write_request(line: EncoderLine) -> Iterator[str]:
    """Yield the layout of the RS-485 request that the encoder answers with the frame of the line.

    If the line does not state the request, it is one byte with any value.
    """
    request = line.options.request
    content = f"constant: {int.from_bytes(request, 'big'):#x}" if request else "meaning: Request"
    yield "      - name: position_request"
    yield "        from: master"
    yield "        byte_order: high_byte_first"
    yield f"        source: {_SOURCE_LINE if request else _NOT_STATED}"
    yield "        fields:"
    request_bits = 8 * len(request) if request else 8
    yield f"          - {{name: request, bits: {request_bits}, {content}}}"


def _write_layout(line: EncoderLine) -> Iterator[str]:
    """Yield the layout of the frame that the encoder sends, with its fields."""
    yield f"      - name: {_LAYOUT_NAMES[line.interface]}"
    yield "        from: encoder"
    yield f"        source: {_SOURCE_LINE}"
    if line.interface == "rs485":
        yield f"        byte_order: {line.options.byte_order or 'high_byte_first'}"
    elif any(_byte_names(field, line) for field in line.fields):
        yield "        byte_order: low_byte_first"
    joins = list(_write_joins(line))
    if joins:
        yield "        join:"
        yield from joins
    if line.options.is_gray:
        is_singleturn = line.has(IN_TURN) and not line.has(TURNS)
        gray_field = IN_TURN if is_singleturn else POSITION
        yield f"        gray: {{of: {gray_field}}}"
    yield "        fields:"
    # A parity bit covers all other fields except the CRC.
    parity_fields = [name for name in _field_names(line) if name not in ("parity", "crc")]
    for field, name in zip(line.fields, _names_in_spec(line), strict=True):
        for keys in _write_field(field, name, line, parity_fields):
            yield f"          - {{{keys}}}"


def _names_in_spec(line: EncoderLine) -> list[str]:
    """Return the name of each field in the spec. Fields of zeros or unused bits get distinct names.

    They are ``zero_bits``, ``zero_bits_2`` and so on.
    """
    names_in_line = {field.name for field in line.fields if not isinstance(field, FillerField)}
    names: list[str] = []
    for field in line.fields:
        if not isinstance(field, FillerField):
            names.append(field.name)
            continue
        name = f"{field.name}_bits"
        number = 1
        while name in names or name in names_in_line:
            number += 1
            name = f"{field.name}_bits_{number}"
        names.append(name)
    return names


def _field_names(line: EncoderLine) -> list[str]:
    """Return the names of all fields of the layout in the spec, in the order in which they are sent.

    A number that is sent low byte first consists of several fields, one for each byte.
    """
    names: list[str] = []
    for field, name in zip(line.fields, _names_in_spec(line), strict=True):
        names += _byte_names(field, line) or [name]
    return names


def _byte_names(field: LineField, line: EncoderLine) -> list[str]:
    """Return the names of the bytes of a number if it must be split because SPI sends it low byte first.

    They are in the order in which they are sent: ``position_byte_0``, ``position_byte_1``. The list is empty for all
    other fields.
    """
    is_low_byte_first_spi = line.interface == "spi" and line.options.byte_order == "low_byte_first"
    if not is_low_byte_first_spi or not isinstance(field, NumberField) or field.bits <= 8:
        return []
    return [f"{field.name}_byte_{index}" for index in range(field.bits // 8)]


def _write_joins(line: EncoderLine) -> Iterator[str]:
    """Yield the numbers that several fields form: numbers that are split into bytes, and the position of a multiturn.

    Their fields are listed most significant first.
    """
    fields_of_number: dict[str, Sequence[str]] = {}
    for field in line.fields:
        bytes_as_sent = _byte_names(field, line)  # low byte first
        most_significant_first = bytes_as_sent[::-1]
        fields_of_number[field.name] = most_significant_first or [field.name]
        if most_significant_first:
            yield f"          {field.name}: [{', '.join(most_significant_first)}]"
    if TURNS in fields_of_number and IN_TURN in fields_of_number:
        fields_of_position = [*fields_of_number[TURNS], *fields_of_number[IN_TURN]]
        yield f"          {POSITION}: [{', '.join(fields_of_position)}]"


def _write_erratum(line: EncoderLine) -> Iterator[str]:
    """Yield an erratum about the differences from usual BiSS frames, without which ``check`` would report them."""
    places = list(_places_unlike_biss(line)) if line.interface == "biss" else []
    if not places:
        return
    yield ""
    yield "errata:"
    yield "  - name: unlike_biss"
    yield "    title: The line describes a frame that is unusual for BiSS"
    yield f"    source: {_SOURCE_LINE}"
    yield "    printed: A frame of BiSS has the position, the active-low error and warning bits, and an inverted CRC."
    yield "    used: The frame of the line."
    yield "    why: The manual or the encoder must decide."
    yield "    status: open"
    yield "    severity: wrong_data"
    yield f"    affects: [{', '.join(places)}]"


def _places_unlike_biss(line: EncoderLine) -> Iterator[str]:
    """Yield the path in the spec of each difference from a usual BiSS frame, such as ``crcs.line_crc.xorout``.

    A usual frame has the position, then the error bit and the warning bit, both active low, and an inverted CRC.
    Nothing is yielded for a frame without an error or warning bit.
    """
    frame = f"interfaces.biss.{_LAYOUT_NAMES['biss']}"
    names = [field.name for field in line.fields]
    flag_names = [name for name in names if name in ("error", "warning")]
    if not flag_names:
        return
    for field in line.fields:
        if isinstance(field, FlagField) and field.name in flag_names and field.level == "high":
            yield f"{frame}.{field.name}.active"
        if isinstance(field, CrcField) and not field.is_inverted:
            yield f"crcs.{_CRC_NAME}.xorout"
    if flag_names == ["warning", "error"]:
        yield f"{frame}.warning"
    first_flag = flag_names[0]
    names_from_first_flag = names[names.index(first_flag) :]
    numbers_after_flags = [name for name in names_from_first_flag if name in _UNIT_AND_MEANING]
    if numbers_after_flags:
        first_number = numbers_after_flags[0]
        yield f"{frame}.{first_number}"
    if "crc" not in names:
        yield f"{frame}.fields"


def _write_field(field: LineField, name: str, line: EncoderLine, parity_fields: Sequence[str]) -> Iterator[str]:
    """Yield the keys of a field in the spec, such as ``name: zero_bits, bits: 2, constant: 0``.

    A number that is sent low byte first has keys for each byte. In a frame without a position, effects on the position
    are omitted.
    """
    byte_names = _byte_names(field, line)
    if byte_names:
        for byte_name in byte_names:
            yield f"name: {byte_name}, bits: 8"
        return
    has_position = line.has(POSITION) or line.has(IN_TURN)
    match field:
        case NumberField():
            has_counts = field.name == POSITION and line.options.counts
            note = ", note: The line states its bits and its counts." if has_counts else ""
            yield _keys_of_number(field) + note
        case FlagField():
            effect = f", makes_position: {field.verdict}" if has_position else ""
            levels = {flag.level for flag in line.fields if isinstance(flag, FlagField)}
            # 'check' expects a text about the level of a flag that differs from all others.
            note = f", note: The line states that it is active {field.level}." if len(levels) > 1 else ""
            when_active = f"when_active: {_MEANING_BY_VERDICT[field.verdict]}"
            yield f"name: {name}, active: {field.level}{effect}, {when_active}{note}"
        case FillerField(name="zero"):
            yield f"name: {name}, bits: {field.bits}, constant: 0"
        case FillerField():
            unused = ", unused: 0, makes_position: usable" if has_position else ""
            yield f"name: {name}, bits: {field.bits}{unused}"
        case ParityField():
            yield f"name: {name}, parity_of: [{', '.join(parity_fields)}], parity: {field.kind}"
        case CrcField():
            byte_order = f", byte_order: {field.byte_order}" if field.byte_order else ""
            yield f"name: {name}, crc: {_CRC_NAME}{byte_order}"


def _keys_of_number(field: NumberField) -> str:
    """Return the keys of a number in the spec. Only fields of the position have a unit and a meaning."""
    keys = f"name: {field.name}, bits: {field.bits}"
    if field.is_signed:
        keys += ", signed: true"
    if field.value is not None:
        return f"{keys}, constant: {field.value:#x}"
    unit, meaning = _UNIT_AND_MEANING.get(field.name, ("", ""))
    return f"{keys}, unit: {unit}, meaning: {meaning}" if unit else keys


#: Names of the family and of the manufacturer. No output contains them.
_FAMILY_NAME, _MANUFACTURER_NAME = "one_line", "example"
_MANUFACTURER_TEXT = f"codewheel: 1\nmanufacturer: {_MANUFACTURER_NAME}\ntitle: manufacturer not stated\nsource: line\n"


def device_of_line(text: str) -> tuple[Device, LabelMatch]:
    """Return the device that a line describes, and its order code, which is the line itself.

    Raises:
        LineError: The line has problems.
    """
    line = parse_line(text)
    report = ProblemReport()
    texts = {
        f"{_FAMILY_NAME}.yaml": spec_text(line, _FAMILY_NAME, _MANUFACTURER_NAME),
        "manufacturer.yaml": _MANUFACTURER_TEXT,
    }
    documents = [document_of_text(file, file_text, report) for file, file_text in texts.items()]
    families = families_of([document for document in documents if document is not None], report)
    if report or not families:
        raise LineError(line.text, _problems_in_line(line, report))
    device = families[0].device
    variant = replace(device.variants[0], code=line.text)
    # Placeholders are facts that the line does not state. Outputs for one line state this themselves.
    evidence = replace(device.evidence, placeholders=())
    device = replace(device, variants=(variant,), evidence=evidence, title="Encoder described in one line")
    return device, LabelMatch(variant, unlisted=(), tail="", special=False)


def _problems_in_line(line: EncoderLine, report: ProblemReport) -> list[LineProblem]:
    """Return the problems in the spec of a line as problems of the line, each at the column of its field."""
    column_by_field = {field.name: field.column for field in line.fields}
    return [LineProblem(_column_of(problem, column_by_field), problem.message) for problem in report.problems]


def _column_of(problem: Problem, column_by_field: dict[str, int]) -> int:
    """Return the column of the field that the path of a problem names, or 1 if it names no field of the line."""
    _, _, path_in_fields = problem.path.partition(".fields.")
    field_name = path_in_fields.partition(".")[0]
    return column_by_field.get(field_name, 1)
