"""The context in which layouts are built, and the parts of a field that do not depend on its place.

A single field can have a byte order of its own, such as a CRC that is sent low byte first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from ..language.problems import DocumentReport, Path
from ..language.rules.shapes import RESERVED
from ..model import (
    INTERFACES,
    BitSlice,
    Choice,
    Combination,
    Constant,
    Crc,
    CrcValue,
    DataId,
    Decimal,
    Digits,
    Field,
    Flag,
    Kind,
    Layout,
    Number,
    Parity,
    Sources,
    Text,
    Unused,
    Value,
    Verdict,
)
from ..model.expressions import Expression, ExpressionError
from ..model.record import dataclass
from .spec_parts import Raw, build_part


@dataclass(frozen=True)
class LayoutContext:
    """Definitions in a spec that a layout may refer to."""

    report: DocumentReport
    #: Each group of fields with its path in the spec, by name.
    group_and_path_by_name: Mapping[str, tuple[Raw, Path]]
    #: Expressions of the parameters that are calculated from others.
    definitions: Mapping[str, Expression]
    #: Parameters of the order codes of each interface. Equal sets of parameters are listed once.
    parameter_sets_by_interface: Mapping[str, Sequence[Mapping[str, int]]]
    crc_by_name: Mapping[str, Crc]
    #: Data IDs of each interface.
    data_ids_by_interface: Mapping[str, tuple[DataId, ...]]
    #: For the order codes in ``only``, returns the name of a parameter that is 0 for all other order codes.
    only_while: Callable[[str], str] = lambda only: ""

    def expression(self, text: int | str) -> Expression | None:
        """Return an expression over parameters that order codes set.

        Return None if the text is not a valid expression, or contains an unknown parameter.
        """
        try:
            expression = Expression.parse(text).substitute(self.definitions)
        except ExpressionError:
            return None  # The rules on references and expressions report it.
        has_unknown_parameter = not self._known_parameters().issuperset(expression.parameters)
        return None if has_unknown_parameter else expression

    def _known_parameters(self) -> frozenset[str]:
        """Return the names of all parameters. They are the same for all order codes."""
        for parameter_sets in self.parameter_sets_by_interface.values():
            for parameters in parameter_sets:
                return frozenset(parameters)
        return frozenset()

    def expressions(self, raw_part: Raw, keys: Iterable[str]) -> dict[str, Expression | None]:
        """Return the expressions under these keys of a part of the spec. Missing and invalid ones are None."""
        expressions: dict[str, Expression | None] = {}
        for key in keys:
            expressions[key] = self.expression(raw_part[key]) if key in raw_part else None
        return expressions


def _verdict_while_active(raw_field: Raw, interface: str) -> Verdict | None:
    """Return the verdict on the position while a flag is active, or None if the flag does not affect the position.

    The spec gives the verdict in ``makes_position``. Otherwise, the interface may define a verdict for flags with this
    name, such as BiSS for ``error``.
    """
    verdict_of_interface = INTERFACES[interface].flags.get(raw_field["name"], "")
    verdict_text = raw_field.get("makes_position", "") or verdict_of_interface
    return Verdict(verdict_text) if verdict_text else None


@dataclass(frozen=True)
class SpecPlace:
    """The place of a layout in the spec, where its problems are reported.

    The layout must be valid for all order codes of its interface.
    """

    path: Path
    context: LayoutContext
    interface: str

    @property
    def is_in_register(self) -> bool:
        """True for the layout of a register, False for a frame."""
        return self.path[0] == "registers"

    @property
    def parameter_sets(self) -> Sequence[Mapping[str, int]]:
        """Parameters of the interface's order codes. Equal sets of parameters are listed once."""
        return self.context.parameter_sets_by_interface.get(self.interface, ())

    def widest(self, width: Expression) -> int:
        """Return the largest value of a width over all order codes.

        Without order codes, this is the constant part of the expression.
        """
        widths = [width.value(parameters) for parameters in self.parameter_sets]
        return max(widths, default=width.constant)

    def report(self, rule: str, message: str, *path_in_layout: str | int) -> None:
        """Report a problem of the layout, or of the part at this path in it, such as ``"fields", "position"``."""
        self.context.report.add(rule, (*self.path, *path_in_layout), message)


