"""Build the worked examples, and compare them with the model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple, get_args

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
from ..reference.bits_and_values import bits_in_crc_order, compute_bytes, covered_bits, init_for_result
from ..reference.codec import EncodeError, decode, decode_bits, decode_bytes, decode_placed, encode
from ..reference.findings import DecodedFrame
from ..reference.registers import register_writes
from .spec_parts import Raw, build_part, valid_parts_so_far


class ExampleError(NamedTuple):
    """An error in an example: the path of the wrong key in it, such as ``("values", "position")``, and the message."""

    path: Path
    message: str


#: The class of each kind of example, by the word for the kind in specs.
_EXAMPLES: Mapping[str, Callable[..., Example]] = {kind.kind: kind for kind in get_args(Example)}


def build_examples(raw_spec: Raw) -> tuple[Example, ...]:
    """Return the worked examples of a spec."""
    return tuple(map(_build_example, raw_spec.get("examples", ())))


def _build_example(raw_example: Raw) -> Example:
    """Return one worked example. The encoder is its sender unless the key ``from`` names another one."""
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
        if not valid_parts.is_example_valid(example) or not _is_built(device, example):
            continue
        for error in _errors_of_example(device, example):
            message = f"example '{example.name}' does not match: {error.message}"
            error_path = ("examples", example.name, *error.path)
            # A CRC with a wrong start value contradicts all its examples, which is one problem.
            report.add("example-contradicts", error_path, message, cause=_name_of_wrong_crc(device, example))


def _name_of_wrong_crc(device: Device, example: Example) -> str:
    """Return the name of the CRC that an example contradicts. Empty if it contradicts something else."""
    if isinstance(example, CrcExample):
        return example.crc
    if not isinstance(example, FrameExample):
        return ""
    try:
        crc = decode_example(device, example, example_variant(device, example)).crc
    except (UnknownOrderCode, EncodeError):
        return ""
    return crc.name if crc is not None and not crc.ok else ""


def _is_built(device: Device, example: Example) -> bool:
    """Return whether all parts of the device that an example needs were built.

    These are the parts that it names, and all interfaces. Parts with problems are reported, but not built.
    """
    register_names = {register.name for register in device.registers}
    layout_names = {layout.name for _, layout in device.layouts()}
    match example:
        case FrameExample():
            are_named_parts_built = example.layout in {"", *layout_names}
        case RegisterExample():
            are_named_parts_built = example.register in register_names
        case ProcedureExample():
            procedures = [procedure for procedure in device.procedures if procedure.name == example.procedure]
            are_named_parts_built = any(procedure.registers <= register_names for procedure in procedures)
        case CrcExample() | MeasureExample():
            are_named_parts_built = True
        case _:
            assert_never(example)
    # Without order codes, only the example of a CRC can be computed.
    if not device.variants and not isinstance(example, CrcExample):
        return False
    built_interfaces = {interface.name for interface in device.interfaces}
    return are_named_parts_built and all(variant.interface in built_interfaces for variant in device.variants)


def _errors_of_example(device: Device, example: Example) -> list[ExampleError]:
    """Return the errors in an example. An unknown order code or an impossible value is reported as the only error."""
    try:
        return list(_yield_errors(device, example))
    except UnknownOrderCode as reason:
        return [ExampleError(("order_code",), str(reason))]
    except EncodeError as reason:
        return [ExampleError(_data_path(example), str(reason))]


def example_variant(device: Device, example: Example) -> Variant:
    """Return the order code of an example, or the first order code of the device if the example has none.

    An example of a frame can also answer questions that the manual leaves open. The answers set parameters of the order
    code.

    Raises:
        UnknownOrderCode: The family has no such order code.
    """
    if isinstance(example, CrcExample) or not example.order_code:
        return device.variants[0]
    listed_variants = [variant for variant in device.variants if variant.code == example.order_code]
    if listed_variants:
        variant = listed_variants[0]
    else:
        # The example may spell the order code differently, as on a label.
        variant = find_code(device, example.order_code).variant
    if isinstance(example, FrameExample):
        return with_answers(device, variant, example.alternatives)
    return variant


def _yield_errors(device: Device, example: Example) -> Iterator[ExampleError]:
    """Yield the differences between an example from the manual and the results that the model computes."""
    match example:
        case FrameExample():
            yield from _check_frame(device, example)
        case RegisterExample():
            yield from _check_register(device, example)
        case CrcExample():
            computed_crc = compute_bytes(device.crc(example.crc), example.bytes)
            if computed_crc != example.check:
                suggestion = _suggest_start(device, example.crc)
                yield ExampleError(("check",), f"the CRC over these bytes is {computed_crc:#04x}{suggestion}")
        case ProcedureExample():
            yield from _check_procedure(device, example)
        case MeasureExample():
            yield from _check_measure(device, example)
        case _:
            assert_never(example)


def _check_procedure(device: Device, example: ProcedureExample) -> Iterator[ExampleError]:
    """Yield an error if a procedure with the arguments of the example does not write the printed register values."""
    procedure = device.procedure(example.procedure)
    variant = example_variant(device, example)
    computed_writes = register_writes(device, procedure, variant, example.arguments)
    if computed_writes != example.writes:
        writes_text = ", ".join(f"{write.address:02X}h = {write.value:02X}h" for write in computed_writes)
        yield ExampleError(("writes",), f"the writes are {writes_text}")


def _check_measure(device: Device, example: MeasureExample) -> Iterator[ExampleError]:
    """Yield an error if the counts of the example, times the length of one count, differ from the printed length."""
    variant = example_variant(device, example)
    measurement = device.measurement_of(variant.interface)
    if measurement is None or measurement.step_um is None:
        yield ExampleError((), "the device does not measure a length in micrometers")
        return
    micrometers = measurement.step_um.value(variant.parameters) * example.counts
    if micrometers != example.micrometres:
        yield ExampleError(("micrometres",), f"{example.counts} counts are {micrometers} micrometers")


def _check_register(device: Device, example: RegisterExample) -> Iterator[ExampleError]:
    """Yield the errors in an example of a register's bytes.

    The length is checked first, then the decoded values, and then the values that identify the encoder. Only the errors
    of the first check that fails are yielded.
    """
    register = device.register(example.register)
    variant = example_variant(device, example)
    if len(example.bytes) != register.length:
        message = f"register '{register.name}' has {register.length} bytes, but the example has {len(example.bytes)}"
        yield ExampleError(("bytes",), message)
        return
    register_number = number_from_bytes(register.layout, example.bytes)
    decoded = decode(device, register.layout.place(variant.parameters), register_number)
    differences = list(_check_decoded(device, decoded, example))
    yield from differences or _check_identity(register, decoded, variant)


def _check_identity(register: Register, decoded: DecodedFrame, variant: Variant) -> Iterator[ExampleError]:
    """Yield an error for each field of a register whose decoded value differs from its documented value ``equals``.

    A master identifies the encoder by these values.
    """
    for field in register.layout.fields:
        documented_value = field.documented(variant.parameters)
        decoded_value = decoded.values.get(field.name)
        # Only values of the same type are compared. Without 'equals', the documented value is None.
        has_same_type = type(documented_value) is type(decoded_value)
        if has_same_type and decoded_value != documented_value:
            yield ExampleError(
                ("bytes",), f"'{field.name}' is {decoded_value}, but 'equals' is {documented_value} for {variant.code}"
            )


def _check_frame(device: Device, example: FrameExample) -> Iterator[ExampleError]:
    """Yield the errors in an example of a frame, of the first kind that occurs.

    The kinds are: the wrong sender, a frame that should be rejected but is not, a different layout, different values.
    """
    sender = device.layout(example.layout).sender if example.layout else example.sender
    if sender != example.sender:
        yield ExampleError(("from",), f"'{example.layout}' is sent by the {sender}; write 'from: {sender}'")
        return
    decoded = decode_example(device, example, example_variant(device, example))
    if example.refused:
        reported_faults = sorted({problem.fault.value for problem in decoded.problems})
        if example.refused not in reported_faults:
            expectation = f"it should be rejected because of its {example.refused}"
            yield ExampleError(
                ("refused",), f"{expectation}, but the decoder reports {', '.join(reported_faults) or 'no error'}"
            )
        return
    decoded_layout = decoded.layout.name if decoded.layout is not None else example.layout
    if example.layout and decoded_layout != example.layout and not decoded.problems:
        yield ExampleError(("layout",), f"it is a {decoded_layout}, not a {example.layout}")
    else:
        yield from _check_decoded(device, decoded, example)


def _check_decoded(
    device: Device, decoded: DecodedFrame, example: FrameExample | RegisterExample
) -> Iterator[ExampleError]:
    """Yield the errors in an example whose bytes were decoded.

    These are the problems that the decoder reports. If there are none, they are the differences from the printed
    values, and if there are none either, a difference between the printed bytes and the values encoded again.
    """
    problems = decoded.problems
    # A wrong length or CRC can cause further problems, which are not reported.
    if problems and problems[0].fault in (Fault.LENGTH, Fault.CRC):
        problems = problems[:1]
    if problems:
        hint = ""
        if decoded.crc is not None and not decoded.crc.ok:
            hint = _suggest_byte_order(device, decoded) if decoded.crc.has_exchanged_bytes else ""
            hint = hint or _suggest_start(device, decoded.crc.name)
        for problem in problems:
            yield ExampleError(_data_path(example), problem.message + hint)
        return
    differences = list(_compare_values(decoded, example))
    yield from differences or _check_encoding(device, decoded, example)


def _suggest_byte_order(device: Device, decoded: DecodedFrame) -> str:
    """Return what to write at the CRC of a frame of bytes if its bytes are exchanged, or "" for other frames."""
    placed_crc_field = decoded.layout.crc_field if decoded.layout is not None else None
    if decoded.layout is None or placed_crc_field is None or placed_crc_field.field.byte_order:
        return ""
    layout = decoded.layout.layout
    interface = next(interface for interface, sent_layout in device.layouts() if sent_layout is layout)
    if interface.carried_as == "bits":  # Only bytes can be exchanged.
        return ""
    other_byte_order = "low_byte_first" if layout.byte_order == "high_byte_first" else "high_byte_first"
    return f"; write 'byte_order: {other_byte_order}' in the field '{placed_crc_field.name}'"


def _suggest_start(device: Device, crc_name: str) -> str:
    """Return a suggestion for the start value of a CRC, such as ``; with 'init: 0xff' in the CRC 'crc', it matches``.

    All examples of the CRC must need the same start value, and the spec must have a different one. Otherwise, the text
    is "". A single example always matches some start value, so it only leads to a suggestion if all bits of that value
    are 0 or all are 1.
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
    """Yield the start value with which a CRC matches an example, or nothing if the example does not contain the CRC."""
    # With a polynomial whose lowest coefficient is 1, each step of the CRC can be reversed.
    start_follows_from_result = crc.poly & 1 == 1
    if not start_follows_from_result:
        return
    if isinstance(example, CrcExample) and example.crc == crc.name:
        covered_number, bit_count = bits_in_crc_order(crc, example.bytes)
        yield init_for_result(crc, covered_number, bit_count, result=example.check)
    elif isinstance(example, FrameExample) and not example.refused:
        layout_names = {layout.name for _, layout in device.layouts()}
        if example.layout and example.layout not in layout_names:
            return  # The layout has an error, so it was not built.
        try:
            variant = example_variant(device, example)
        except UnknownOrderCode:  # This is reported when the example itself is checked.
            return
        decoded = decode_example(device, example, variant)
        if decoded.layout is not None and decoded.crc is not None and decoded.crc.name == crc.name:
            covered_number, bit_count = covered_bits(crc, decoded.layout, decoded.number)
            yield init_for_result(crc, covered_number, bit_count, result=decoded.crc.received)


