"""The context of a layout, and the parts of a field that do not depend on its place."""

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
from .from_mapping import Raw, build_part


@dataclass(frozen=True)
class LayoutContext:
    """Definitions that a layout may refer to.

    ``groups`` has, by name, each group of fields and its path in the spec. ``definitions`` contains the expressions of
    derived parameters. ``parameter_sets`` has, by interface, the parameters of its order codes, each set once.
    ``data_ids`` contains the data IDs of each interface. ``only_while`` returns the parameter that is 0 for all order
    codes except the codes in ``only``.
    """

    report: DocumentReport
    groups: Mapping[str, tuple[Raw, Path]]
    definitions: Mapping[str, Expression]
    parameter_sets: Mapping[str, Sequence[Mapping[str, int]]]
    crcs: Mapping[str, Crc]
    data_ids: Mapping[str, tuple[DataId, ...]]
    only_while: Callable[[str], str] = lambda only: ""

    def expression(self, text: int | str) -> Expression | None:
        """Return an expression over parameters set by order codes, or None if it is not valid or has an unknown one."""
        try:
            expression = Expression.parse(text).substitute(self.definitions)
        except ExpressionError:
            return None  # reported by the rules on references and expressions
        has_unknown_parameter = not self._known_parameters().issuperset(expression.parameters)
        return None if has_unknown_parameter else expression

    def _known_parameters(self) -> frozenset[str]:
        """Return the names of the parameters. They are the same in all sets, so the first set has them all."""
        for sets in self.parameter_sets.values():
            for parameters in sets:
                return frozenset(parameters)
        return frozenset()

    def expressions(self, raw_part: Raw, keys: Iterable[str]) -> dict[str, Expression | None]:
        """Return the expressions under these keys of a part of the spec, or None for missing and invalid ones."""
        return {key: self.expression(raw_part[key]) if key in raw_part else None for key in keys}


def _verdict_while_active(raw_field: Raw, interface: str) -> Verdict | None:
    """Return the verdict on the position while a flag is active, or None if it has none.

    It is the verdict in the spec, or else the interface's verdict for flags of this name.
    """
    # Such as the verdict of nE over BiSS, whose name in specs is error.
    verdict_of_interface = INTERFACES[interface].flags.get(raw_field["name"], "")
    verdict_text = raw_field.get("makes_position", "") or verdict_of_interface
    return Verdict(verdict_text) if verdict_text else None


@dataclass(frozen=True)
class LayoutSite:
    """The site of a layout: its place in the spec, and the interface whose order codes it must support."""

    path: Path
    context: LayoutContext
    interface: str

    @property
    def sets(self) -> Sequence[Mapping[str, int]]:
        """Parameter sets of the order codes of the interface."""
        return self.context.parameter_sets.get(self.interface, ())

    def widest(self, width: Expression) -> int:
        """Return the highest width over all order codes, or without order codes the constant part of the expression."""
        return max((width.value(parameters) for parameters in self.sets), default=width.constant)

    def report(self, rule: str, message: str, *below: str | int) -> None:
        """Add a problem of the layout, or of the place ``below`` in it."""
        self.context.report.add(rule, (*self.path, *below), message)


def bit_range(bits_text: int | str) -> tuple[int, int] | None:
    """Parse ``7:6`` as (7, 6) and ``5`` as (5, 5). Return None for any other text or a reversed range."""
    high_text, _, low_text = str(bits_text).partition(":")
    # Numbers of more than four digits are typos, and would give huge fields.
    is_high_valid = high_text.isdecimal() and len(high_text) <= 4
    is_low_valid = not low_text or (low_text.isdecimal() and len(low_text) <= 4)
    if not is_high_valid or not is_low_valid:
        return None
    high = int(high_text)
    low = int(low_text) if low_text else high
    return (high, low) if high >= low else None


def expected_value(raw_field: Raw, context: LayoutContext) -> Expression | int | str | None:
    """Return the value of ``equals``: a text, a number, or an expression, which may depend on the order code.

    Return None if there is none, or an expression that is not valid.
    """
    expected = raw_field.get("equals")
    # In a field with 'text', it is the text itself. In other fields, a string is an expression such as bits + 8.
    if isinstance(expected, str) and "text" not in raw_field:
        return context.expression(expected)
    return expected if isinstance(expected, (int, str)) else None