def bit_range(bits_text: int | str) -> tuple[int, int] | None:
    """Return the highest and the lowest bit of a range: (7, 6) for ``7:6``, and (5, 5) for ``5``.

    Return None for any other text and for a reversed range.
    """
    high_text, _, low_text = str(bits_text).partition(":")
    highest_bit = _bit_number(high_text)
    lowest_bit = _bit_number(low_text) if low_text else highest_bit
    if highest_bit is None or lowest_bit is None or highest_bit < lowest_bit:
        return None
    return highest_bit, lowest_bit


def _bit_number(text: str) -> int | None:
    """Return the number of a bit, or None if the text is not a number.

    A number with more than four digits is a typo, and would lead to a huge field.
    """
    return int(text) if text.isdecimal() and len(text) <= 4 else None


def expected_value(raw_field: Raw, context: LayoutContext) -> Expression | int | str | None:
    """Return the documented value of a field, its key ``equals``: a text, a number or an expression.

    Return None if the field has no documented value, or if the expression is not valid.
    """
    expected = raw_field.get("equals")
    # In a text field, the value is the text itself. In any other field, a string is an expression such as bits + 8.
    if isinstance(expected, str) and "text" not in raw_field:
        return context.expression(expected)
    return expected if isinstance(expected, (int, str)) else None


def build_zero_field(
    *, name: str, constant: Constant, low: Expression, width: Expression, spec_place: SpecPlace, source: Sources
) -> Field:
    """Return a field whose bits are always 0, such as padding or a gap. ``constant`` is its kind."""
    return Field(
        name=name,
        kind=constant,
        low=low,
        width=width,
        widest=spec_place.widest(width),
        meaning="Always zero",
        source=source,
    )


def build_kind(raw_field: Raw, context: LayoutContext, interface: str, width: Expression) -> Kind:
    """Return the kind of a field, such as a flag or a CRC, which its keys determine. By default, it is a number."""
    if "constant" in raw_field:
        return Constant(raw_field["constant"])
    if "unused" in raw_field:
        verdict = Verdict(raw_field.get("makes_position", "usable_with_warning"))
        return Unused(raw_field["unused"], verdict)
    if "active" in raw_field:
        return _build_flag(raw_field, context, interface)
    if "values" in raw_field:
        return Choice(_named_values(raw_field, width))
    if "values_of" in raw_field:
        data_ids_of_interface = context.data_ids_by_interface.get(interface, ())
        return Choice(tuple(map(_value_of_data_id, data_ids_of_interface)))
    if "crc" in raw_field:
        covered_fields = tuple(raw_field.get("crc_of", ()))
        return CrcValue(raw_field["crc"], covered_fields)
    if "parity_of" in raw_field:
        return _build_parity(raw_field)
    if "digits" in raw_field:
        return Decimal(_digit_runs(raw_field["digits"]))
    if "text" in raw_field:
        return Text()
    return build_part(Number, raw_field)


def _build_parity(raw_field: Raw) -> Parity:
    """Return the kind of a parity bit. One covered field is a text in the spec, several are a list."""
    covered_fields = raw_field["parity_of"]
    covered_names = (covered_fields,) if isinstance(covered_fields, str) else tuple(covered_fields)
    return Parity(of=covered_names, odd=raw_field.get("parity") == "odd", over=raw_field.get("over", ""))


def _named_values(raw_field: Raw, width: Expression) -> tuple[Value, ...]:
    """Return the named values of a field. If the field has the key ``others``, all remaining values get names too."""
    values = build_values(raw_field)
    if "others" in raw_field:
        values += _name_reserved_numbers(values, width.constant)
    return values


def _build_flag(raw_field: Raw, context: LayoutContext, interface: str) -> Flag:
    """Return a flag from its definition in a spec.

    ``makes_position_if`` maps a parameter to the verdict on the position that applies if the parameter is 1:
    ``{encoder_follows_edition_2: not_usable}``. If the flag is only for some order codes, ``only_while`` of the result
    is a parameter that is 0 for all others.
    """
    deciding_parameter = ""
    verdict_if_set = None
    # The map has at most one entry.
    for parameter_name, verdict_text in raw_field.get("makes_position_if", {}).items():
        deciding_parameter = parameter_name
        verdict_if_set = Verdict(verdict_text)
    return build_part(
        Flag,
        raw_field,
        verdict_parameter=deciding_parameter,
        verdict_if_set=verdict_if_set,
        active_low=raw_field["active"] == "low",
        makes_position=_verdict_while_active(raw_field, interface),
        only_while=context.only_while(raw_field["only"]) if "only" in raw_field else "",
    )