def _data_path(example: Example) -> Path:
    """Return the path of the key that holds the data of an example."""
    if isinstance(example, ProcedureExample):
        return ("arguments",)
    if isinstance(example, FrameExample) and example.bits:
        return ("bits",)
    return ("bytes",)


def decode_example(device: Device, example: FrameExample, variant: Variant) -> DecodedFrame:
    """Decode the frame of an example, with the layout that its bytes select or with the layout that it names."""
    if example.bits:
        placed_layout = device.layout(example.layout).place(variant.parameters)
        number = int(example.bits, 2)
        return decode_bits(device, placed_layout, number, bits=len(example.bits))
    bytes_select_layout = not example.layout or example.layout in _selected_layouts(device, example.sender)
    if bytes_select_layout:
        return decode_bytes(device, variant, example.sender, example.bytes)
    placed_layout = device.layout(example.layout).place(variant.parameters)
    return decode_placed(device, placed_layout, example.bytes)


def _selected_layouts(device: Device, sender: str) -> set[str]:
    """Return the names of the sender's layouts that a decoder selects by the bytes of a frame.

    These are all layouts of the interfaces on which a field, the selector, identifies the layout.
    """
    layout_names: set[str] = set()
    for interface in device.interfaces:
        if any(layout.selector for layout in interface.layouts):
            layout_names |= {layout.name for layout in interface.layouts if layout.sender == sender}
    return layout_names