def zero_field(
    name: str, constant: Constant, low: Expression, width: Expression, site: LayoutSite, source: Sources
) -> Field:
    """Return a field whose bits are always 0, such as padding or a gap. ``constant`` says which."""
    return Field(
        name=name,
        kind=constant,
        low=low,
        width=width,
        widest=site.widest(width),
        meaning="Always zero",
        source=source,
    )


def kind_of(raw_field: Raw, context: LayoutContext, interface: str, width: Expression) -> Kind:
    """Return the kind of a field by its key. A field without such a key is a number."""
    if "constant" in raw_field:
        return Constant(raw_field["constant"])
    if "unused" in raw_field:
        return Unused(raw_field["unused"], Verdict(raw_field.get("makes_position", "usable_with_warning")))
    if "active" in raw_field:
        return _build_flag(raw_field, context, interface)
    if "values" in raw_field:
        return Choice(_named_values(raw_field, width))
    if "values_of" in raw_field:
        return Choice(tuple(map(_value_of_data_id, context.data_ids.get(interface, ()))))
    if "crc" in raw_field:
        return CrcValue(raw_field["crc"], tuple(raw_field.get("crc_of", ())))
    if "parity_of" in raw_field:
        one_or_more_names = raw_field["parity_of"]
        # One field is a text in the spec, several are a list.
        covered_names = (one_or_more_names,) if isinstance(one_or_more_names, str) else tuple(one_or_more_names)
        is_odd = raw_field.get("parity") == "odd"
        return Parity(covered_names, is_odd, raw_field.get("over", ""))
    if "digits" in raw_field:
        return Decimal(_digit_runs(raw_field["digits"]))
    if "text" in raw_field:
        return Text()
    return build_part(Number, raw_field)


def _named_values(raw_field: Raw, width: Expression) -> tuple[Value, ...]:
    """Return the named values of a field. With ``others``, all other values have names too."""
    values = build_values(raw_field)
    if "others" in raw_field:
        values += _name_reserved_numbers(values, width.constant)
    return values


def _build_flag(raw_field: Raw, context: LayoutContext, interface: str) -> Flag:
    """Return a flag. ``makes_position_if`` has one entry, such as ``{encoder_follows_edition_2: not_usable}``.

    Its key is the parameter that decides, and its value the verdict if this is 1. ``only`` becomes the parameter that
    is 0 for other order codes.
    """
    verdict_parameter = ""
    verdict_if_set = None
    # There is one entry at most.
    for parameter, verdict in raw_field.get("makes_position_if", {}).items():
        verdict_parameter = parameter
        verdict_if_set = Verdict(verdict)
    return build_part(
        Flag,
        raw_field,
        verdict_parameter=verdict_parameter,
        verdict_if_set=verdict_if_set,
        active_low=raw_field["active"] == "low",
        makes_position=_verdict_while_active(raw_field, interface),
        only_while=context.only_while(raw_field["only"]) if "only" in raw_field else "",
    )


def build_values(raw_field: Raw) -> tuple[Value, ...]:
    """Return the named values in ``raw_field['values']``, in the order of the spec."""
    values = raw_field.get("values", {}).items()
    return tuple(build_part(Value, value, name=name, makes_position=_verdict_of_value(value)) for name, value in values)


def _verdict_of_value(raw_value: Raw) -> Verdict | None:
    """Return the verdict of a named value, or None if it has none."""
    return Verdict(raw_value["makes_position"]) if "makes_position" in raw_value else None


def build_combinations(raw_layout: Raw) -> tuple[Combination, ...]:
    """Return the combinations of a layout in the order of the spec."""
    return tuple(map(_build_combination, raw_layout.get("combinations", ())))


def _build_combination(raw_combination: Raw) -> Combination:
    """Return a combination. Its conditions are texts such as ``warning.active``, of a field and a value."""
    conditions = tuple(f"{name}.{value}" for name, value in raw_combination["when"].items())
    return build_part(
        Combination, raw_combination, when=conditions, makes_position=Verdict(raw_combination["makes_position"])
    )


