"""Build the worked examples, and compare them with the model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import get_args

from ..language.document import Path
from ..language.problems import DocumentReport
from ..model import (
    Crc,
    CrcExample,
    Device,
    Example,
    Fault,
    FrameExample,
    MeasureExample,
    ProcedureExample,
    Register,
    RegisterExample,
    Variant,
    assert_never,
    number_from_bytes,
)
from ..order_codes.labels import UnknownOrderCode, find_code
from ..order_codes.parameters import with_answers
from ..reference.bits import bits_in_crc_order, compute_bytes, covered_bits, init_for_result
from ..reference.codec import DecodedFrame, EncodeError, decode, decode_bits, decode_bytes, decode_placed, encode
from ..reference.registers import register_writes
from .from_mapping import Raw, build_part
from .valid_parts import valid_parts_so_far

#: Key in an example that is wrong, such as ``("values", "position")``, and the message.
Wrong = tuple[Path, str]

_EXAMPLES: Mapping[str, Callable[..., Example]] = {kind.kind: kind for kind in get_args(Example)}


def build_examples(raw_spec: Raw) -> tuple[Example, ...]:
    return tuple(map(_build_example, raw_spec.get("examples", ())))


def _build_example(raw_example: Raw) -> Example:
    """Return one example. Its sender is the encoder unless the spec has ``from``."""
    members = {
        "sender": raw_example.get("from", "encoder"),
        **raw_example,
        "bytes": bytes.fromhex(raw_example.get("bytes", "")),
    }
    return build_part(_EXAMPLES[raw_example["kind"]], members)


def check_examples(device: Device, report: DocumentReport) -> None:
    """Report every example that contradicts its layout, CRC or procedure, if all parts that it needs are valid."""
    valid_parts = valid_parts_so_far(report)
    for example in device.examples:
        if not valid_parts.holds(example) or not _is_built(device, example):
            continue
        for path_in_example, problem in _errors_of_example(device, example):
            message = f"example '{example.name}' does not match: {problem}"
            report.add("example-contradicts", ("examples", example.name, *path_in_example), message)


def _is_built(device: Device, example: Example) -> bool:
    """Return True if the parts that the example names, and all interfaces, were built.

    Parts that were not built have been reported.
    """
    register_names = {register.name for register in device.registers}
    match example:
        case FrameExample():
            is_complete = not example.layout or example.layout in {layout.name for _, layout in device.layouts()}
        case RegisterExample():
            is_complete = example.register in register_names
        case ProcedureExample():
            procedures = [procedure for procedure in device.procedures if procedure.name == example.procedure]
            is_complete = any(procedure.registers <= register_names for procedure in procedures)
        case CrcExample() | MeasureExample():
            is_complete = True
        case _:
            assert_never(example)
    # Without order codes, which have been reported then, only a CRC can be computed.
    if not device.variants and not isinstance(example, CrcExample):
        return False
    built_interfaces = {interface.name for interface in device.interfaces}
    return is_complete and all(variant.interface in built_interfaces for variant in device.variants)


def _errors_of_example(device: Device, example: Example) -> list[Wrong]:
    """Return the errors of an example. An unknown order code or an impossible value is one error of its own."""
    try:
        return list(_yield_errors(device, example))
    except UnknownOrderCode as reason:
        return [(("order_code",), str(reason))]
    except EncodeError as reason:
        return [(_data_path(example), str(reason))]


def example_variant(device: Device, example: Example) -> Variant:
    """Return the order code of the example, or the first one of the family if it gives none.

    A frame example that gives one can also choose answers of alternatives. They replace parameters of the order code.

    Raises:
        UnknownOrderCode: The family has no such order code.
    """
    if isinstance(example, CrcExample) or not example.order_code:
        return device.variants[0]
    listed_variants = [variant for variant in device.variants if variant.code == example.order_code]
    # Other labels represent a listed code, for example in another spelling.
    variant = listed_variants[0] if listed_variants else find_code(device, example.order_code).variant
    if isinstance(example, FrameExample):
        return with_answers(device, variant, example.alternatives)
    return variant


def _yield_errors(device: Device, example: Example) -> Iterator[Wrong]:
    """Yield the errors of an example. Its kind determines what is computed and compared."""
    match example:
        case FrameExample():
            yield from _check_frame(device, example)
        case RegisterExample():
            yield from _check_register(device, example)
        case CrcExample():
            computed_crc = compute_bytes(device.crc(example.crc), example.bytes)
            if computed_crc != example.check:
                suggestion = _suggest_start(device, example.crc)
                yield ("check",), f"the CRC over these bytes is {computed_crc:#04x}{suggestion}"
        case ProcedureExample():
            yield from _check_procedure(device, example)
        case MeasureExample():
            yield from _check_measure(device, example)
        case _:
            assert_never(example)


def _check_procedure(device: Device, example: ProcedureExample) -> Iterator[Wrong]:
    """Yield an error if the procedure, with the arguments of the example, does not produce the printed writes."""
    procedure = device.procedure(example.procedure)
    variant = example_variant(device, example)
    computed_writes = register_writes(device, procedure, variant, example.arguments)
    if computed_writes != example.writes:
        computed_text = ", ".join(f"{write.address:02X}h = {write.value:02X}h" for write in computed_writes)
        yield ("writes",), f"the writes are {computed_text}"


def _check_measure(device: Device, example: MeasureExample) -> Iterator[Wrong]:
    """Yield an error if the counts times the length of one count differ from the printed micrometres."""
    variant = example_variant(device, example)
    measurement = device.measurement_of(variant.interface)
    if measurement is None or measurement.step_um is None:
        yield (), "the device does not measure a length in micrometres"
        return
    micrometres = measurement.step_um.value(variant.parameters) * example.counts
    if micrometres != example.micrometres:
        yield ("micrometres",), f"{example.counts} counts are {micrometres} micrometres"


def _check_register(device: Device, example: RegisterExample) -> Iterator[Wrong]:
    """Yield an error for a wrong length, or else the errors of the decoded values, or else those of the identity."""
    register = device.register(example.register)
    variant = example_variant(device, example)
    if len(example.bytes) != register.length:
        message = f"register '{register.name}' has {register.length} bytes, but the example has {len(example.bytes)}"
        yield ("bytes",), message
        return
    register_number = number_from_bytes(register.layout, example.bytes)
    decoded = decode(device, register.layout.place(variant.parameters), register_number)
    differences = list(_check_decoded(device, decoded, example))
    yield from differences or _check_identity(register, decoded, variant)


def _check_identity(register: Register, decoded: DecodedFrame, variant: Variant) -> Iterator[Wrong]:
    """Yield the fields that differ from their ``equals``, the value by which a master identifies the encoder."""
    for field in register.layout.fields:
        expected = field.documented(variant.parameters)
        value = decoded.values.get(field.name)
        # Only like types compare: numbers with numbers, texts with texts. For a field without 'equals', this is None.
        if type(expected) is type(value) and value != expected:
            yield ("bytes",), f"'{field.name}' is {value}, but 'equals' is {expected} for {variant.code}"


def _check_frame(device: Device, example: FrameExample) -> Iterator[Wrong]:
    """Yield the first kind of error: the sender, the reason to refuse the frame, its layout, or its values."""
    sender = device.layout(example.layout).sender if example.layout else example.sender
    if sender != example.sender:
        yield ("from",), f"'{example.layout}' is sent by the {sender}; write 'from: {sender}'"
        return
    decoded = decode_example(device, example, example_variant(device, example))
    if example.refused:
        reported_kinds = sorted({problem.fault.value for problem in decoded.problems})
        if example.refused not in reported_kinds:
            expected = f"it should be refused because of its {example.refused}"
            yield ("refused",), f"{expected}, but the decoder reports {', '.join(reported_kinds) or 'no error'}"
        return
    decoded_layout = decoded.layout.name if decoded.layout is not None else example.layout
    if example.layout and decoded_layout != example.layout and not decoded.problems:
        yield ("layout",), f"it is a {decoded_layout}, not a {example.layout}"
    else:
        yield from _check_decoded(device, decoded, example)


def _check_decoded(device: Device, decoded: DecodedFrame, example: FrameExample | RegisterExample) -> Iterator[Wrong]:
    """Yield errors of the decoder, otherwise differences from printed values, otherwise from re-encoded values."""
    problems = decoded.problems
    # Errors after a wrong length or CRC may only follow from it.
    if problems and problems[0].fault in (Fault.LENGTH, Fault.CRC):
        problems = problems[:1]
    if problems:
        has_crc_error = decoded.crc is not None and not decoded.crc.ok
        hint = _suggest_start(device, decoded.crc.name) if decoded.crc is not None and has_crc_error else ""
        for problem in problems:
            yield _data_path(example), problem.message + hint
        return
    differences = list(_compare_values(decoded, example))
    yield from differences or _check_encoding(device, decoded, example)


def _suggest_start(device: Device, crc_name: str) -> str:
    """Return the text about a better start value, such as ``; with 'init: 0xff' in the CRC 'crc', it matches``.

    It is empty unless all examples of the CRC need the same start value, and the spec has another start value. A single
    example always fits some start value, so with one example only all bits 0 and all bits 1 are suggested.
    """
    crc = device.crc(crc_name)
    start_values: list[int] = []
    for example in device.examples:
        start_values += _needed_start_values(device, crc, example)
    if len(set(start_values)) != 1 or start_values[0] == crc.init:
        return ""
    has_one_example = len(start_values) == 1
    if has_one_example and start_values[0] not in (0, crc.mask):
        return ""
    subject = "it" if has_one_example else "every example"
    return f"; with 'init: {start_values[0]:#x}' in the CRC '{crc_name}', {subject} matches"


def _needed_start_values(device: Device, crc: Crc, example: Example) -> Iterator[int]:
    """Yield the start value that the CRC needs for an example, or nothing if the example lacks the CRC."""
    if crc.poly & 1 == 0:  # Without the last bit of the polynomial, a CRC does not determine its start value.
        return
    if isinstance(example, CrcExample) and example.crc == crc.name:
        yield init_for_result(crc, *bits_in_crc_order(crc, example.bytes), example.check)
    elif isinstance(example, FrameExample) and not example.refused:
        if example.layout and example.layout not in {layout.name for _, layout in device.layouts()}:
            return  # The layout has an error.
        try:
            variant = example_variant(device, example)
        except UnknownOrderCode:  # Reported for that example.
            return
        decoded = decode_example(device, example, variant)
        if decoded.layout is not None and decoded.crc is not None and decoded.crc.name == crc.name:
            yield init_for_result(crc, *covered_bits(crc, decoded.layout, decoded.number), decoded.crc.received)


def _data_path(example: Example) -> Path:
    """Return the path of the key that holds the data of an example."""
    if isinstance(example, ProcedureExample):
        return ("arguments",)
    if isinstance(example, FrameExample) and example.bits:
        return ("bits",)
    return ("bytes",)


def decode_example(device: Device, example: FrameExample, variant: Variant) -> DecodedFrame:
    """Decode the frame of an example with the layout that its bytes select, or else with the example's layout."""
    if example.bits:
        placed = device.layout(example.layout).place(variant.parameters)
        return decode_bits(device, placed, int(example.bits, 2), len(example.bits))
    # A field in the bytes identifies the layout.
    if not example.layout or example.layout in _selected_layouts(device, example.sender):
        return decode_bytes(device, variant, example.sender, example.bytes)
    return decode_placed(device, device.layout(example.layout).place(variant.parameters), example.bytes)