def build_values(raw_field: Raw) -> tuple[Value, ...]:
    """Return the named values of a field, in the order of the spec."""
    values = raw_field.get("values", {}).items()
    return tuple(build_part(Value, value, name=name, makes_position=_verdict_of_value(value)) for name, value in values)


def _verdict_of_value(raw_value: Raw) -> Verdict | None:
    """Return the verdict on the position for a named value of a field, or None if the value does not affect it."""
    return Verdict(raw_value["makes_position"]) if "makes_position" in raw_value else None


def build_combinations(raw_layout: Raw) -> tuple[Combination, ...]:
    """Return the combinations of field values that have a verdict of their own, in the order of the spec."""
    return tuple(map(_build_combination, raw_layout.get("combinations", ())))


def _build_combination(raw_combination: Raw) -> Combination:
    """Return a combination of field values with a verdict. Each condition is a text such as ``warning.active``."""
    conditions = tuple(f"{name}.{value}" for name, value in raw_combination["when"].items())
    return build_part(
        Combination, raw_combination, when=conditions, makes_position=Verdict(raw_combination["makes_position"])
    )


def _name_reserved_numbers(named_values: Sequence[Value], width: int) -> tuple[Value, ...]:
    """Return a named value, such as ``reserved_3``, for each number of ``width`` bits without a named value."""
    meaning = "Reserved: the manual does not say what it means"
    listed_numbers = {named_value.value for named_value in named_values}
    reserved_values: list[Value] = []
    for number in range(1 << width):
        if number not in listed_numbers:
            reserved_name = f"{RESERVED}_{number}"
            reserved_values.append(
                Value(name=reserved_name, value=number, printed_name="", names={}, meaning=meaning, source=())
            )
    return tuple(reserved_values)


def _value_of_data_id(data_id: DataId) -> Value:
    """Return a data ID as a named value of the field that holds it."""
    return Value(
        name=data_id.name,
        value=data_id.id,
        printed_name=f"Data ID {data_id.id:X}",
        names={},
        meaning=data_id.meaning,
        source=data_id.source,
    )


def _digit_runs(raw_runs: Sequence[Raw]) -> tuple[Digits, ...]:
    """Return the runs of digits in a decimal number, most significant first.

    A run is isolated by dividing by its divisor, and taking the result modulo its modulus. For runs of three and two
    digits, the divisors are 100 and 1, and the moduli are 1000 and 100.
    """
    lowest_first = []
    divisor = 1
    # The divisor of a run depends on the digits after it, so the least significant run comes first.
    for raw_run in reversed(raw_runs):
        modulus = 10 ** raw_run["digits"]
        lowest_first.append(build_part(Digits, raw_run, divisor=divisor, modulus=modulus))
        divisor *= modulus
    return tuple(reversed(lowest_first))


def bit_slices_of(field: Field, byte_count: int, low_byte_first: bool) -> tuple[BitSlice, ...]:
    """Return the bits of a field in each byte of a frame of ``byte_count`` bytes, beginning with its lowest bits.

    In a frame of 3 bytes, 10 bits from bit 4 are 4 bits in the last byte, from its bit 4, and 6 bits in the byte before
    it. With ``low_byte_first``, byte 0 contains the lowest bits of the frame, and otherwise the last byte. A field with
    a byte order of its own has its bytes in reverse order. The result is empty if the place or width of the field
    depends on the order code.
    """
    width = field.width.constant if field.width.is_constant else 0
    # A padded field occupies its container: the bits of the field and zeros above them.
    bits_with_padding = field.container or width
    if not field.low.is_constant or not bits_with_padding:
        return ()
    bit_slices = []
    sliced_bits = 0  # The lowest bits of the field, which earlier slices contain.
    while sliced_bits < bits_with_padding:
        # This byte index counts from the byte with the lowest bits of the frame.
        index_from_lowest, low_bit_in_byte = divmod(field.low.constant + sliced_bits, 8)
        remaining_bits = bits_with_padding - sliced_bits
        bits_in_byte = min(8 - low_bit_in_byte, remaining_bits)
        byte_index = index_from_lowest if low_byte_first else byte_count - 1 - index_from_lowest
        mask = (1 << bits_in_byte) - 1
        bit_slices.append(BitSlice(byte=byte_index, low_in_byte=low_bit_in_byte, mask=mask, low_in_number=sliced_bits))
        sliced_bits += bits_in_byte
    if field.byte_order:
        reversed_bytes = [bit_slice.byte for bit_slice in reversed(bit_slices)]
        slices_with_bytes = zip(bit_slices, reversed_bytes, strict=True)
        return tuple(replace(bit_slice, byte=byte_index) for bit_slice, byte_index in slices_with_bytes)
    return tuple(bit_slices)


