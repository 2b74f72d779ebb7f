"""Rules for combinations of keys, which a schema could only check with incomprehensible messages."""

from __future__ import annotations

from ...model import INTERFACES, Spi
from ...model.expressions import Expression, ExpressionError
from ..keys_of_fields import KIND_KEYS, NUMBER, WrittenField, WrittenLayout
from ..keys_of_specs import WrittenExample, WrittenSpec
from ..problems import DocumentReport, join_words, missing_keys_message, quoted
from ..written import WrittenPart
from .parts import (
    MAX_FIELDS,
    FieldList,
    FieldOwner,
    by_name,
    by_part_name,
    constant_width,
    field_lists,
    interface_name_of,
)

#: Keys that give the place of a field.
PLACES = ("at", "top_bit", "low_bit")
#: Begins the names of values that a manual reserves, such as ``reserved_5``.
RESERVED = "reserved"
#: Widest field with names for its reserved values, because each of these is in every output.
MOST_RESERVED_BITS = 4
_KEYS_OF_FLAGS = WrittenField.keys_owned_by("active")
_KEYS_OF_PARITIES = WrittenField.keys_owned_by("parity_of")
_KINDS_WITH_BYTE_ORDER = tuple(kind for kind in KIND_KEYS if "byte_order" in WrittenField.keys_owned_by(kind))
_KEYS_OF_NUMBERS = WrittenField.keys_owned_by(NUMBER, alone=True)
#: Keys that are not allowed next to ``scale``: the first changes the meaning of 0, the second states a separate unit.
_KEYS_EXCLUDED_BY_SCALE = ("zero_means", "unit")
#: Keys that are not allowed next to ``digit_code``, because they are about the bits as one binary number.
_KEYS_EXCLUDED_BY_DIGIT_CODE = ("signed", "zero_means", "power_of_two", "equals", "default")
#: Keys allowed next to ``use``.
_KEYS_ALLOWED_WITH_USE = frozenset(("use", "note", "source"))
#: Kinds with an implied width: a flag and a parity bit have one bit, a CRC its own width.
_KEYS_WITH_IMPLIED_WIDTH = ("active", "parity_of", "crc")