def _compare_values(decoded: DecodedFrame, example: FrameExample | RegisterExample) -> Iterator[ExampleError]:
    """Yield an error for each printed value that is not in the decoded frame, or differs there."""
    decoded_values = decoded.values
    for field_name, printed_value in example.values.items():
        if field_name not in decoded_values:
            yield ExampleError(("values", field_name), f"there is no field '{field_name}'")
        elif decoded_values[field_name] != printed_value:
            yield ExampleError(
                ("values", field_name), f"{field_name} is {decoded_values[field_name]}, not {printed_value}"
            )


def _check_encoding(
    device: Device, decoded: DecodedFrame, example: FrameExample | RegisterExample
) -> Iterator[ExampleError]:
    """Yield an error if the decoded values, encoded again, differ from the bits of the example.

    Bits that the manual does not specify may have any value.
    """
    if decoded.layout is None:
        return
    layout = decoded.layout.layout
    # Joined numbers, runs of digits and fields without data follow from other fields, so they are not encoded.
    derived_names = {join.name for join in layout.joins}
    for field in layout.fields:
        derived_names.update(run.name for run in field.runs)
        if not field.carries_data:
            derived_names.add(field.name)
    values_to_encode = {name: value for name, value in decoded.values.items() if name not in derived_names}
    encoded_number = encode(device, decoded.layout, values_to_encode)
    if layout.gaps == "unspecified":
        # An encoder may return any value in these bits, and a write keeps them.
        described_bits = 0
        for placed_field in decoded.layout.fields:
            field_mask = (1 << placed_field.width) - 1
            described_bits |= field_mask << placed_field.lowest_bit
        encoded_number |= decoded.number & ~described_bits
    if encoded_number != decoded.number:
        yield ExampleError(
            _data_path(example), f"encoding its fields again gives {encoded_number:#x}, not {decoded.number:#x}"
        )
