"""The decoder of a frame or register in Python: code for its checks and its values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from ...model import Digits, Field
from ...model.expressions import Expression
from ...model.record import assert_never
from ...plan.codec import LayoutPlan
from ...plan.operations import AlwaysIs, Check, FieldToDecode, FrameCrc, JoinedNumber, ParityIs, ZerosAbove
from ...plan.values import (
    ActiveFlag,
    DecimalDigits,
    Latin1Text,
    NamedChoice,
    TwosComplement,
    UnsignedNumber,
    ZeroMeans,
    meaning_of,
)
from .bits import BitReader
from .first_byte import FirstByte
from .literals import (
    Atom,
    ExpressionTranslator,
    PythonExpression,
    call,
    join_operands,
    mask,
    number,
    shift_left,
)
from .names import ClassNames
from .values import (
    NamedValues,
    comment_on_constant,
    digit_values,
    is_flag_active,
    prefer_names_of_fields,
    replace_zero,
    text_of_number,
)

#: Number of bits per CRC table.
TABLE_BITS = 16
#: Maximum length of a frame, in bytes, for which each byte gets a variable.
_MAX_BYTE_VARIABLES = 16


class Decoder:
    """The expressions in the decoder of a frame or register.

    ``enum_name_of`` returns the name of the IntEnum of a field. A frame gets one decoder for each encoder, which
    computes the values that depend on the order code only once. For this, its ``translator`` is a NamedValues.
    """

    def __init__(
        self,
        translator: ExpressionTranslator,
        layout_plan: LayoutPlan,
        class_names: ClassNames,
        enum_name_of: Callable[[Field], str],
    ) -> None:
        self.translator = translator
        self.layout_plan = layout_plan
        self.class_names = class_names
        self.enum_name_of = enum_name_of
        # Only the translator for a frame names values. A register has a plain one.
        is_short_frame = isinstance(translator, NamedValues) and 1 < layout_plan.length <= _MAX_BYTE_VARIABLES
        #: True if each byte of the frame has a variable, ``b0`` and so on.
        self.has_variable_per_byte = is_short_frame and layout_plan.in_bytes and not layout_plan.by_word
        self.byte_pattern = "b{}" if self.has_variable_per_byte else "data[{}]"
        self.bit_reader = BitReader(translator, layout_plan, self.byte_pattern)
        #: The names of the fields whose bits are in a variable at this point of the function.
        self.assigned_names: set[str] = set()
        self._first_byte = FirstByte(layout_plan, enum_name_of)
        if isinstance(translator, NamedValues):
            prefer_names_of_fields(translator, layout_plan, class_names)

    def to_python(self, expression: Expression) -> PythonExpression:
        """Return an expression of the spec in Python."""
        return self.translator.to_python(expression)

    @property
    def values_by_name(self) -> Mapping[str, str]:
        """The values that depend on the order code, by name. The map is complete once the decoder has been printed."""
        return self.translator.values_by_name if isinstance(self.translator, NamedValues) else {}

    @property
    def comments(self) -> Mapping[str, str]:
        """Comments on the named values, by name."""
        return self.translator.comments if isinstance(self.translator, NamedValues) else {}

    # -- variables

    def variable_for(self, field: Field | Digits) -> str:
        """Return the variable for the value of a field."""
        return self.class_names.variable_name(field.name)

    def forget_variables(self) -> str:
        """Forget all variables, at the beginning of a function. Prints nothing in the template."""
        self.assigned_names.clear()
        return ""

    def assigned_fields(self) -> frozenset[str]:
        """Return the fields that have a variable, for ``forget_assigned_since``."""
        return frozenset(self.assigned_names)

    def forget_assigned_since(self, before: frozenset[str]) -> str:
        """Forget the variables that have been assigned since ``assigned_fields``. Prints nothing in the template."""
        self.assigned_names = set(before)
        return ""

    def assign(self, field: Field, expression: PythonExpression) -> str:
        """Return the statement that assigns the bits of a field to its variable, and note that it has been printed.

        The result is empty if an earlier statement has assigned them.
        """
        if field.name in self.assigned_names:
            return ""
        self.assigned_names.add(field.name)
        return f"{self.variable_for(field)} = {expression}"

    @staticmethod
    def numbered_names(stem: str, count: int) -> str:
        """Return ``count`` numbered names for a tuple assignment, such as ``b0, b1, b2`` or ``b0,``."""
        numbered_names = ", ".join(f"{stem}{index}" for index in range(count))
        # A tuple of one element needs a comma.
        return f"{numbered_names}," if count == 1 else numbered_names

    # -- CRC

    def xor_before(self, frame_crc: FrameCrc) -> str:
        """Return the expression for a CRC that is the XOR of all bytes before it, such as ``b0 ^ b1 ^ 0xFF``.

        The result is empty for any other CRC, and if there are more than ``_MAX_BYTE_VARIABLES`` such bytes.
        """
        if not frame_crc.crc.is_xor:
            return ""
        bytes_before_crc = self.layout_plan.length - frame_crc.crc.width // 8
        if bytes_before_crc > _MAX_BYTE_VARIABLES:
            return ""
        operands = [self.byte_pattern.format(index) for index in range(bytes_before_crc)]
        if frame_crc.inverted_mask:
            operands.append(f"0x{frame_crc.inverted_mask:02X}")
        return " ^ ".join(operands)

    @property
    def bits_before_crc(self) -> PythonExpression | None:
        """The number of bits before the CRC of a word, for the tables that compute the CRC.

        It is None without such tables: for a frame without a CRC, for a frame of bytes, if order codes differ in the
        CRC, or if the user's answer to an open question decides the number. With the start value 0, zeros before a
        word do not change its CRC, so that the tables for the longest word serve all.
        """
        frame_crc = self.layout_plan.crc_of_all_order_codes
        if frame_crc is None or self.layout_plan.in_bytes:
            return None
        if not frame_crc.crc.init and not frame_crc.covers_part_only:
            return number(self.layout_plan.layout.widest - frame_crc.crc.width)
        answered_parameters = (
            self.translator.answered_parameters if isinstance(self.translator, NamedValues) else frozenset()
        )
        if not answered_parameters.isdisjoint(frame_crc.covered_width.parameters):
            return None
        return ExpressionTranslator(self.translator.code_by_parameter).to_python(frame_crc.covered_width)

    @property
    def crc_table_count(self) -> int:
        """The number of tables for the CRC of a word, one for every ``TABLE_BITS`` bits, or 0 if it needs none."""
        if self.bits_before_crc is None:
            return 0
        # Rounded up.
        return (self.layout_plan.layout.widest + TABLE_BITS - 1) // TABLE_BITS

    @property
    def table_lookups(self) -> str:
        """The CRC check as an XOR of table entries: ``table_0[low_bits] ^ table_1[high_bits & 0xFFFF] ^ …``.

        ``low_bits`` contains the lowest 16 bits of the word, and ``high_bits`` the rest. The word is split first,
        because operations on short numbers are faster.
        """
        lookups = ["table_0[low_bits]"]
        last_table_number = self.crc_table_count - 1
        for table_number in range(1, self.crc_table_count):
            # The lowest bits of the word, which table_0 covers, are not in ``high_bits``.
            shift = TABLE_BITS * (table_number - 1)
            index_code = f"high_bits >> {shift}" if shift else "high_bits"
            # No bits are above the bits of the top table, so it needs no mask.
            if table_number < last_table_number:
                shifted_bits = f"({index_code})" if shift else index_code
                index_code = f"{shifted_bits} & {mask((1 << TABLE_BITS) - 1)}"
            lookups.append(f"table_{table_number}[{index_code}]")
        return " ^ ".join(lookups)

    # -- checks

    def selects(self, field: Field) -> bool:
        """Return whether the field is the selector, which distinguishes this frame from other frames."""
        return field.name == self.layout_plan.layout.selector

    def is_padded(self, field: Field) -> bool:
        """Return whether ``decode`` checks that the bits above the field, up to a whole byte, are 0."""
        return any(isinstance(check, ZerosAbove) and check.field is field for check in self.layout_plan.checks)

    def covered_field(self, check: ParityIs) -> Field | None:
        """Return the field whose variable contains all bits that a parity bit covers, or None if there is none.

        The parity bit must cover all bits of one field and no other. The decoder must need that field anyway, without
        padding, and as the encoder sent it.
        """
        if len(check.covered_fields) != 1 or check.mask or self.layout_plan.parity_covers_converted:
            return None
        (covered,) = check.covered_fields
        if self.is_padded(covered):
            return None
        # Fields with data, and those that are checked.
        fields_with_data = [decoded_field.field for decoded_field in self.layout_plan.decoded_fields]
        checked_fields = [other_check.field for other_check in self.layout_plan.checks]
        is_read = any(field.name == covered.name for field in (*fields_with_data, *checked_fields))
        return covered if is_read else None

    @property
    def padded_fields(self) -> list[tuple[Field, PythonExpression]]:
        """The fields below bits that are always 0, each with an expression for its bits including these."""
        checks = (check for check in self.layout_plan.checks if isinstance(check, ZerosAbove))
        return [(check.field, self.bit_reader.number_from_slices(check.field.bit_slices)) for check in checks]

    @property
    def selectors_by_first_byte(self) -> list[tuple[int, str]]:
        """The valid first bytes, each with the Python code for its selector, such as ``(0x1A, "Command.READ")``.

        The selector is the field by which the frames of an interface differ, such as a command. The list is empty if
        it is not an attribute of the frame, and for frames without a variable for each byte (``b0``, ``b1``, …).
        """
        if not self.has_variable_per_byte:
            return []
        return list(self._first_byte.selector_codes_by_byte.items())

    @property
    def failing_conditions(self) -> list[str]:
        """The conditions under which a check fails, for a frame whose first byte distinguishes it from other frames.

        The list is empty for other frames, for frames without a variable for each byte, and if further bytes need
        checks of bits that are not constant.
        """
        if not self.has_variable_per_byte or not self._first_byte.selectors_by_byte:
            return []
        other_checks = self._first_byte.other_checks
        if not all(isinstance(check, (AlwaysIs, ZerosAbove)) for check in other_checks):
            return []
        return [*map(self._failing_condition, other_checks), self._first_byte.is_invalid]

    def _failing_condition(self, check: Check) -> str:
        """Return the condition that constant bits differ, such as ``b1 & 0x0F != 0x03``.

        For bits that must be 0, the bits themselves are the condition, such as ``status >> 4``.
        """
        if isinstance(check, ZerosAbove):
            # The variable has the bits of the field and all bits above it.
            return f"{self.variable_for(check.field)} >> {self.to_python(check.bits.width).operand}"
        bits = self.bit_reader.read_bits(check.bits)
        if isinstance(check, AlwaysIs) and check.value:
            return f"{bits.operand} != {mask(check.value)}"
        return str(bits)

    def join_fields(self, joined_number: JoinedNumber) -> PythonExpression:
        """Return the number that several fields form, from the word at once or from the variables of the fields."""
        if joined_number.bits is not None:
            return self.bit_reader.read_bits(joined_number.bits)
        shifted_fields = []
        for field, lowest_bit in joined_number.fields_from_low:
            shifted_fields.append(shift_left(Atom(self.variable_for(field)), self.to_python(lowest_bit)))
        # The highest field comes first.
        return join_operands("|", reversed(shifted_fields))

    # -- values

    def bits_after_checks(self, decoded_field: FieldToDecode) -> PythonExpression:
        """Return the bits of a field after all checks: its variable, if it has one, or else the expression."""
        has_variable = decoded_field.field.name in self.assigned_names
        return (
            Atom(self.variable_for(decoded_field.field))
            if has_variable
            else self.bit_reader.read_bits(decoded_field.bits)
        )

    def attribute_expressions(self, decoded_field: FieldToDecode) -> list[PythonExpression]:
        """Return the values of the attributes of a field: one, or for decimal digits one for each digit run."""
        field = decoded_field.field
        bits = self.bits_after_checks(decoded_field)
        is_checked_with_first_byte = self.selects(field) and bool(self.failing_conditions)
        if is_checked_with_first_byte:
            # This variable maps the first byte to the selector.
            return [Atom("valid_first_bytes[b0]")]
        match meaning_of(field):
            case UnsignedNumber():
                return [bits]
            case TwosComplement():
                return [call("signed", bits, self.to_python(field.width))]
            case ZeroMeans(number_for_zero):
                return [replace_zero(bits, number_for_zero)]
            case ActiveFlag(low):
                return [self._is_active(decoded_field, low_is_active=low)]
            case NamedChoice() if self.selects(field):
                return [call(self.enum_name_of(field), bits)]
            case NamedChoice():
                # The variable contains the member of the enumeration.
                return [Atom(self.variable_for(field))]
            case DecimalDigits(runs):
                return [run_value for _, run_value in digit_values(bits, runs)]
            case Latin1Text():
                return [self._decode_text(decoded_field)]
            case meaning:
                assert_never(meaning)

    def _decode_text(self, decoded_field: FieldToDecode) -> PythonExpression:
        """Return the characters of a field, such as ``data[2:6].decode("latin-1")``."""
        adjacent_bytes = self.bit_reader.bytes_of_text(decoded_field.bits)
        if adjacent_bytes:
            return Atom(f'{adjacent_bytes}.decode("latin-1")')
        return text_of_number(decoded_field.field, self.bits_after_checks(decoded_field))

    def _is_active(self, decoded_field: FieldToDecode, *, low_is_active: bool) -> PythonExpression:
        """Return the condition that a flag is active. If the order code does not have the flag, it is inactive.

        The width of a flag that only some order codes have is 1 or 0. With a width of 0, its bits are 0.
        """
        bit_count = decoded_field.field.width
        if not bit_count.is_constant:
            # The inactive bits of an active-low flag equal its width: 1, or 0 without the flag.
            inactive_bits = self.to_python(bit_count) if low_is_active else number(0)
            return Atom(f"{self.bits_after_checks(decoded_field).operand} != {inactive_bits.operand}")
        flag_bit = self.bit_reader.read_bit(decoded_field.bits, self._shorter_number(decoded_field))
        return is_flag_active(flag_bit, low_is_active=low_is_active)

    def _shorter_number(self, decoded_field: FieldToDecode) -> str:
        """Return ``low_bits``, the variable with the lowest bits of a word, if it exists and contains the flag.

        Otherwise, the result is an empty string. The variable exists if tables compute the CRC.
        """
        low_bit = decoded_field.bits.low
        is_in_low_table = low_bit.is_constant and low_bit.constant < TABLE_BITS
        return "low_bits" if self.crc_table_count and not self.layout_plan.is_converted and is_in_low_table else ""

    def decoded_values(self, encoder_and_answers: Sequence[tuple[str, str]]) -> DecodedValues:
        """Return the values of all attributes in order: encoder, answers to open questions, fields, unused bits."""
        decoded_values = DecodedValues(values=[DecodedValue(name, name) for name, _ in encoder_and_answers])
        for decoded_field in self.layout_plan.decoded_fields:
            self._add_values(decoded_field, decoded_values)
        if self.layout_plan.reserved:
            differing_bits = str(self.bit_reader.differing_unused_bits())
            comment = "1 where a bit differs from the manual"
            decoded_values.values.append(DecodedValue("unused", differing_bits, comment))
        elif self.layout_plan.keeps_undefined_bits:
            other_bits = str(self.bit_reader.bits_without_field())
            decoded_values.values.append(DecodedValue("unused", other_bits, "all other bits"))
        return decoded_values

    def _add_values(self, decoded_field: FieldToDecode, decoded: DecodedValues) -> None:
        """Add the values of a field to ``decoded``.

        If several values are computed from the field, a statement first assigns its bits to a variable.
        """
        field = decoded_field.field
        # Runs are groups of decimal digits, such as year and week, each with an attribute of its own.
        has_several_runs = len(field.runs) > 1
        if has_several_runs and field.name not in self.assigned_names:
            decoded.statements.append(self.assign(field, self.bit_reader.read_bits(decoded_field.bits)))
        fields_or_digits: Sequence[Field | Digits] = field.runs or (field,)
        expressions = self.attribute_expressions(decoded_field)
        for field_or_digits, expression in zip(fields_or_digits, expressions, strict=True):
            variable_name = self.variable_for(field_or_digits)
            holds_number = variable_name == self.variable_for(field) and field.name in self.assigned_names
            # This variable must keep its number: for the other runs, or since it would also get a text.
            if holds_number and (has_several_runs or isinstance(meaning_of(field), Latin1Text)):
                decoded.values.append(DecodedValue("", str(expression)))
            else:
                decoded.values.append(DecodedValue(variable_name, str(expression), self._place_comment(decoded_field)))

    def _place_comment(self, decoded_field: FieldToDecode) -> str:
        """Return the comment on a value: the place of its bits, if they are read there, and the meaning of the bits.

        An example is ``bit 6, active low``.
        """
        comments = []
        if decoded_field.field.name not in self.assigned_names:
            comments.append(
                self.bit_reader.place_comment(decoded_field.bits) or self.constant_in(decoded_field.bits.low)
            )
        match meaning_of(decoded_field.field):
            case ActiveFlag(low=True):
                comments.append("active low")
            case ZeroMeans(number_for_zero):
                comments.append(f"0 means {number_for_zero:,}")
        return ", ".join(filter(None, comments))

    def constant_in(self, expression: Expression) -> str:
        """Return a comment on the constant in a length or place: ``8 = crc (6) + warning (1) + error (1)``.

        Empty without such a constant, and if a variable with its own comment holds the length or place.
        """
        has_variable = self.to_python(expression).operand in self.values_by_name
        return "" if has_variable or expression.is_constant else comment_on_constant(self.layout_plan, expression)


class DecodedValue(NamedTuple):
    """The code for the value of an attribute, such as ``("position", "word >> 8", "bits 17:8")``.

    The name of the variable is empty if the value cannot have one. The comment can also be empty.
    """

    variable_name: str
    code: str
    comment: str = ""


class DecodedValues:
    """The code for the values of all attributes of a frame or register. ``statements`` are printed before them."""

    def __init__(self, values: list[DecodedValue]) -> None:
        self.values = values
        self.statements: list[str] = []