def check_layout_keys(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that the keys of fields and layouts can be combined.

    A field with ``use``, which only includes a group of fields, can have few other keys.
    """
    for field_list in field_lists(spec):
        for field in field_list.fields:
            if field.use:
                _check_inclusion_of_group(field_list, field, report)
            else:
                _check_keys_of_field(field, report)
                _check_unlisted_values(field_list, field, report)
        _check_positions_of_fields(field_list, report)
        if field_list.layout is not None:
            _check_keys_for_bits_or_bytes(field_list, field_list.layout, spec, report)


def _check_inclusion_of_group(field_list: FieldList, field: WrittenField, report: DocumentReport) -> None:
    """Check that a field that includes a group is in a layout or register, and has no keys of a field."""
    if field_list.owner_kind is FieldOwner.GROUP:
        message = "a field group cannot include another group; list the fields here"
        report.add("layout-keys", field.path_of("use"), message)
    elif field_list.owner_kind is FieldOwner.CONTROL:
        message = "the control data cannot include field groups; list the fields here"
        report.add("layout-keys", field.path_of("use"), message)
    keys_of_fields = [key for key in field.data if key not in _KEYS_ALLOWED_WITH_USE]
    if keys_of_fields:
        key = keys_of_fields[0]
        message = f"{quoted(key)} is not allowed with 'use'; it belongs to a field of the group"
        report.add("layout-keys", field.path_of(key), message, at_key=True)


def _check_keys_of_field(field: WrittenField, report: DocumentReport) -> None:
    """Check that a field has a name, and then its kind and its width."""
    if not field.name:
        report.add("layout-keys", field.path, "a field needs 'name', or 'use' to include a group")
        return
    _check_keys_of_kind(field, report)
    _check_width_and_position(field, report)


def _check_keys_of_kind(field: WrittenField, report: DocumentReport) -> None:
    """Check that a field has at most one of ``KIND_KEYS`` (none makes it a number), and only keys of that kind."""
    name = quoted(field.name)
    kind_keys = [key for key in KIND_KEYS if field.has(key)]
    if len(kind_keys) > 1:
        second_key = kind_keys[1]
        problem = f"{join_words(map(quoted, kind_keys))} exclude each other; keep one of them"
        report.add("layout-keys", field.path_of(second_key), problem, at_key=True)
    for key in _KEYS_OF_NUMBERS:
        if field.has(key) and kind_keys:
            problem = f"{quoted(key)} is only for numbers; {name} has {quoted(kind_keys[0])}, so it is not a number"
            report.add("layout-keys", field.path_of(key), problem, at_key=True)
    for key in _KEYS_EXCLUDED_BY_SCALE:
        if field.has(key) and field.scale is not None:
            problem = f"{quoted(key)} and 'scale' exclude each other; keep one of them"
            report.add("layout-keys", field.path_of(key), problem, at_key=True)
    for key in _KEYS_EXCLUDED_BY_DIGIT_CODE:
        if field.has(key) and field.digit_code:
            problem = f"{quoted(key)} and 'digit_code' exclude each other; keep one of them"
            report.add("layout-keys", field.path_of(key), problem, at_key=True)
    _check_flag_keys(field, report)
    _check_keys_of_checks(field, report)
    if field.byte_order and kind_keys and kind_keys[0] not in _KINDS_WITH_BYTE_ORDER:
        allowed_kinds = "numbers, named values, constants and CRCs"
        problem = f"'byte_order' is only for {allowed_kinds}; {name} has {quoted(kind_keys[0])}, so remove it"
        report.add("layout-keys", field.path_of("byte_order"), problem, at_key=True)
    _check_expected_value(field, kind_keys, report)


def _check_expected_value(field: WrittenField, kind_keys: list[str], report: DocumentReport) -> None:
    """Check that only numbers, texts and named values have ``equals``, the value expected on the device.

    For a field that contains text, the value must be text too. ``kind_keys`` are the keys of the field that make it
    something other than a number, such as ``crc``.
    """
    name = quoted(field.name)
    if field.equals is None:
        return
    if field.text and isinstance(field.equals, int):
        report.add("layout-keys", field.path_of("equals"), f"{name} is text; put the value in quotes")
    elif kind_keys and "equals" not in WrittenField.keys_owned_by(kind_keys[0]):
        problem = f"'equals' is only for numbers, text and named values; {name} has {quoted(kind_keys[0])}"
        report.add("layout-keys", field.path_of("equals"), problem, at_key=True)


def _check_keys_of_checks(field: WrittenField, report: DocumentReport) -> None:
    """Check that only a parity bit has ``parity`` and ``over``, and that only a CRC has ``crc_of``.

    ``over`` selects the bits that the parity bit covers, and ``crc_of`` the fields that the CRC covers.
    """
    name = quoted(field.name)
    for key in _KEYS_OF_PARITIES:
        if field.has(key) and not field.parity_of:
            remedy = f"to make {name} a parity bit, add 'parity_of' with the covered field"
            message = f"{quoted(key)} is only for parity bits; {remedy}"
            report.add("layout-keys", field.path_of(key), message, at_key=True)
    if field.crc_of and not field.crc:
        problem = f"'crc_of' is only for CRCs; to make {name} a CRC, add 'crc' with its name"
        report.add("layout-keys", field.path_of("crc_of"), problem, at_key=True)


def _check_flag_keys(field: WrittenField, report: DocumentReport) -> None:
    """Check that only a flag has keys of flags, such as ``when_active``.

    Unused bits may also have ``makes_position``, the verdict on the position.
    """
    if field.active:
        return
    name = quoted(field.name)
    for key in _KEYS_OF_FLAGS:
        is_verdict = key == "makes_position"
        if not field.has(key) or (is_verdict and field.unused is not None):
            continue
        if is_verdict and field.values:
            remedy = "write it at a value, as in too_weak: {value: 2, makes_position: usable_with_warning}"
            # The verdict of named values belongs to each value.
            problem = f"{name} has named values, and not each of them has the same effect on the position; {remedy}"
        else:
            problem = f"{quoted(key)} is only for flags; to make {name} a flag, add 'active: high' or 'active: low'"
        report.add("layout-keys", field.path_of(key), problem, at_key=True)


def _check_unlisted_values(field_list: FieldList, field: WrittenField, report: DocumentReport) -> None:
    """Check that a field with ``others`` can have it: the meaning of all values that are not listed."""
    obstacle = _obstacle_to_others(field_list, field) if field.others else ""
    if obstacle:
        report.add("layout-keys", field.path_of("others"), obstacle, at_key=True)


def _obstacle_to_others(field_list: FieldList, field: WrittenField) -> str:
    """Return the reason that a field cannot have ``others``, and the fix. Empty if it can.

    ``others`` gives each unlisted value a name such as ``reserved_5``. So the field needs listed values and a small
    constant width, no master may write it, and no other listed value may have such a name.
    """
    name = quoted(field.name)
    width = constant_width(field)
    if not field.values:
        return f"'others' names the values that 'values' does not list; {name} also needs 'values'"
    if width is None or width > MOST_RESERVED_BITS:
        return f"'others' gives every value a name, so 'bits' of {name} must be a number from 1 to {MOST_RESERVED_BITS}"
    if field_list.is_written_by_master:
        return f"{name} is written by a master, which does not write reserved values; remove 'others'"
    reserved_names = {f"{RESERVED}_{number}" for number in range(1 << MOST_RESERVED_BITS)}
    clashing_names = []
    for value_name, value in field.values.items():
        is_its_own_name = value_name == f"{RESERVED}_{value.value}"
        if value_name in reserved_names and not is_its_own_name:
            clashing_names.append(value_name)
    if clashing_names:
        return f"'others' gives the name {quoted(min(clashing_names))} to another value; rename this one"
    return ""


def _check_width_and_position(field: WrittenField, report: DocumentReport) -> None:
    """Check that a field has a width, and that its width and position are given once.

    The width is given by ``bits``, by a range in ``at``, or by the kind of field.
    """
    name = quoted(field.name)
    if field.bits is not None and _is_always_zero(field.bits):
        problem = f"{name} has no bits; a field needs at least one, unless its width depends on a parameter"
        report.add("layout-keys", field.path_of("bits"), problem)
    position_keys = [key for key in PLACES if field.has(key)]
    has_width = field.has("bits", "at", *_KEYS_WITH_IMPLIED_WIDTH)
    if len(position_keys) > 1:
        second_key = position_keys[1]
        quantity = "both" if len(position_keys) == 2 else "all"
        problem = f"{join_words(map(quoted, position_keys))} {quantity} give the position; keep one of them"
        report.add("layout-keys", field.path_of(second_key), problem, at_key=True)
    elif field.bits is not None and ":" in str(field.at):
        problem = f"the range {quoted(field.at)} already gives the width; remove 'bits'"
        report.add("layout-keys", field.path_of("bits"), problem, at_key=True)
    elif not has_width:
        message = f"{name} has no width; give it 'bits', or 'at' with a range such as 7:6"
        report.add("layout-keys", field.path, message)


def _is_always_zero(bits: int | str) -> bool:
    """Return True if a width is a number, without parameters, and not positive: ``0`` or ``4 - 4``."""
    try:
        width = Expression.parse(bits)
    except ExpressionError:  # Reported by the rule on expressions.
        return False
    return width.is_constant and width.constant <= 0


def _check_positions_of_fields(field_list: FieldList, report: DocumentReport) -> None:
    """Check that either all fields of a layout, register or group have a bit position, or none. Skip control data."""
    fields_with_position = [field for field in field_list.fields if field.has(*PLACES)]
    fields_without_position = [field for field in field_list.fields if not field.has(*PLACES)]
    is_consistent = not fields_with_position or not fields_without_position
    if is_consistent or field_list.owner_kind is FieldOwner.CONTROL:
        return
    field = fields_without_position[0]
    name = quoted(field.name or field.use)  # A field that includes a group has no name of its own.
    name_with_position = quoted(fields_with_position[0].name)
    message = (
        f"{name} has no position, but {name_with_position} has one; "
        "give a position ('at', 'top_bit' or 'low_bit') to all fields of a layout or to none"
    )
    report.add("layout-keys", field.path, message)


def _check_keys_for_bits_or_bytes(
    field_list: FieldList, layout: WrittenLayout, spec: WrittenSpec, report: DocumentReport
) -> None:
    """Check that a layout has only keys for the way in which it is sent: as bits or as bytes.

    Without ``carried_as``, it is sent as usual over its interface.
    """
    interface = INTERFACES[field_list.interface]
    carried_as = layout.carried_as or interface.carried_as
    name = quoted(layout.name)
    lacks_byte_order = not layout.byte_order and not _is_one_byte(layout, spec)
    if carried_as == "bytes" and lacks_byte_order:
        message = f"{name} is carried as bytes, so it needs 'byte_order': low_byte_first or high_byte_first"
        report.add("layout-keys", layout.path, message)
    if carried_as == "bits":
        obstacle = _obstacle_to_byte_order(field_list.interface, layout)
        if obstacle:
            report.add("layout-keys", layout.path_of("byte_order"), obstacle, at_key=True)
        if layout.when:
            problem = f"'when' only distinguishes frames of bytes, but {name} is carried as bits; remove 'when'"
            remedy = "" if field_list.interface == Spi.name else ", or write 'carried_as: bytes'"
            report.add("layout-keys", layout.path_of("when"), problem + remedy, at_key=True)
    if layout.channel is not None and not interface.has_channels:
        message = f"{name} cannot have a data channel; only BiSS has channels"
        report.add("layout-keys", layout.path_of("channel"), message, at_key=True)


def _obstacle_to_byte_order(interface: str, layout: WrittenLayout) -> str:
    """Return the reason that a layout that is sent as bits cannot have its ``byte_order``, and the fix.

    The result is empty if it has none, or if it is ``low_byte_first`` over SPI, which is the order of the bytes of a
    joined number.
    """
    name = quoted(layout.name)
    if not layout.byte_order:
        return ""
    if interface != Spi.name:
        return f"{name} is carried as bits, which have no byte order; remove 'byte_order'"
    if layout.byte_order == "high_byte_first":
        return f"{name} is sent over SPI, high byte first unless it says otherwise; remove 'byte_order'"
    if not layout.join:
        return f"{name} sends the low byte first, so describe each byte as a field, and 'join' them"
    return ""


def _is_one_byte(layout: WrittenLayout, spec: WrittenSpec) -> bool:
    """Return True if a layout is a single byte, so that it needs no byte order.

    It has either fields with bit positions up to bit 7, or a single field, group or CRC with 8 bits.
    """
    all_have_positions = all(field.at is not None or field.top_bit is not None for field in layout.fields)
    if all_have_positions:
        highest_bit = max(map(_top_bit, layout.fields), default=0)
        return highest_bit == 7
    if len(layout.fields) > 1:
        return False
    field = layout.fields[0]
    group = by_name(spec.with_invalid_parts.field_groups).get(field.use)
    crc = by_part_name(spec.with_invalid_parts.crcs).get(field.crc)
    if group is not None and group.bits:
        return group.bits == 8
    if crc is not None and crc.part.width:
        return crc.part.width == 8
    return (field.padded_to or constant_width(field)) == 8


def _top_bit(field: WrittenField) -> int:
    """Return the highest bit of a field with ``at`` or ``top_bit``, or 0 if it depends on the order code."""
    if field.top_bit is not None:
        bit_text = str(field.top_bit)
    else:
        bit_text, _, _ = str(field.at).partition(":")  # The highest bit of a range such as 7:6.
    # Another rule reports a number with more digits.
    is_bit_number = bit_text.isdecimal() and len(bit_text) <= 4
    return int(bit_text) if is_bit_number else 0


def check_missing_byte_orders(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that registers of several bytes with addresses have a byte order, because no default is safe."""
    for register in spec.registers:
        interface = INTERFACES.get(interface_name_of(register))
        # A register without addresses for its bytes is sent as one number.
        has_bytes = interface is None or interface.byte_addresses
        if has_bytes and register.length > 1 and not register.byte_order:
            message = (
                f"{quoted(register.name)} has {register.length} bytes, "
                "so it needs 'byte_order': low_byte_first or high_byte_first"
            )
            report.add("byte-order-missing", register.path, message)


def check_example_shape(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that each example has the keys of its kind, and that a frame is complete."""
    for example in spec.examples:
        subject = f"a {example.kind} example"
        check_keys(example, example.kind, rule="example-shape", subject=subject, report=report)
        if example.kind == "frame":
            _check_example_of_frame(example, report)


def _check_example_of_frame(example: WrittenExample, report: DocumentReport) -> None:
    """Check that an example of a frame has bits or bytes, its layout, and the expected result of decoding it.

    The result is ``values``, or ``refused`` with an explanation if decoders reject the frame. A rejected frame of bytes
    needs no layout.
    """
    has_bytes = bool(example.bytes)
    has_bits = bool(example.bits)
    is_refused = bool(example.refused)
    if has_bytes and has_bits:
        message = "a frame example needs 'bytes' or 'bits'; this one has both; keep one of them"
        report.add("example-shape", example.path, message)
    elif not has_bytes and not has_bits:
        report.add("example-shape", example.path, "a frame example needs 'bytes' or 'bits'; this one has neither")
    elif not example.layout and has_bits:
        report.add("example-shape", example.path, "'layout' is missing; a frame example needs it")
    elif not example.layout and not is_refused:
        message = "'layout' is missing; a frame example needs it, or 'refused' if it fits no layout"
        report.add("example-shape", example.path, message)
    if not is_refused and not example.has("values"):
        report.add("example-shape", example.path, "'values' is missing; a frame example needs it, or 'refused'")
    if is_refused and not example.erratum and not example.note:
        report.add("example-shape", example.path, "a refused example needs 'erratum' or 'note' to explain it")


def check_example_arguments(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that an example of a procedure has a value for each argument of the procedure."""
    procedure_by_name = by_name(spec.with_invalid_parts.procedures)
    for example in spec.examples:
        procedure = procedure_by_name.get(example.procedure)
        if example.kind != "procedure" or procedure is None:
            continue
        missing_arguments = [name for name in by_name(procedure.arguments) if name not in example.arguments]
        if missing_arguments:
            names_text = join_words(map(quoted, missing_arguments))
            verb = "is" if len(missing_arguments) == 1 else "are"
            problem = f"{names_text} {verb} missing from 'arguments' of the example"
            report.add("example-shape", example.path, problem)


def check_keys(step_or_example: WrittenPart, kind: str, *, rule: str, subject: str, report: DocumentReport) -> None:
    """Check that a step or example has the keys that its kind requires, and no keys of other kinds.

    Problems are reported under ``rule``. ``subject`` is the kind in messages, such as ``a wait step``.
    """
    needed_keys: list[str] = []
    excluded_keys: list[str] = []
    for described in step_or_example.described_keys:
        kinds_with_key = described.key.owners
        if kind in described.key.needed_by:
            needed_keys.append(described.name)
        if kinds_with_key and kind not in kinds_with_key:
            excluded_keys.append(described.name)
    missing_keys = [key for key in needed_keys if not step_or_example.has(key)]
    if missing_keys:
        report.add(rule, step_or_example.path, missing_keys_message(missing_keys, subject))
    for key in excluded_keys:
        if step_or_example.has(key):
            message = f"{quoted(key)} does not apply to {subject}"
            report.add(rule, step_or_example.path_of(key), message, at_key=True)


def check_field_count(spec: WrittenSpec, report: DocumentReport) -> None:
    """Check that no list of fields has more than ``MAX_FIELDS`` if the groups in it are written out."""
    field_count_by_group = {
        name: len(group.fields) for name, group in by_name(spec.with_invalid_parts.field_groups).items()
    }
    for field_list in field_lists(spec):
        field_count = sum(field_count_by_group.get(field.use, 1) for field in field_list.fields)
        if field_count > MAX_FIELDS:
            problem = f"'fields' has {field_count} entries with those of its groups; the limit is {MAX_FIELDS}"
            report.add("too-long", field_list.owner.path_of("fields"), problem)
