"""The context of a layout, and the parts of a field that do not depend on its place."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from ..language.problems import DocumentReport, Path
from ..language.rules.shapes import RESERVED
from ..model import (
    INTERFACES,
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
    Piece,
    Sources,
    Text,
    Unused,
    Value,
    Verdict,
)
from ..model.expressions import Expression, ExpressionError
from ..model.record import dataclass
from .from_mapping import Raw, record


@dataclass(frozen=True)
class Context:
    """Definitions that a layout may refer to.

    ``parameter_sets`` has, by interface, the parameters of its order codes, each set once. ``only_while`` returns the
    parameter that is 0 for all order codes except those of an ``only``.
    """

    report: DocumentReport
    groups: Mapping[str, tuple[Raw, Path]]
    definitions: Mapping[str, Expression]
    parameter_sets: Mapping[str, Sequence[Mapping[str, int]]]
    crcs: Mapping[str, Crc]
    data_ids: Mapping[str, tuple[DataId, ...]]
    only_while: Callable[[str], str] = lambda only: ""

    def expression(self, text: int | str) -> Expression | None:
        """Return an expression over parameters set by order codes, or None if it is not valid."""
        try:
            expression = Expression.parse(text).substitute(self.definitions)
        except ExpressionError:
            return None  # reported by the rules on references and expressions
        has_unknown_parameter = not self._known_parameters().issuperset(expression.parameters)
        return None if has_unknown_parameter else expression

    def _known_parameters(self) -> frozenset[str]:
        """Return the names of the parameters, which are the same in all sets."""
        for sets in self.parameter_sets.values():
            for parameters in sets:
                return frozenset(parameters)
        return frozenset()

    def expressions(self, raw: Raw, keys: Iterable[str]) -> dict[str, Expression | None]:
        """Return the expressions under these keys of a part of the spec, or None for those that it does not give."""
        return {key: self.expression(raw[key]) if key in raw else None for key in keys}


def _makes_position(raw: Raw, interface: str) -> Verdict | None:
    """Return the verdict on the position while a flag is active, from the spec, or from the interface if it is open."""
    verdict_of_interface = INTERFACES[interface].flags.get(raw["name"], "")
    verdict = raw.get("makes_position", "") or verdict_of_interface
    return Verdict(verdict) if verdict else None


@dataclass(frozen=True)
class Site:
    """The site of a layout: its place in the spec, and the interface whose order codes it must support."""

    path: Path
    context: Context
    interface: str

    @property
    def sets(self) -> Sequence[Mapping[str, int]]:
        """Parameter sets of the order codes of the interface."""
        return self.context.parameter_sets.get(self.interface, ())

    def widest(self, width: Expression) -> int:
        return max((width.value(parameters) for parameters in self.sets), default=width.constant)

    def report(self, rule: str, message: str, *below: str | int) -> None:
        """Add a problem of the layout, or of the place ``below`` in it."""
        self.context.report.add(rule, (*self.path, *below), message)


def bit_range(text: int | str) -> tuple[int, int] | None:
    """Parse ``7:6`` as (7, 6) and ``5`` as (5, 5). Return None for any other text or a reversed range."""
    high, _, low = str(text).partition(":")
    if not high.isdecimal() or len(high) > 4 or (low and (not low.isdecimal() or len(low) > 4)):
        return None
    bounds = int(high), int(low or high)
    return bounds if bounds[0] >= bounds[1] else None


def expected_value(raw: Raw, context: Context) -> Expression | int | str | None:
    """Return the expected value: text, a number, or an expression if it depends on the order code."""
    expected = raw.get("equals")
    if isinstance(expected, str) and "text" not in raw:
        return context.expression(expected)
    return expected if isinstance(expected, (int, str)) else None


def zero_field(name: str, kind: Constant, low: Expression, width: Expression, site: Site, source: Sources) -> Field:
    return Field(
        name=name,
        kind=kind,
        low=low,
        width=width,
        widest=site.widest(width),
        meaning="Always zero",
        source=source,
    )


def kind_of(raw: Raw, context: Context, interface: str, width: Expression) -> Kind:
    """Return the kind of a field by its key. A field without such a key is a number."""
    if "constant" in raw:
        return Constant(raw["constant"])
    if "unused" in raw:
        return Unused(raw["unused"], Verdict(raw.get("makes_position", "usable_with_warning")))
    if "active" in raw:
        return _flag(raw, context, interface)
    if "values" in raw:
        return Choice(_choices(raw, width))
    if "values_of" in raw:
        return Choice(tuple(map(_value_of, context.data_ids.get(interface, ()))))
    if "crc" in raw:
        return CrcValue(raw["crc"], tuple(raw.get("crc_of", ())))
    if "parity_of" in raw:
        covered = raw["parity_of"]
        covered_names = (covered,) if isinstance(covered, str) else tuple(covered)
        return Parity(covered_names, raw.get("parity") == "odd", raw.get("over", ""))
    if "digits" in raw:
        return Decimal(_runs(raw["digits"]))
    if "text" in raw:
        return Text()
    return record(Number, raw)


def _choices(raw: Raw, width: Expression) -> tuple[Value, ...]:
    """Return the named values of a field, with names for all others if the spec says so."""
    values = build_values(raw)
    if "others" in raw:
        values += _reserved(values, width.constant)
    return values


def _flag(raw: Raw, context: Context, interface: str) -> Flag:
    """Return a flag. ``makes_position_if`` has one entry, such as ``{encoder_follows_edition_2: not_usable}``."""
    verdict_parameter, verdict_if_set = "", None
    for parameter, verdict in raw.get("makes_position_if", {}).items():
        verdict_parameter, verdict_if_set = parameter, Verdict(verdict)
    return record(
        Flag,
        raw,
        verdict_parameter=verdict_parameter,
        verdict_if_set=verdict_if_set,
        active_low=raw["active"] == "low",
        makes_position=_makes_position(raw, interface),
        only_while=context.only_while(raw["only"]) if "only" in raw else "",
    )


def build_values(raw: Raw) -> tuple[Value, ...]:
    """Return the named values in ``raw['values']``, in the order of the spec."""
    values = raw.get("values", {}).items()
    return tuple(record(Value, value, name=name, makes_position=_verdict(value)) for name, value in values)


def _verdict(raw: Raw) -> Verdict | None:
    return Verdict(raw["makes_position"]) if "makes_position" in raw else None


def build_combinations(raw: Raw) -> tuple[Combination, ...]:
    """Return the combinations of a layout in the order of the spec."""
    return tuple(map(_combination, raw.get("combinations", ())))


def _combination(raw: Raw) -> Combination:
    conditions = tuple(f"{name}.{value}" for name, value in raw["when"].items())
    return record(Combination, raw, when=conditions, makes_position=Verdict(raw["makes_position"]))


def _reserved(values: Sequence[Value], width: int) -> tuple[Value, ...]:
    """Name the values of a field that the spec does not list."""
    meaning = "Reserved: the manual does not say what it means"
    listed_numbers = {value.value for value in values}
    unlisted_numbers = [number for number in range(1 << width) if number not in listed_numbers]
    return tuple(Value(f"{RESERVED}_{number}", number, "", {}, meaning, ()) for number in unlisted_numbers)


def _value_of(data_id: DataId) -> Value:
    return Value(
        name=data_id.name,
        value=data_id.id,
        printed_name=f"Data ID {data_id.id:X}",
        names={},
        meaning=data_id.meaning,
        source=data_id.source,
    )


def _runs(digits: Sequence[Raw]) -> tuple[Digits, ...]:
    """Return the runs of a decimal number, most significant first, each with the divisor that moves it to the ones."""
    runs = []
    divisor = 1
    for run in reversed(digits):
        modulus = 10 ** run["digits"]
        runs.append(record(Digits, run, divisor=divisor, modulus=modulus))
        divisor *= modulus
    return tuple(reversed(runs))


def pieces(field: Field, length: int, low_first: bool) -> tuple[Piece, ...]:
    """Return the parts of a field in each byte of a frame of ``length`` bytes, or none if the order code moves them."""
    width = field.width.constant if field.width.is_constant else 0
    bits = field.container or width  # A container has the field and its padding.
    if not field.low.is_constant or not bits:
        return ()
    pieces = []
    bits_done = 0
    while bits_done < bits:
        byte_above_lowest, right = divmod(field.low.constant + bits_done, 8)
        bits_in_byte = min(8 - right, bits - bits_done)
        byte = byte_above_lowest if low_first else length - 1 - byte_above_lowest
        pieces.append(Piece(byte, right, (1 << bits_in_byte) - 1, bits_done))
        bits_done += bits_in_byte
    return tuple(pieces)