def _name_reserved_numbers(values: Sequence[Value], width: int) -> tuple[Value, ...]:
    """Return a named value, such as ``reserved_3``, for each number of ``width`` bits that is not in ``values``."""
    meaning = "Reserved: the manual does not say what it means"
    listed_numbers = {value.value for value in values}
    reserved_values: list[Value] = []
    for number in range(1 << width):
        if number not in listed_numbers:
            name = f"{RESERVED}_{number}"
            reserved_values.append(
                Value(name=name, value=number, printed_name="", names={}, meaning=meaning, source=())
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


def _digit_runs(digits: Sequence[Raw]) -> tuple[Digits, ...]:
    """Return the runs of a decimal number, most significant first, each with the divisor that isolates it.

    For two runs of three and two digits, the divisors are 100 and 1, and the moduli 1000 and 100.
    """
    runs = []
    divisor = 1
    # From the least significant run, so that the divisor grows by the digits of each.
    for run in reversed(digits):
        modulus = 10 ** run["digits"]
        runs.append(build_part(Digits, run, divisor=divisor, modulus=modulus))
        divisor *= modulus
    return tuple(reversed(runs))


def bit_slices_of(field: Field, length: int, low_first: bool) -> tuple[BitSlice, ...]:
    """Return the parts of a field in each byte of a frame of ``length`` bytes, or none if the order code moves them.

    They begin with the lowest bits of the field. Each consists of the byte, the lowest bit in that byte, a mask of as
    many 1 bits as the part has bits, and the lowest bit in the field. In a frame of 3 bytes, 10 bits from bit 4 are 4
    bits in the last byte, from its bit 4, and 6 bits in the byte before it. With ``low_first``, byte 0 has the lowest
    bits of the frame, otherwise its last byte.
    """
    width = field.width.constant if field.width.is_constant else 0
    # A padded field occupies its container: the bits of the field and zeros above them.
    bits_with_padding = field.container or width
    if not field.low.is_constant or not bits_with_padding:
        return ()
    bit_slices = []
    bits_done = 0
    while bits_done < bits_with_padding:
        # Places count from the lowest bit of the frame.
        byte_above_lowest, low_bit_in_byte = divmod(field.low.constant + bits_done, 8)
        bits_left = bits_with_padding - bits_done
        bits_in_byte = min(8 - low_bit_in_byte, bits_left)
        byte = byte_above_lowest if low_first else length - 1 - byte_above_lowest
        mask = (1 << bits_in_byte) - 1
        bit_slices.append(BitSlice(byte=byte, low_in_byte=low_bit_in_byte, mask=mask, low_in_number=bits_done))
        bits_done += bits_in_byte
    return tuple(bit_slices)


def with_joins_covered(raw_layout: Raw, fields: Sequence[Field], site: LayoutSite) -> list[Field]:
    """Return the fields. In parity bits that cover a join, the fields of the join replace it."""
    joins = {name: tuple(members) for name, members in raw_layout.get("join", {}).items()}
    constants = {field.name: field.kind.value for field in fields if isinstance(field.kind, Constant)}
    return [_resolve_parity(field, joins, constants, site) for field in fields]


def _resolve_parity(
    field: Field, joins: Mapping[str, tuple[str, ...]], constants: Mapping[str, int], site: LayoutSite
) -> Field:
    """Return the field. If it is a parity bit, joins in it are replaced by their fields, and constants are counted.

    An odd number of ones in the covered constants inverts the parity of the other fields. A parity bit of constants
    only is a constant itself. A single covered field stays, even if it is constant.
    """
    parity = field.kind
    if not isinstance(parity, Parity):
        return field
    covered_names: list[str] = []
    for name in parity.of:
        if parity.over and name in joins:
            message = f"'over' counts the bits of each field from 0, and '{name}' has several fields; list its fields"
            site.report("parity-of", message, "fields", field.name, "parity_of")
        covered_names += joins.get(name, (name,))
    constant_names = [name for name in covered_names if name in constants]
    # A parity bit of one constant covers it like a data field.
    if len(covered_names) == 1:
        constant_names = []
    data_names = [name for name in covered_names if name not in constant_names]
    # An odd number of ones in constants inverts the parity of the other fields.
    ones_in_constants = sum((constants[name] & parity.mask).bit_count() for name in constant_names)
    inverts_parity = ones_in_constants % 2 == 1
    is_odd = parity.odd != inverts_parity
    if not data_names:
        return replace(field, kind=Constant(int(is_odd)))
    return replace(field, kind=Parity(tuple(data_names), is_odd, parity.over, tuple(constant_names), inverts_parity))