def _selected_layouts(device: Device, sender: str) -> set[str]:
    """Return the layouts that the decoder can select by the bytes: all of a sender on interfaces with a selector."""
    layout_names: set[str] = set()
    for interface in device.interfaces:
        if any(layout.selector for layout in interface.layouts):
            layout_names |= {layout.name for layout in interface.layouts if layout.sender == sender}
    return layout_names


def _compare_values(decoded: DecodedFrame, example: FrameExample | RegisterExample) -> Iterator[Wrong]:
    """Yield each printed value that the decoded frame lacks or contradicts."""
    decoded_values = decoded.values
    for name, value in example.values.items():
        if name not in decoded_values:
            yield ("values", name), f"there is no field '{name}'"
        elif decoded_values[name] != value:
            yield ("values", name), f"{name} is {decoded_values[name]}, not {value}"


def _check_encoding(device: Device, decoded: DecodedFrame, example: FrameExample | RegisterExample) -> Iterator[Wrong]:
    """Yield an error if encoding the decoded values again gives other bits. Unspecified bits may be any."""
    if decoded.layout is None:
        return
    layout = decoded.layout.layout
    # Joins, runs of digits and fields without data follow from the other fields, so they are not encoded.
    derived_names = {join.name for join in layout.joins}
    for field in layout.fields:
        derived_names.update(run.name for run in field.runs)
        if not field.carries_data:
            derived_names.add(field.name)
    values_to_encode = {name: value for name, value in decoded.values.items() if name not in derived_names}
    encoded = encode(device, decoded.layout, values_to_encode)
    if layout.gaps == "unspecified":
        # An encoder may return anything in these bits, and a write keeps them.
        described_bits = 0
        for placed_field in decoded.layout.fields:
            described_bits |= ((1 << placed_field.width) - 1) << placed_field.low
        encoded |= decoded.number & ~described_bits
    if encoded != decoded.number:
        yield _data_path(example), f"encoding its fields again gives {encoded:#x}, not {decoded.number:#x}"