def resolve_parity_bits(raw_layout: Raw, fields: Sequence[Field], spec_place: SpecPlace) -> list[Field]:
    """Return the fields of a layout, with parity bits that cover individual fields.

    In the spec, a parity bit can also cover a joined number, which consists of several fields, and constants.
    """
    fields_by_join = {name: tuple(members) for name, members in raw_layout.get("join", {}).items()}
    constant_by_name = {field.name: field.kind.value for field in fields if isinstance(field.kind, Constant)}
    return [_resolve_parity(field, fields_by_join, constant_by_name, spec_place) for field in fields]


def _resolve_parity(
    field: Field,
    fields_by_join: Mapping[str, tuple[str, ...]],
    constant_by_name: Mapping[str, int],
    spec_place: SpecPlace,
) -> Field:
    """Return a parity bit that covers individual fields with data. Any other field is returned unchanged.

    A joined number that the parity bit covers is replaced by its fields. Covered constants are left out, and an odd
    number of ones in them inverts the parity of the remaining fields. If only constants are covered, the parity bit is
    itself a constant. A single covered field is kept even if it is constant.
    """
    parity = field.kind
    if not isinstance(parity, Parity):
        return field
    covered_names: list[str] = []
    for name in parity.of:
        if parity.over and name in fields_by_join:
            message = f"'over' counts the bits of each field from 0, and '{name}' has several fields; list its fields"
            spec_place.report("parity-of", message, "fields", field.name, "parity_of")
        covered_names += fields_by_join.get(name, (name,))
    constant_names = [name for name in covered_names if name in constant_by_name]
    if len(covered_names) == 1:
        constant_names = []
    data_names = [name for name in covered_names if name not in constant_names]
    # The bits of each covered constant that count.
    counted_bits = [constant_by_name[name] & parity.mask for name in constant_names]
    ones_in_constants = sum(bits.bit_count() for bits in counted_bits)
    has_odd_constants = ones_in_constants % 2 == 1
    is_odd = parity.odd != has_odd_constants
    if not data_names:
        return replace(field, kind=Constant(int(is_odd)))
    resolved_parity = replace(
        parity, of=tuple(data_names), odd=is_odd, constants=tuple(constant_names), turned=has_odd_constants
    )
    return replace(field, kind=resolved_parity)


def without_needless_byte_orders(fields: Sequence[Field], byte_order: str) -> list[Field]:
    """Return the fields of a layout. The key ``byte_order`` of a field is removed if the layout has the same order."""
    return [replace(field, byte_order="") if field.byte_order == byte_order else field for field in fields]


def check_byte_orders(layout: Layout, spec_place: SpecPlace) -> None:
    """Report a field with a byte order of its own that does not consist of whole bytes in a frame of bytes."""
    for field in layout.fields:
        if field.byte_order:
            problem = _problem_of_byte_order(layout, field, spec_place)
            if problem:
                spec_place.report("byte-order", problem, "fields", field.name, "byte_order")


def _problem_of_byte_order(layout: Layout, field: Field, spec_place: SpecPlace) -> str:
    """Return why a field cannot have a byte order that differs from that of its layout, with a fix, or ""."""
    quoted_name = f"'{field.name}'"
    if spec_place.is_in_register:
        return f"{quoted_name} is in a register, whose 'byte_order' applies to all fields; remove 'byte_order' here"
    if INTERFACES[spec_place.interface].carried_as == "bits":
        title = INTERFACES[spec_place.interface].title
        return f"{quoted_name} is sent over {title}, as bits; describe each byte as a field, and 'join' them"
    if field.name == layout.selector:
        return f"{quoted_name} distinguishes frames, so its bytes have the order of the layout; remove 'byte_order'"
    if not field.is_fixed:
        problem = f"the place or width of {quoted_name} depends on the order code"
        return f"{problem}; remove 'byte_order', or write constant widths"
    if field.container:
        return f"{quoted_name} has 'padded_to'; write its bits with the padding as 'bits', and remove 'padded_to'"
    bit_count, lowest_bit = field.width.constant, field.low.constant
    if bit_count % 8 or lowest_bit % 8 or bit_count < 16:
        return f"{quoted_name} does not fill two or more whole bytes, so it has no byte order; remove 'byte_order'"
    return ""
